#include "camera/camera_reader.h"
#include "camera/double_sphere_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readDoubleSphere(const YamlReader& camera) {
  camera.allowOnly({"model", "image", "lens", "xi", "alpha", "max_angle", "through_mirror",
                    "uncertainty", "scale_to_image"});
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "skew"});
  constexpr Interval kXi{-1.0, std::numeric_limits<double>::max(), false};
  const DoubleSphereCamera::Parameters parameters{camera.number("xi", kXi),
                                                  camera.number("alpha", {0.0, 1.0})};
  const ImageSize image_size = readImageSize(camera);
  const ImagePlane image_plane = readImagePlane(lens);
  const FieldLimits limits = readFieldLimits(camera);
  return madeFor(camera, [&] {
    return std::make_shared<DoubleSphereCamera>(image_size, image_plane, parameters, limits);
  });
}

}  // namespace omnitag
