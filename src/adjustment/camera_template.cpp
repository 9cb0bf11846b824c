#include "adjustment/camera_template.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "camera/camera_yaml.h"
#include "camera/mirror_profile.h"
#include "camera/ocam_calibration.h"
#include "common/yaml_reader.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Factor by which a mirror is extended beyond its rim.
constexpr double kWidening = 1.3;

/// Angle at which distortion coefficients matter: near the edge of a fisheye, in rad.
constexpr double kWideAngle = 1.5;

CalibrationParameter relative(const std::string& name, const std::string& unit, double value,
                              double tolerable) {
  constexpr double kScale = 0.1;
  return {name, unit, value, kScale * value, tolerable * value};
}

void addLens(const YamlReader& lens, std::vector<CalibrationParameter>* parameters) {
  for (const char* name : {"fx", "fy"}) {
    parameters->push_back(relative(name, "px", lens.number(name), 0.05));
  }
  for (const char* name : {"cx", "cy"}) {
    parameters->push_back({name, "px", lens.number(name), 10.0, 2.0});
  }
}

double impliedConicConstant(const YamlReader& mirror) {
  const std::string profile = mirror.text("profile");
  if (profile == "spherical") return 0.0;
  if (profile == "parabolic") return -1.0;
  return mirror.number("conic_constant");
}

void addMirror(const YamlReader& mirror, std::vector<CalibrationParameter>* parameters) {
  if (mirror.text("profile") != "tabulated") {
    parameters->push_back(
        relative("radius_of_curvature", "m", mirror.number("radius_of_curvature"), 0.5));
    parameters->push_back({"conic_constant", "", impliedConicConstant(mirror), 0.2, 0.2});
  }
  parameters->push_back(relative("apex_distance", "m", mirror.number("apex_distance"), 0.05));
}

void addEquidistant(const YamlReader& camera, std::vector<CalibrationParameter>* parameters) {
  constexpr double kShareOfRadius = 0.05;
  double power = 1.0;
  int index = 0;
  for (const double coefficient : camera.numbers("distortion")) {
    power *= kWideAngle * kWideAngle;
    const double scale = kShareOfRadius / power;
    parameters->push_back({"k" + std::to_string(++index), "", coefficient, scale, scale});
  }
}

/// `circle`: pixels, the radius up to which the polynomial counts.
void addOcam(const OcamCalibration& calibration, double circle,
             std::vector<CalibrationParameter>* parameters) {
  parameters->push_back({"cx", "px", calibration.center_column, 10.0, 2.0});
  parameters->push_back({"cy", "px", calibration.center_row, 10.0, 2.0});
  const double depth = std::abs(calibration.polynomial.front());
  constexpr double kShareOfDepth = 0.05;
  for (std::size_t k = 0; k < calibration.polynomial.size(); ++k) {
    // The toolbox leaves out a1, so that the polynomial is smooth in the image's middle.
    const double coefficient = calibration.polynomial[k];
    if (k == 1 && coefficient == 0.0) continue;
    const double scale = kShareOfDepth * depth / std::pow(circle, k);
    parameters->push_back({"a" + std::to_string(k), k == 0 ? "px" : "", coefficient, scale, scale});
  }
  constexpr double kScale = 0.02;
  parameters->push_back({"c", "", calibration.c, kScale, kScale});
  parameters->push_back({"d", "", calibration.d, kScale, kScale});
  parameters->push_back({"e", "", calibration.e, kScale, kScale});
}

/// Writes an ocam camera's calibration into its file itself, where its numbers can be replaced.
void includeCalibration(const OcamCalibration& calibration, YAML::Node* file) {
  file->remove("calibration_file");
  (*file)["image"]["width"] = calibration.image_size.width;
  (*file)["image"]["height"] = calibration.image_size.height;
  YAML::Node node(YAML::NodeType::Map);
  node["polynomial"] = calibration.polynomial;
  node["center"] = std::vector<double>{calibration.center_row, calibration.center_column};
  node["affine"] = std::vector<double>{calibration.c, calibration.d, calibration.e};
  for (const char* key : {"polynomial", "center", "affine"}) {
    node[key].SetStyle(YAML::EmitterStyle::Flow);
  }
  (*file)["calibration"] = node;
}

/// Parameters of a central camera in addition to its lens: xi, alpha, beta.
void addShape(const YamlReader& camera, std::vector<CalibrationParameter>* parameters) {
  for (const char* name : {"xi", "alpha", "beta"}) {
    if (camera.has(name)) parameters->push_back({name, "", camera.number(name), 0.2, 0.2});
  }
}

