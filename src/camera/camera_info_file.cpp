#include <algorithm>

#include "camera/foreign_camera.h"

namespace omnitag {
namespace {

/// The name of a key, which differs between camera_calibration's file and the message.
std::string nameIn(const YamlReader& file, const std::string& in_file,
                   const std::string& in_message) {
  return file.has(in_file) ? in_file : in_message;
}

/// The part of the sensor's pixels that is delivered, along one side of the image.
struct Window {
  int first = 0;
  int size = 0;
  int binning = 1;
};

Window windowOf(const YamlReader& file, const std::string& axis, const std::string& side,
                int pixels) {
  constexpr Interval kCount{0, 1 << 15};
  Window window;
  window.size = pixels;
  file.read("binning_" + axis, &window.binning, kCount);
  window.binning = std::max(window.binning, 1);
  if (file.has("roi")) {
    const YamlReader roi = file.mapping("roi");
    int size = 0;
    roi.read(axis + "_offset", &window.first, kCount);
    roi.read(side, &size, kCount);
    if (window.first + size > pixels || window.first >= pixels) {
      file.refuse("roi: expected a part of the image of " + std::to_string(pixels) +
                  " pixels, found " + axis + "_offset " + std::to_string(window.first) + ", " +
                  side + " " + std::to_string(size));
    }
    // 0 means all of them.
    window.size = size > 0 ? size : pixels - window.first;
  }
  if (window.binning > window.size) {
    file.refuse("binning_" + axis,
                "at most the image's " + std::to_string(window.size) + " pixels");
  }
  return window;
}

/// The centre of binned pixels is in their middle.
double placeIn(const Window& window, double place) {
  return (place - window.first + 0.5) / window.binning - 0.5;
}

Intrinsics imaged(const YamlReader& file, const Intrinsics& sensor) {
  const Window across = windowOf(file, "x", "width", sensor.size.width);
  const Window down = windowOf(file, "y", "height", sensor.size.height);
  return {{across.size / across.binning, down.size / down.binning},
          sensor.fx / across.binning,
          sensor.fy / down.binning,
          placeIn(across, sensor.cx),
          placeIn(down, sensor.cy),
          sensor.skew / across.binning};
}

}  // namespace

bool isCameraInfo(const YamlReader& file) { return file.has("distortion_model"); }

YAML::Node cameraFromCameraInfo(const YamlReader& file) {
  constexpr Interval kPixels{1, 1 << 15};
  const std::string matrix = nameIn(file, "camera_matrix", "K");
  const std::string distortion = nameIn(file, "distortion_coefficients", "D");
  Intrinsics sensor = cameraMatrix(file, matrix);
  sensor.size = {file.integer(nameIn(file, "image_width", "width"), kPixels),
                 file.integer(nameIn(file, "image_height", "height"), kPixels)};
  const Intrinsics lens = imaged(file, sensor);
  const std::vector<double> coefficients = matrixNumbers(file, distortion);
  const std::string model = file.text("distortion_model");
  if (model == "equidistant" || model == "fisheye") {
    if (coefficients.size() != 4) {
      throw InputError(file.where(distortion) + ": expected 4 numbers, found " +
                       std::to_string(coefficients.size()));
    }
    return describedCamera("equidistant", lens, coefficients);
  }
  if (model == "plumb_bob" || model == "rational_polynomial") {
    return describedCamera("pinhole", lens, pinholeDistortion(file, distortion, coefficients));
  }
  file.refuse("distortion_model", "one of equidistant, fisheye, plumb_bob, rational_polynomial");
}

}  // namespace omnitag
