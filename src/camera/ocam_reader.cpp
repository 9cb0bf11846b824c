#include <algorithm>
#include <filesystem>

#include "camera/camera_reader.h"
#include "camera/ocam_camera.h"

namespace omnitag {

namespace {

OcamCalibration loadedCalibration(const YamlReader& camera) {
  const std::string stated = camera.text("calibration_file");
  const bool is_path = !stated.empty() && std::none_of(stated.begin(), stated.end(),
                                                       [](unsigned char c) { return c < ' '; });
  if (!is_path) camera.refuse("calibration_file", "the path of a file");
  // An absolute path remains as it is.
  const std::string path = (std::filesystem::path(camera.origin()).parent_path() / stated).string();
  try {
    return loadOcamCalibration(path);
  } catch (const InputError& error) {
    throw InputError(camera.where("calibration_file") + ": " + error.what());
  }
}

OcamCalibration statedCalibration(const YamlReader& camera) {
  const YamlReader calibration = camera.mapping("calibration");
  calibration.allowOnly({"polynomial", "center", "affine"});
  OcamCalibration stated;
  stated.image_size = readImageSize(camera);
  stated.polynomial = calibration.numbers("polynomial");
  if (stated.polynomial.empty()) calibration.refuse("polynomial", "a0, a1, ...");
  const std::vector<double> center = calibration.numbers("center", 2);
  stated.center_row = center[0];
  stated.center_column = center[1];
  const std::vector<double> affine = calibration.numbers("affine", 3);
  stated.c = affine[0];
  stated.d = affine[1];
  stated.e = affine[2];
  return stated;
}

}  // namespace

OcamCalibration readOcamCalibration(const YamlReader& camera) {
  return camera.has("calibration") ? statedCalibration(camera) : loadedCalibration(camera);
}

std::shared_ptr<CameraModel> readOcam(const YamlReader& camera) {
  if (camera.has("calibration")) {
    camera.allowOnly({"model", "image", "calibration", "max_angle", "through_mirror", "uncertainty",
                      "scale_to_image"});
  } else {
    camera.allowOnly({"model", "calibration_file", "max_angle", "through_mirror", "uncertainty",
                      "scale_to_image"});
  }
  const FieldLimits limits = readFieldLimits(camera);
  const OcamCalibration calibration = readOcamCalibration(camera);
  const std::string place = camera.has("calibration")
                                ? "calibration"
                                : "calibration_file: " + camera.text("calibration_file");
  return madeFor(camera, [&] {
    try {
      return std::make_shared<OcamCamera>(calibration, limits);
    } catch (const InputError& error) {
      throw InputError(place + ": " + error.what());
    }
  });
}

}  // namespace omnitag
