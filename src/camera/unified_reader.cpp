#include <algorithm>
#include <vector>

#include "camera/camera_reader.h"
#include "camera/unified_camera.h"

namespace omnitag {
namespace {

ImagePlane readLens(const YamlReader& camera, const std::vector<double>& coefficients) {
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "skew"});
  ImagePlane::Distortion distortion{};
  std::copy(coefficients.begin(), coefficients.end(), distortion.begin());
  return readImagePlane(lens, distortion);
}

std::shared_ptr<CameraModel> make(const YamlReader& camera, const ImagePlane& image_plane,
                                  double xi) {
  const ImageSize image_size = readImageSize(camera);
  const FieldLimits limits = readFieldLimits(camera);
  return madeFor(
      camera, [&] { return std::make_shared<UnifiedCamera>(image_size, image_plane, xi, limits); });
}

}  // namespace

std::shared_ptr<CameraModel> readUnified(const YamlReader& camera) {
  camera.allowOnly({"model", "image", "lens", "xi", "distortion", "max_angle", "through_mirror",
                    "uncertainty", "scale_to_image"});
  constexpr std::size_t kCoefficients = 4;
  const double xi = camera.number("xi", kNonNegative);
  return make(camera, readLens(camera, camera.numbers("distortion", kCoefficients)), xi);
}

std::shared_ptr<CameraModel> readPinhole(const YamlReader& camera) {
  camera.allowOnly(
      {"model", "image", "lens", "distortion", "max_angle", "uncertainty", "scale_to_image"});
  std::vector<double> distortion;
  if (camera.has("distortion")) {
    distortion = camera.numbers("distortion");
    if (distortion.size() != 4 && distortion.size() != 5) {
      camera.refuse("distortion", "a list of 4 or 5 numbers");
    }
  }
  return make(camera, readLens(camera, distortion), 0.0);
}

}  // namespace omnitag
