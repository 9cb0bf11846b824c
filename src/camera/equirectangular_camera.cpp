#include "camera/equirectangular_camera.h"

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

CentralField wholeSphere() {
  // Smaller than any pixel.
  constexpr double kBehind = 1e-5;
  constexpr double kLast = kPi - kBehind;
  return {kLast, kLast, false};
}

}  // namespace

EquirectangularCamera::EquirectangularCamera(const ImageSize& image_size)
    : CentralCamera(image_size, ImagePlane::equirectangular(image_size), wholeSphere()) {
  tabulateRays();
}

}  // namespace omnitag
