#include "camera/camera_reader.h"
#include "camera/equirectangular_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readEquirectangular(const YamlReader& camera) {
  camera.allowOnly({"model", "image", "uncertainty", "scale_to_image"});
  return std::make_shared<EquirectangularCamera>(readImageSize(camera));
}

}  // namespace omnitag
