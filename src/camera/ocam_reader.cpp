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
  const YamlReader reader = camera.mapping("calibration");
  reader.allowOnly({"polynomial", "center", "affine"});
  OcamCalibration calibration;
  calibration.polynomial = reader.numbers("polynomial");
  if (calibration.polynomial.empty()) reader.refuse("polynomial", "a0, a1, ...");
  const std::vector<double> center = reader.numbers("center", 2);
  calibration.center_row = center[0];
  calibration.center_column = center[1];
  const std::vector<double> affine = reader.numbers("affine", 3);
  calibration.c = affine[0];
  calibration.d = affine[1];
  calibration.e = affine[2];
  calibration.image_size = readImageSize(camera);
  return calibration;
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
