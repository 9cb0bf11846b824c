#include <algorithm>
#include <optional>

#include "camera/foreign_camera.h"
#include "common/format.h"

namespace omnitag {
namespace {

constexpr std::size_t kFisheyeCoefficients = 4;

/// The first of these keys that is present.
std::optional<std::string> keyOf(const YamlReader& file,
                                 std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (file.has(std::string(key))) return std::string(key);
  }
  return std::nullopt;
}

std::optional<std::string> matrixKey(const YamlReader& file) {
  return keyOf(file, {"camera_matrix", "cameraMatrix", "K"});
}

/// As the samples write it, or as OpenCV stores a cv::Size.
ImageSize imageSizeOf(const YamlReader& file) {
  constexpr Interval kPixels{1, 1 << 15};
  if (file.has("image_size")) {
    const std::vector<double> size = file.numbers("image_size", 2);
    if (!kPixels.contains(size[0]) || !kPixels.contains(size[1])) {
      file.refuse("image_size", "the image's width and height in pixels");
    }
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
  }
  return {file.integer("image_width", kPixels), file.integer("image_height", kPixels)};
}

/// Whether the file says so. If it does not, four coefficients mean a fisheye, since calib3d's own
/// calibration has five or more.
bool isFisheye(const YamlReader& file, std::size_t coefficients) {
  const std::string key = "fisheye_model";
  if (!file.has(key)) return coefficients == kFisheyeCoefficients;
  const std::string stated = file.text(key);
  if (stated == "1" || stated == "true") return true;
  if (stated == "0" || stated == "false") return false;
  file.refuse(key, "0 or 1");
}

double xiOf(const YamlReader& file) {
  if (!file.isMapping("xi")) return file.number("xi", kNonNegative);
  const std::vector<double> numbers = file.mapping("xi").numbers("data", 1);
  if (!kNonNegative.contains(numbers[0])) file.refuse("xi", "a number >= 0");
  return numbers[0];
}

}  // namespace

bool isOpenCv(const YamlReader& file) { return matrixKey(file).has_value(); }

YAML::Node cameraFromOpenCv(const YamlReader& file) {
  Intrinsics lens = cameraMatrix(file, *matrixKey(file));
  lens.size = imageSizeOf(file);
  const std::optional<std::string> key =
      keyOf(file, {"distortion_coefficients", "distCoeffs", "dist_coeffs", "D"});
  if (!key) {
    throw InputError(file.origin() + ": distortion_coefficients: expected a matrix, found nothing");
  }
  const std::vector<double> coefficients = matrixNumbers(file, *key);
  const auto expectFour = [&](const std::string& what) {
    if (coefficients.size() == kFisheyeCoefficients) return;
    throw InputError(file.where(*key) + ": expected 4 numbers, as a calibration of " + what +
                     " has, found " + std::to_string(coefficients.size()));
  };
  if (file.has("xi")) {
    expectFour("omnidir");
    YAML::Node described = describedCamera("unified", lens, coefficients);
    described["xi"] = shortestText(xiOf(file));
    return described;
  }
  if (isFisheye(file, coefficients.size())) {
    expectFour("fisheye");
    return describedCamera("equidistant", lens, coefficients);
  }
  return describedCamera("pinhole", lens, pinholeDistortion(file, *key, coefficients));
}

}  // namespace omnitag
