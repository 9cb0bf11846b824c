#include "camera/camera_writer.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "camera/camera_yaml.h"
#include "camera/foreign_camera.h"
#include "camera/ocam_fit.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

/// A camera file of this package, all numbers of which are known to be valid.
class Writer {
 public:
  Writer(const YamlReader& file, std::string format)
      : file_(file), format_(std::move(format)), model_(file.text("model")) {}

  const std::string& model() const { return model_; }

  /// A number of the lens as the file writes it, so that no digit is lost or added.
  std::string lens(const std::string& key) const {
    return file_.mapping("lens").has(key) ? file_.mapping("lens").text(key) : "0";
  }
  std::string image(const std::string& key) const { return file_.mapping("image").text(key); }
  std::string number(const std::string& key) const { return file_.text(key); }

  /// At least this many coefficients, with zeros at the end, joined by commas.
  std::string distortion(std::size_t count) const {
    std::vector<std::string> numbers;
    if (file_.has("distortion")) numbers = file_.texts("distortion");
    while (numbers.size() < count) numbers.emplace_back("0");
    std::string text;
    for (const std::string& each : numbers) text += (text.empty() ? "" : ", ") + each;
    return text;
  }

  std::string matrix() const {
    return lens("fx") + ", " + lens("skew") + ", " + lens("cx") + ", 0, " + lens("fy") + ", " +
           lens("cy") + ", 0, 0, 1";
  }

  /// Throws if the lens has skew.
  void refuseSkew() const {
    const YamlReader lens = file_.mapping("lens");
    double skew = 0.0;
    lens.read("skew", &skew);
    if (skew != 0.0) lens.refuse("skew", "0 or none to write it as " + format_);
  }

  /// Throws if a distortion has k3.
  void refuseThirdCoefficient() const {
    if (!file_.has("distortion")) return;
    const std::vector<double> numbers = file_.numbers("distortion");
    if (numbers.size() > 4 && numbers[4] != 0.0) {
      file_.refuse("distortion", "k3 of 0 to write it as " + format_);
    }
  }

  [[noreturn]] void refuseModel(const std::string& models) const {
    file_.refuse("model", models + " to write it as " + format_);
  }

  std::vector<std::string> leftOut() const {
    std::vector<std::string> keys;
    for (const char* key : {"max_angle", "through_mirror", "uncertainty", "scale_to_image"}) {
      if (file_.has(key)) keys.emplace_back(key);
    }
    return keys;
  }

 private:
  const YamlReader& file_;
  std::string format_;
  std::string model_;
};

std::string kalibrText(const Writer& camera) {
  const std::string& model = camera.model();
  std::string name = model;
  std::string leading;
  std::string distortion = "none";
  std::string coefficients;
  if (model == "equidistant") {
    name = "pinhole";
    distortion = "equidistant";
    coefficients = camera.distortion(4);
  } else if (model == "pinhole" || model == "unified") {
    camera.refuseThirdCoefficient();
    name = model == "unified" ? "omni" : "pinhole";
    leading = model == "unified" ? camera.number("xi") + ", " : "";
    distortion = "radtan";
    coefficients = camera.distortion(4);
  } else if (model == "double_sphere") {
    name = "ds";
    leading = camera.number("xi") + ", " + camera.number("alpha") + ", ";
  } else if (model == "eucm") {
    leading = camera.number("alpha") + ", " + camera.number("beta") + ", ";
  } else {
    camera.refuseModel("equidistant, pinhole, unified, double_sphere or eucm");
  }
  camera.refuseSkew();
  return "cam0:\n  camera_model: " + name + "\n  intrinsics: [" + leading + camera.lens("fx") +
         ", " + camera.lens("fy") + ", " + camera.lens("cx") + ", " + camera.lens("cy") +
         "]\n  distortion_model: " + distortion + "\n  distortion_coeffs: [" + coefficients +
         "]\n  resolution: [" + camera.image("width") + ", " + camera.image("height") + "]\n";
}

std::string openCvMatrix(int rows, int columns, const std::string& data) {
  return "!!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ " + data + " ]\n";
}

