#include <algorithm>
#include <vector>

#include "camera/camera_reader.h"
#include "camera/equidistant_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readEquidistant(const YamlReader& camera) {
  camera.allowOnly(
      {"model", "image", "lens", "distortion", "max_angle", "uncertainty", "scale_to_image"});
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "skew"});
  EquidistantCamera::Coefficients coefficients{};
  const std::vector<double> stated = camera.numbers("distortion", coefficients.size());
  std::copy(stated.begin(), stated.end(), coefficients.begin());
  const ImageSize image_size = readImageSize(camera);
  const ImagePlane image_plane = readImagePlane(lens);
  const FieldLimits limits = readFieldLimits(camera);
  return madeFor(camera, [&] {
    return std::make_shared<EquidistantCamera>(image_size, image_plane, coefficients, limits);
  });
}

}  // namespace omnitag
