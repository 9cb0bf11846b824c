#include <algorithm>
#include <vector>

#include "camera_reader.h"
#include "omnitag/camera/unified_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readUnified(const YamlReader& camera) {
  camera.allowOnly(
      {"model", "image", "lens", "xi", "distortion", "max_angle", "through_mirror", "uncertainty"});
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "skew"});
  constexpr std::size_t kCoefficients = 4;
  ImagePlane::Distortion distortion{};
  const std::vector<double> stated = camera.numbers("distortion", kCoefficients);
  std::copy(stated.begin(), stated.end(), distortion.begin());
  const double xi = camera.number("xi", kNonNegative);
  const ImageSize image_size = readImageSize(camera);
  const ImagePlane image_plane = readImagePlane(lens, distortion);
  const FieldLimits limits = readFieldLimits(camera);
  return madeFor(
      camera, [&] { return std::make_shared<UnifiedCamera>(image_size, image_plane, xi, limits); });
}

}  // namespace omnitag
