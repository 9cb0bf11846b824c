#include "camera/camera_reader.h"
#include "camera/eucm_camera.h"

namespace omnitag {

std::shared_ptr<CameraModel> readEucm(const YamlReader& camera) {
  camera.allowOnly({"model", "image", "lens", "alpha", "beta", "max_angle", "through_mirror",
                    "uncertainty", "scale_to_image"});
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "skew"});
  const EucmCamera::Parameters parameters{camera.number("alpha", {0.0, 1.0}),
                                          camera.number("beta", kPositive)};
  const ImageSize image_size = readImageSize(camera);
  const ImagePlane image_plane = readImagePlane(lens);
  const FieldLimits limits = readFieldLimits(camera);
  return madeFor(camera, [&] {
    return std::make_shared<EucmCamera>(image_size, image_plane, parameters, limits);
  });
}

}  // namespace omnitag