void addPinhole(const YamlReader& camera, std::vector<CalibrationParameter>* parameters) {
  if (!camera.has("distortion")) return;
  const std::vector<double> distortion = camera.numbers("distortion");
  const std::vector<CalibrationParameter> kinds = {{"k1", "", 0.0, 0.05, 0.05},
                                                   {"k2", "", 0.0, 0.05, 0.05},
                                                   {"p1", "", 0.0, 0.005, 0.005},
                                                   {"p2", "", 0.0, 0.005, 0.005}};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    parameters->push_back(kinds[i]);
    parameters->back().value = distortion[i];
  }
}

/// The profile's name for a conic constant; with coefficients, a profile is aspheric anyway.
std::string profileNameOf(double conic_constant) {
  if (conic_constant == 0.0) return "spherical";
  if (conic_constant == -1.0) return "parabolic";
  return conic_constant < -1.0 ? "hyperbolic" : "aspheric";
}

void setConicConstant(double value, YAML::Node* mirror) {
  const auto profile = (*mirror)["profile"].as<std::string>();
  if (profile != "aspheric") {
    const std::string name = profileNameOf(value);
    (*mirror)["profile"] = name;
    if (name == "aspheric") (*mirror)["coefficients"].push_back(0.0);
  }
  (*mirror)["conic_constant"] = value;
}

void setOcamValue(const std::string& name, double value, YAML::Node* calibration) {
  if (name == "cx" || name == "cy") {
    (*calibration)["center"][name == "cy" ? 0 : 1] = value;
  } else if (name.front() == 'a') {
    (*calibration)["polynomial"][std::stoi(name.substr(1))] = value;
  } else {
    (*calibration)["affine"][name.front() - 'c'] = value;
  }
}

void setValue(const std::string& name, double value, YAML::Node* file) {
  if (YAML::Node calibration = (*file)["calibration"]) {
    setOcamValue(name, value, &calibration);
    return;
  }
  YAML::Node lens = (*file)["lens"];
  if (lens[name]) {
    lens[name] = value;
  } else if (name == "xi" || name == "alpha" || name == "beta") {
    (*file)[name] = value;
  } else if (name == "conic_constant") {
    YAML::Node mirror = (*file)["mirror"];
    setConicConstant(value, &mirror);
  } else if (name == "radius_of_curvature" || name == "apex_distance") {
    (*file)["mirror"][name] = value;
  } else {
    constexpr int kRadialOfUnified = 2;
    const int digit = name.back() - '1';
    const int index = name.front() == 'p' ? kRadialOfUnified + digit : digit;
    (*file)["distortion"][index] = value;
  }
}

std::string emitted(const YAML::Node& file) {
  YAML::Emitter emitter;
  emitter << file;
  return std::string(emitter.c_str()) + "\n";
}

MirrorProfile profileOf(const YAML::Node& mirror) {
  if (mirror["samples"]) {
    std::vector<Eigen::Vector2d> samples;
    for (const YAML::Node& row : mirror["samples"]) {
      samples.emplace_back(row[0].as<double>(), row[1].as<double>());
    }
    return MirrorProfile::tabulated(samples);
  }
  std::vector<double> coefficients;
  if (mirror["coefficients"]) coefficients = mirror["coefficients"].as<std::vector<double>>();
  return MirrorProfile::conic(mirror["radius_of_curvature"].as<double>(),
                              mirror["conic_constant"].as<double>(), coefficients);
}

YAML::Node nodeOf(const CameraUncertainty& uncertainty) {
  const auto rounded = [](double pixels) { return std::ceil(1e3 * pixels) / 1e3; };
  YAML::Node node(YAML::NodeType::Map);
  node.SetStyle(YAML::EmitterStyle::Flow);
  node["principal_point"] = rounded(uncertainty.principal_point);
  node["scale"] = rounded(uncertainty.scale);
  node["tilt"] = rounded(uncertainty.tilt);
  node["rim"] = rounded(uncertainty.rim);
  return node;
}

}  // namespace

Eigen::VectorXd valuesOf(const std::vector<CalibrationParameter>& parameters) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  std::transform(parameters.begin(), parameters.end(), values.data(),
                 [](const CalibrationParameter& parameter) { return parameter.value; });
  return values;
}

CameraTemplate CameraTemplate::fromFile(const std::string& path) {
  return {readCameraFile(path), path};
}

