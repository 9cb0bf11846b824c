// Prints what the look-up table costs: the largest error of E, F and F^-1 against the exact
// projection, for lines at several distances.
//
//   contour_table_error CAMERA.yaml

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "view/contour_table.h"

namespace omnitag {
namespace {

void printErrors(const CameraModel& camera, const ContourTable& table, double distance,
                 double max_offset) {
  const double scale = camera.imagePlane().scale();
  double e = 0.0;
  double f = 0.0;
  double f_inverse = 0.0;
  constexpr int kRadii = 1000;
  for (int k = 1; k < kRadii; ++k) {
    const double fraction = static_cast<double>(k) / kRadii;
    const double radius =
        camera.minRadius() + fraction * (0.975 * camera.maxRadius() - camera.minRadius());
    const double height = camera.rayFromRadius(radius)->heightAt(distance);
    // Up to 60 degrees above and below the horizon, where markers can be.
    if (std::abs(height) > std::tan(radians(60.0)) * distance) continue;
    e = std::max(e, scale * std::abs(table.imageRadius(distance, height) - radius));
    for (int i = 1; i <= 10; ++i) {
      const double offset = max_offset * i / 10;
      const auto exact = camera.imageFromPoint(distance / std::cos(offset), height);
      if (!exact) continue;
      const double main = table.radiusMain(exact->radius, offset);
      const double image = table.radius(radius, offset);
      if (!std::isnan(main)) f = std::max(f, scale * std::abs(main - radius));
      if (!std::isnan(image)) {
        f_inverse = std::max(f_inverse, scale * std::abs(image - exact->radius));
      }
    }
  }
  std::printf("%10.1f m %10.4f %10.4f %10.4f\n", distance, e, f, f_inverse);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: contour_table_error CAMERA.yaml\n");
    return 2;
  }
  try {
    const auto camera = omnitag::loadCamera(argv[1]);
    const omnitag::ContourTable table(*camera, 3.0);
    for (const double degrees : {15.0, 30.0}) {
      std::printf("largest error in pixels, up to %.0f degrees off the view's middle\n", degrees);
      std::printf("%12s %10s %10s %10s\n", "distance", "E", "F", "F^-1");
      for (const double distance : {0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 100.0}) {
        omnitag::printErrors(*camera, table, distance, omnitag::radians(degrees));
      }
    }
  } catch (const omnitag::InputError& error) {
    std::fprintf(stderr, "contour_table_error: %s\n", error.what());
    return 1;
  }
  return 0;
}
