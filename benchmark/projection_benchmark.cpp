/// Nanoseconds of one projection, from point to pixel and back, by the camera's model.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "camera/catadioptric_camera.h"
#include "camera/equidistant_camera.h"
#include "camera/ocam_camera.h"
#include "camera/unified_camera.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr double kApexDistance = 0.21;
constexpr double kRimRadius = 0.0375;

using Camera = std::shared_ptr<const CameraModel>;

ImagePlane lensOf(double focal_length, const ImagePlane::Distortion& distortion = {}) {
  return {Eigen::Vector2d(focal_length, focal_length).asDiagonal(), Eigen::Vector2d(249.5, 249.5),
          distortion};
}

Camera cameraWith(MirrorProfile profile) {
  return std::make_shared<CatadioptricCamera>(
      ImageSize{500, 500}, lensOf(1225.0),
      CatadioptricCamera::Mirror{std::move(profile), kApexDistance, kRimRadius});
}

Camera sphere() { return cameraWith(MirrorProfile::conic(0.04, 0.0)); }
Camera hyperbola() { return cameraWith(MirrorProfile::conic(0.03, -1.6)); }
Camera asphere() { return cameraWith(MirrorProfile::conic(0.04, -0.8, {-300.0, 2e4})); }

Camera table() {
  constexpr int kSamples = 100;
  const MirrorProfile shape = MirrorProfile::conic(0.03, -1.6);
  std::vector<Eigen::Vector2d> samples;
  for (int i = 0; i < kSamples; ++i) {
    const double rho = kRimRadius * i / (kSamples - 1);
    samples.emplace_back(rho, shape.at(rho).sag);
  }
  return cameraWith(MirrorProfile::tabulated(samples));
}

Camera equidistant() {
  return std::make_shared<EquidistantCamera>(
      ImageSize{500, 500}, lensOf(146.0),
      EquidistantCamera::Coefficients{-0.012, 0.003, -0.0008, 0.0001}, FieldLimits{1.65, false});
}

Camera unified() {
  return std::make_shared<UnifiedCamera>(ImageSize{500, 500},
                                         lensOf(320.0, {-0.08, 0.03, 4e-4, -6e-4, 0.0}), 1.4,
                                         FieldLimits{1.6, false});
}

Camera ocam() {
  return std::make_shared<OcamCamera>(
      OcamCalibration{
          {-130.1, 0.0, 2.6e-3, -4.1e-6, 1.7e-8}, 249.5, 249.5, 1.002, 1e-3, -2e-3, {500, 500}},
      FieldLimits{1.64, false});
}

/// Pixels that show the world, and a point on the ray of each, 0.5 to 10 m away.
struct Scene {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Vector3d> points;
};

Scene sceneOf(const CameraModel& camera) {
  constexpr std::size_t kPoints = 1024;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(0.0, 499.0);
  std::uniform_real_distribution<double> range(0.5, 10.0);
  Scene scene;
  while (scene.points.size() < kPoints) {
    const Eigen::Vector2d pixel(coordinate(random), coordinate(random));
    const std::optional<Ray> ray = camera.rayFromPixel(pixel);
    if (!ray) continue;
    scene.pixels.push_back(pixel);
    scene.points.emplace_back(ray->origin + range(random) * ray->direction);
  }
  return scene;
}

/// Calls `project(camera, scene, i)` for one point after the other of the scene.
template <typename Project>
void run(benchmark::State& state, const Camera& camera, Project project) {
  const Scene scene = sceneOf(*camera);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(project(*camera, scene, i));
    i = (i + 1) % scene.points.size();
  }
}

void pixelFromPoint(benchmark::State& state, const Camera& camera) {
  run(state, camera, [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    return camera.pixelFromPoint(scene.points[i]);
  });
}

void pixelAndJacobianFromPoint(benchmark::State& state, const Camera& camera) {
  run(state, camera, [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    Eigen::Matrix<double, 2, 3> jacobian;
    const std::optional<Eigen::Vector2d> pixel = camera.pixelFromPoint(scene.points[i], &jacobian);
    return std::pair(pixel, jacobian);
  });
}

void rayFromPixel(benchmark::State& state, const Camera& camera) {
  run(state, camera, [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    return camera.rayFromPixel(scene.pixels[i]);
  });
}

BENCHMARK_CAPTURE(pixelFromPoint, sphere, sphere());
BENCHMARK_CAPTURE(pixelFromPoint, hyperbola, hyperbola());
BENCHMARK_CAPTURE(pixelFromPoint, asphere, asphere());
BENCHMARK_CAPTURE(pixelFromPoint, table, table());
BENCHMARK_CAPTURE(pixelFromPoint, equidistant, equidistant());
BENCHMARK_CAPTURE(pixelFromPoint, unified, unified());
BENCHMARK_CAPTURE(pixelFromPoint, ocam, ocam());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, sphere, sphere());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, hyperbola, hyperbola());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, asphere, asphere());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, table, table());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, equidistant, equidistant());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, unified, unified());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, ocam, ocam());
BENCHMARK_CAPTURE(rayFromPixel, sphere, sphere());
BENCHMARK_CAPTURE(rayFromPixel, hyperbola, hyperbola());
BENCHMARK_CAPTURE(rayFromPixel, asphere, asphere());
BENCHMARK_CAPTURE(rayFromPixel, table, table());
BENCHMARK_CAPTURE(rayFromPixel, equidistant, equidistant());
BENCHMARK_CAPTURE(rayFromPixel, unified, unified());
BENCHMARK_CAPTURE(rayFromPixel, ocam, ocam());

}  // namespace
}  // namespace omnitag

BENCHMARK_MAIN();