CameraTemplate CameraTemplate::fromText(const std::string& text, const std::string& origin) {
  YamlReader::fromText(text, origin);
  return {YAML::Load(text), origin};
}

CameraTemplate::CameraTemplate(const YAML::Node& file, std::string origin)
    : file_(file), origin_(std::move(origin)) {
  const YamlReader reader(file_, origin_);
  const std::string model = reader.text("model");
  if (model == "equirectangular") {
    reader.refuse("model",
                  "one that is calibrated (catadioptric, equidistant, unified, pinhole, "
                  "double_sphere, eucm or ocam)");
  }
  const auto camera = parseCamera(emitted(file_), origin_);
  circle_ = camera->rimPixels();

  if (model == "ocam") {
    const OcamCalibration calibration = readOcamCalibration(reader);
    includeCalibration(calibration, &file_);
    addOcam(calibration, circle_, &parameters_);
    return;
  }
  addLens(reader.mapping("lens"), &parameters_);
  if (model == "catadioptric") {
    const YamlReader mirror = reader.mapping("mirror");
    has_mirror_ = true;
    const std::string profile = mirror.text("profile");
    implies_conic_constant_ = profile == "spherical" || profile == "parabolic";
    addMirror(mirror, &parameters_);
  } else if (model == "equidistant") {
    addEquidistant(reader, &parameters_);
  } else {
    addShape(reader, &parameters_);
    addPinhole(reader, &parameters_);
  }
}

YAML::Node CameraTemplate::withValues(const Eigen::VectorXd& values) const {
  YAML::Node file = YAML::Clone(file_);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    setValue(parameters_[i].name, values(static_cast<Eigen::Index>(i)), &file);
  }
  return file;
}

std::shared_ptr<const CameraModel> CameraTemplate::camera(const Eigen::VectorXd& values) const {
  return parseCamera(text(values), origin_);
}

std::shared_ptr<const CameraModel> CameraTemplate::widened(const Eigen::VectorXd& values) const {
  if (!has_mirror_) return camera(values);
  YAML::Node file = withValues(values);
  const auto rim = file["mirror"]["rim_radius"].as<double>();
  const double wide_rim = std::max(kWidening * rim, rimAt(values, kWidening * circle_));
  file["mirror"]["rim_radius"] = std::min(wide_rim, silhouette(values));
  file["lens"].remove("housing_radius");
  return parseCamera(emitted(file), origin_);
}

std::string CameraTemplate::text(const Eigen::VectorXd& values,
                                 const std::optional<double>& rim_radius,
                                 const std::optional<CameraUncertainty>& uncertainty) const {
  YAML::Node file = withValues(values);
  if (uncertainty) file["uncertainty"] = nodeOf(*uncertainty);
  if (rim_radius) file["mirror"]["rim_radius"] = *rim_radius;
  return emitted(file);
}

double CameraTemplate::silhouette(const Eigen::VectorXd& values) const {
  const MirrorProfile profile = profileOf(withValues(values)["mirror"]);
  const double apex_distance = valueOf(values, "apex_distance");
  const auto isVisible = [&](double rho) {
    const MirrorProfile::Point point = profile.at(rho);
    const double height = apex_distance + point.sag;
    return height > 0.0 && height > rho * point.slope;
  };
  // Farthest useful radius of a mirror, in apex distances: 80 degrees off the lens's axis.
  constexpr double kFarthest = 5.0;
  // A conic's slope is infinite where it ends.
  constexpr double kInside = 0.999;
  double low = profile.minRho();
  double high = kInside * std::min(profile.maxRho(), kFarthest * apex_distance);
  if (isVisible(high)) return high;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (isVisible(middle) ? low : high) = middle;
  }
  return low;
}

double CameraTemplate::rimAt(const Eigen::VectorXd& values, double pixels) const {
  const MirrorProfile profile = profileOf(withValues(values)["mirror"]);
  const double apex_distance = valueOf(values, "apex_distance");
  const double radius = pixels / std::sqrt(valueOf(values, "fx") * valueOf(values, "fy"));
  double low = profile.minRho();
  double high = silhouette(values);
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (middle < radius * (apex_distance + profile.at(middle).sag) ? low : high) = middle;
  }
  return low;
}

double CameraTemplate::valueOf(const Eigen::VectorXd& values, const std::string& name) const {
  const auto found =
      std::find_if(parameters_.begin(), parameters_.end(),
                   [&name](const auto& parameter) { return parameter.name == name; });
  return values(found - parameters_.begin());
}

}  // namespace omnitag
