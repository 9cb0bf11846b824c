#pragma once

#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "camera/catadioptric_camera.h"

namespace omnitag {

/// A camera for tests, with what the tests need to know about it from an independent source.
struct SampleCamera {
  std::string name;
  CatadioptricCamera camera;
  /// The surface's sag (m) at a distance from the axis (m), written down independently.
  std::function<long double(long double)> sag;
  double apex_distance;
  /// The visible part of the mirror, m from the axis.
  double inner_radius;
  double outer_radius;
  /// m, how closely the camera's surface follows `sag`: a table's spline between its samples.
  double surface_tolerance = 1e-15;

  double height(double rho) const {
    return apex_distance + static_cast<double>(sag(static_cast<long double>(rho)));
  }
};

/// How gtest names a sample.
inline void PrintTo(const SampleCamera& sample, std::ostream* out) { *out << sample.name; }

inline std::function<long double(long double)> conicSag(long double radius, long double k,
                                                        std::vector<long double> higher = {}) {
  return [=](long double rho) {
    const long double s = rho * rho / radius;
    long double sag = s / (1.0L + std::sqrt(1.0L - (1.0L + k) * s / radius));
    for (std::size_t i = 0; i < higher.size(); ++i) {
      sag += higher[i] * std::pow(rho, 4.0L + 2.0L * static_cast<long double>(i));
    }
    return sag;
  };
}

inline MirrorProfile sampledProfile(const std::function<long double(long double)>& sag,
                                    double first, double last, int count) {
  std::vector<Eigen::Vector2d> samples;
  for (int i = 0; i < count; ++i) {
    const double rho = first + (last - first) * i / (count - 1);
    samples.emplace_back(rho, static_cast<double>(sag(static_cast<long double>(rho))));
  }
  return MirrorProfile::tabulated(samples);
}

inline ImagePlane squareLens(double focal_length, double center) {
  return {Eigen::Vector2d(focal_length, focal_length).asDiagonal(),
          Eigen::Vector2d(center, center)};
}

/// Cameras with every profile, and with each of the lens's complications.
inline std::vector<SampleCamera> sampleCameras() {
  using Distortion = ImagePlane::Distortion;
  const ImageSize small{500, 500};
  const ImagePlane lens = squareLens(1225.0, 249.5);
  const auto stretched = [](const Distortion& distortion) {
    return ImagePlane(Eigen::Vector2d(700.0, 760.0).asDiagonal(), Eigen::Vector2d(331.3, 227.8),
                      distortion);
  };
  const auto sphere = conicSag(0.04L, 0.0L);
  const auto hyperbola = conicSag(0.03L, -1.6L);
  const auto parabola = conicSag(0.03L, -1.0L);
  const auto cone = [](long double rho) { return 0.9L * rho; };

  std::vector<SampleCamera> samples;
  samples.push_back({"Sphere",
                     {small, lens, {MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375}},
                     sphere,
                     0.21,
                     0.0,
                     0.0375});
  // Its image ends at the ball's silhouette, sin = R / (R + d); the edge is out of sight.
  samples.push_back(
      {"Ball",
       {{1000, 1000}, squareLens(2600.0, 499.5), {MirrorProfile::conic(0.04, 0.0), 0.21, 0.0395}},
       sphere,
       0.21,
       0.0,
       0.04 * std::sqrt(1.0 - 0.16 * 0.16)});
  samples.push_back({"SphereOffCentreDistorted",
                     {{640, 480},
                      stretched({-0.35, 0.12, 0.001, -0.002, 0.05}),
                      {MirrorProfile::conic(0.04, 0.0), 0.09, 0.034}},
                     sphere,
                     0.09,
                     0.0,
                     0.034});
  samples.push_back({"SphereWithHousing",
                     {small, lens, {MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375, 0.03}},
                     sphere,
                     0.21,
                     0.0,
                     0.0375});
  samples.push_back({"Parabola",
                     {small, lens, {MirrorProfile::conic(0.03, -1.0), 0.21, 0.0375}},
                     parabola,
                     0.21,
                     0.0,
                     0.0375});
  samples.push_back({"HyperbolaOffCentreStretched",
                     {{640, 480}, stretched({}), {MirrorProfile::conic(0.03, -1.6), 0.12, 0.035}},
                     hyperbola,
                     0.12,
                     0.0,
                     0.035});
  samples.push_back({"AsphereBulging",
                     {small, lens, {MirrorProfile::conic(0.04, -0.8, {600.0, 4e4}), 0.21, 0.0375}},
                     conicSag(0.04L, -0.8L, {600.0L, 4e4L}),
                     0.21,
                     0.0,
                     0.0375});
  samples.push_back(
      {"AsphereFlattening",
       {small, lens, {MirrorProfile::conic(0.03, 0.0, {-3000.0, -2e5}), 0.21, 0.0265}},
       conicSag(0.03L, 0.0L, {-3000.0L, -2e5L}),
       0.21,
       0.0,
       0.0265});
  samples.push_back({"Table",
                     {small, lens, {sampledProfile(hyperbola, 0.0, 0.04, 300), 0.21, 0.0375}},
                     hyperbola,
                     0.21,
                     0.0,
                     0.0375,
                     1e-12});
  samples.push_back({"TableOffAxis",
                     {small, lens, {sampledProfile(sphere, 0.006, 0.036, 300), 0.21, 0.0355}},
                     sphere,
                     0.21,
                     0.006,
                     0.0355,
                     3e-9});
  samples.push_back({"Cone",
                     {small, lens, {sampledProfile(cone, 0.004, 0.036, 5), 0.21, 0.036}},
                     cone,
                     0.21,
                     0.004,
                     0.036,
                     1e-15});
  samples.push_back({"NearlyFlat",
                     {small, lens, {MirrorProfile::conic(100.0, 0.0), 0.21, 0.0375}},
                     conicSag(100.0L, 0.0L),
                     0.21,
                     0.0,
                     0.0375});
  samples.push_back({"Tiny",
                     {small, lens, {MirrorProfile::conic(4e-4, -0.5), 2.1e-3, 3.75e-4}},
                     conicSag(4e-4L, -0.5L),
                     2.1e-3,
                     0.0,
                     3.75e-4});
  return samples;
}

}  // namespace omnitag
