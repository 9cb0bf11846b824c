#pragma once

#include <memory>

#include "camera/central_camera.h"
#include "common/yaml_reader.h"
#include "omnitag/camera/camera_model.h"

/// Shared parts of the camera file's readers, and the readers themselves, one for each `model`. All
/// throw InputError with one line that names file, line and key.
namespace omnitag {

/// `image`.
ImageSize readImageSize(const YamlReader& camera);

/// `fx`, `fy`, `cx`, `cy` and, if `lens` has it, `skew`; with the distortion given.
ImagePlane readImagePlane(const YamlReader& lens, const ImagePlane::Distortion& distortion = {});

/// The optional keys `max_angle` and `through_mirror`.
FieldLimits readFieldLimits(const YamlReader& camera);

/// The optional `uncertainty`: `none`, or deviations of the modes, each 0 if left out. Without the
/// key, the uncertainty of a usual calibration: half a pixel for each mode if the image is 500
/// pixels high.
CameraUncertainty readUncertainty(const YamlReader& camera, const ImageSize& size);

/// Calls `make`, and adds the file's name to its InputErrors.
template <typename Make>
std::shared_ptr<CameraModel> madeFor(const YamlReader& camera, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(camera.origin() + ": " + error.what());
  }
}

std::shared_ptr<CameraModel> readCatadioptric(const YamlReader& camera);
std::shared_ptr<CameraModel> readEquidistant(const YamlReader& camera);
std::shared_ptr<CameraModel> readUnified(const YamlReader& camera);
std::shared_ptr<CameraModel> readPinhole(const YamlReader& camera);
std::shared_ptr<CameraModel> readDoubleSphere(const YamlReader& camera);
std::shared_ptr<CameraModel> readEucm(const YamlReader& camera);
std::shared_ptr<CameraModel> readEquirectangular(const YamlReader& camera);
std::shared_ptr<CameraModel> readOcam(const YamlReader& camera);

}  // namespace omnitag
