#include <algorithm>
#include <filesystem>

#include "camera_reader.h"
#include "omnitag/camera/ocam_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readOcam(const YamlReader& camera) {
  camera.allowOnly({"model", "calibration_file", "max_angle", "through_mirror", "uncertainty",
                    "scale_to_image"});
  const std::string stated = camera.text("calibration_file");
  const bool is_path = !stated.empty() && std::none_of(stated.begin(), stated.end(),
                                                       [](unsigned char c) { return c < ' '; });
  if (!is_path) camera.refuse("calibration_file", "the path of a file");
  // An absolute path remains as it is.
  const std::string path = (std::filesystem::path(camera.origin()).parent_path() / stated).string();
  const FieldLimits limits = readFieldLimits(camera);
  OcamCalibration calibration;
  try {
    calibration = loadOcamCalibration(path);
  } catch (const InputError& error) {
    throw InputError(camera.where("calibration_file") + ": " + error.what());
  }
  return madeFor(camera, [&] {
    try {
      return std::make_shared<OcamCamera>(calibration, limits);
    } catch (const InputError& error) {
      throw InputError("calibration_file: " + stated + ": " + error.what());
    }
  });
}

}  // namespace omnitag