/// The distortion, and the key that determines its kind.
std::string openCvDistortion(const Writer& camera) {
  const std::string& model = camera.model();
  if (model == "equidistant") {
    return openCvMatrix(4, 1, camera.distortion(4)) + "fisheye_model: 1\n";
  }
  if (model == "unified") {
    return openCvMatrix(1, 4, camera.distortion(4)) + "xi: " + camera.number("xi") + "\n";
  }
  if (model != "pinhole") camera.refuseModel("equidistant, unified or pinhole");
  camera.refuseSkew();
  return openCvMatrix(5, 1, camera.distortion(5)) + "fisheye_model: 0\n";
}

std::string openCvText(const Writer& camera) {
  const std::string distortion = openCvDistortion(camera);
  return "%YAML:1.0\n---\nimage_width: " + camera.image("width") +
         "\nimage_height: " + camera.image("height") +
         "\ncamera_matrix: " + openCvMatrix(3, 3, camera.matrix()) +
         "distortion_coefficients: " + distortion;
}

std::string infoMatrix(int rows, int columns, const std::string& data) {
  return "\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  data: [" + data + "]\n";
}

std::string cameraInfoText(const Writer& camera) {
  const std::string& model = camera.model();
  if (model != "equidistant" && model != "pinhole") camera.refuseModel("equidistant or pinhole");
  const bool is_fisheye = model == "equidistant";
  const int count = is_fisheye ? 4 : 5;
  return "image_width: " + camera.image("width") + "\nimage_height: " + camera.image("height") +
         "\ncamera_name: camera\ncamera_matrix:" + infoMatrix(3, 3, camera.matrix()) +
         "distortion_model: " + (is_fisheye ? "equidistant" : "plumb_bob") +
         "\ndistortion_coefficients:" +
         infoMatrix(1, count, camera.distortion(static_cast<std::size_t>(count))) +
         "rectification_matrix:" + infoMatrix(3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1") +
         "projection_matrix:" +
         infoMatrix(3, 4,
                    camera.lens("fx") + ", 0, " + camera.lens("cx") + ", 0, 0, " +
                        camera.lens("fy") + ", " + camera.lens("cy") + ", 0, 0, 0, 1, 0");
}

std::string ocamTextOf(const CameraModel& model, const Writer& writer, const std::string& origin) {
  const auto* central = dynamic_cast<const CentralCamera*>(&model);
  if (central == nullptr) {
    writer.refuseModel("a central camera, of which all lines of sight meet,");
  }
  constexpr double kTolerance = 0.02;
  try {
    const OcamFit fit = fitOcam(*central, kTolerance);
    if (fit.error > kTolerance) {
      std::ostringstream message;
      message << "expected a camera that polynomials follow to " << kTolerance
              << " pixels to write it as ocam, found one that they miss by " << fit.error;
      throw InputError(message.str());
    }
    return ocamText(fit);
  } catch (const InputError& error) {
    throw InputError(origin + ": " + error.what());
  }
}

std::string ownText(YAML::Node file, const std::string& path, const std::string& output) {
  namespace fs = std::filesystem;
  if (file["calibration_file"]) {
    const fs::path calibration =
        fs::path(path).parent_path() / file["calibration_file"].as<std::string>();
    file["calibration_file"] =
        fs::relative(fs::absolute(calibration), fs::absolute(output).parent_path()).string();
  }
  YAML::Emitter emitter;
  emitter << file;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace

const std::vector<std::string>& cameraFormats() {
  static const std::vector<std::string> kFormats = {"omnitag", "kalibr", "opencv", "camera_info",
                                                    "ocam"};
  return kFormats;
}

WrittenCamera writtenCamera(const std::string& path, const std::string& format,
                            const std::string& output) {
  const YAML::Node node = readCameraFile(path);
  const std::string file_path = cameraFilePath(path);
  // A file that describes no camera is refused here.
  const std::shared_ptr<const CameraModel> model = cameraOf(node, file_path);
  if (format == "omnitag") return {ownText(YAML::Clone(node), file_path, output), {}};
  const YamlReader file(node, file_path);
  const Writer writer(file, format);
  if (format == "kalibr") return {kalibrText(writer), writer.leftOut()};
  if (format == "opencv") return {openCvText(writer), writer.leftOut()};
  if (format == "camera_info") return {cameraInfoText(writer), writer.leftOut()};
  return {ocamTextOf(*model, writer, file_path), writer.leftOut()};
}

}  // namespace omnitag
