#include <algorithm>

#include "camera/foreign_camera.h"
#include "common/format.h"

namespace omnitag {
namespace {

const std::string kModel = "camera_model";

ImageSize resolutionOf(const YamlReader& camera) {
  const std::vector<double> size = camera.numbers("resolution", 2);
  constexpr Interval kPixels{1, 1 << 15};
  const bool is_size = std::all_of(size.begin(), size.end(), [&](double pixels) {
    return kPixels.contains(pixels) && pixels == static_cast<int>(pixels);
  });
  if (!is_size) camera.refuse("resolution", "the image's width and height in pixels");
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

/// The intrinsics of a model that precede the focal lengths and the principal point.
struct Leading {
  std::vector<std::string> names;
  std::vector<Interval> intervals;
};

std::vector<double> intrinsicsOf(const YamlReader& camera, const Leading& leading) {
  constexpr std::size_t kLens = 4;
  const std::size_t first = leading.names.size();
  std::vector<double> numbers = camera.numbers("intrinsics", first + kLens);
  for (std::size_t i = 0; i < first; ++i) {
    if (!leading.intervals[i].contains(numbers[i])) {
      throw InputError(camera.where("intrinsics") + ": expected " +
                       leading.intervals[i].description("a number") + " as " + leading.names[i] +
                       ", found another");
    }
  }
  if (!(numbers[first] > 0.0 && numbers[first + 1] > 0.0)) {
    camera.refuse("intrinsics", "focal lengths > 0");
  }
  return numbers;
}

/// The four numbers after the leading ones.
Intrinsics lensOf(const YamlReader& camera, const std::vector<double>& numbers) {
  const std::size_t first = numbers.size() - 4;
  return {resolutionOf(camera), numbers[first],     numbers[first + 1],
          numbers[first + 2],   numbers[first + 3], 0.0};
}

/// Refuses any distortion with a camera model that Kalibr uses without one.
void checkUndistorted(const YamlReader& camera) {
  if (!camera.has("distortion_model")) return;
  const std::string model = camera.text("distortion_model");
  if (model != "none") camera.refuse("distortion_model", "none with this camera_model");
}

YAML::Node pinholeOf(const YamlReader& camera) {
  const Intrinsics lens = lensOf(camera, intrinsicsOf(camera, {}));
  const std::string model = camera.text("distortion_model");
  if (model == "none") return describedCamera("pinhole", lens, {0.0, 0.0, 0.0, 0.0});
  if (model == "equidistant" || model == "equi") {
    return describedCamera("equidistant", lens, camera.numbers("distortion_coeffs", 4));
  }
  if (model == "radtan") {
    return describedCamera("pinhole", lens, camera.numbers("distortion_coeffs", 4));
  }
  camera.refuse("distortion_model", "radtan, equidistant or none with camera_model pinhole");
}

YAML::Node unifiedOf(const YamlReader& camera) {
  const std::vector<double> numbers = intrinsicsOf(camera, {{"xi"}, {kNonNegative}});
  const std::string model = camera.text("distortion_model");
  if (model != "radtan" && model != "none") {
    camera.refuse("distortion_model", "radtan or none with camera_model omni");
  }
  const std::vector<double> distortion = model == "none" ? std::vector<double>{0.0, 0.0, 0.0, 0.0}
                                                         : camera.numbers("distortion_coeffs", 4);
  YAML::Node described = describedCamera("unified", lensOf(camera, numbers), distortion);
  described["xi"] = shortestText(numbers[0]);
  return described;
}

YAML::Node doubleSphereOf(const YamlReader& camera) {
  constexpr Interval kXi{-1.0, std::numeric_limits<double>::max(), false};
  checkUndistorted(camera);
  const std::vector<double> numbers =
      intrinsicsOf(camera, {{"xi", "alpha"}, {kXi, Interval{0.0, 1.0}}});
  YAML::Node described = describedCamera("double_sphere", lensOf(camera, numbers));
  described["xi"] = shortestText(numbers[0]);
  described["alpha"] = shortestText(numbers[1]);
  return described;
}

YAML::Node eucmOf(const YamlReader& camera) {
  checkUndistorted(camera);
  const std::vector<double> numbers =
      intrinsicsOf(camera, {{"alpha", "beta"}, {Interval{0.0, 1.0}, kPositive}});
  YAML::Node described = describedCamera("eucm", lensOf(camera, numbers));
  described["alpha"] = shortestText(numbers[0]);
  described["beta"] = shortestText(numbers[1]);
  return described;
}

std::vector<std::string> camerasOf(const YamlReader& file) {
  std::vector<std::string> names;
  for (const std::string& key : file.keys()) {
    if (file.isMapping(key) && file.mapping(key).has(kModel)) names.push_back(key);
  }
  return names;
}

YamlReader chosenCamera(const YamlReader& file, const std::string& name) {
  if (file.has(kModel)) return file;
  const std::vector<std::string> names = camerasOf(file);
  if (name.empty() && names.size() == 1) return file.mapping(names.front());
  if (std::find(names.begin(), names.end(), name) != names.end()) return file.mapping(name);
  std::string known;
  for (const std::string& each : names) known += (known.empty() ? "" : ", ") + each;
  throw InputError(file.origin() + ": expected one of its cameras behind the file's name, as " +
                   file.origin() + "#" + names.front() + " (it has " + known + "), found " +
                   (name.empty() ? "none" : "'" + name + "'"));
}

}  // namespace

bool isKalibr(const YamlReader& file) { return file.has(kModel) || !camerasOf(file).empty(); }

YAML::Node cameraFromKalibr(const YamlReader& file, const std::string& name) {
  const YamlReader camera = chosenCamera(file, name);
  const std::string model = camera.text(kModel);
  if (model == "pinhole") return pinholeOf(camera);
  if (model == "omni") return unifiedOf(camera);
  if (model == "ds") return doubleSphereOf(camera);
  if (model == "eucm") return eucmOf(camera);
  camera.refuse(kModel, "pinhole, omni, ds or eucm");
}

}  // namespace omnitag
