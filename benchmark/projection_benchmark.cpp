/// Nanoseconds of one projection, from point to pixel and back, by the mirror's profile.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "omnitag/camera/catadioptric_camera.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr double kApexDistance = 0.21;
constexpr double kRimRadius = 0.0375;

CatadioptricCamera cameraWith(MirrorProfile profile) {
  const ImagePlane lens(Eigen::Vector2d(1225.0, 1225.0).asDiagonal(),
                        Eigen::Vector2d(249.5, 249.5));
  return CatadioptricCamera({500, 500}, lens, {std::move(profile), kApexDistance, kRimRadius});
}

MirrorProfile sphere() { return MirrorProfile::conic(0.04, 0.0); }
MirrorProfile hyperbola() { return MirrorProfile::conic(0.03, -1.6); }
MirrorProfile asphere() { return MirrorProfile::conic(0.04, -0.8, {-300.0, 2e4}); }

MirrorProfile table() {
  constexpr int kSamples = 100;
  const MirrorProfile shape = hyperbola();
  std::vector<Eigen::Vector2d> samples;
  for (int i = 0; i < kSamples; ++i) {
    const double rho = kRimRadius * i / (kSamples - 1);
    samples.emplace_back(rho, shape.at(rho).sag);
  }
  return MirrorProfile::tabulated(samples);
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
void run(benchmark::State& state, MirrorProfile profile, Project project) {
  const CatadioptricCamera camera = cameraWith(std::move(profile));
  const Scene scene = sceneOf(camera);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(project(camera, scene, i));
    i = (i + 1) % scene.points.size();
  }
}

void pixelFromPoint(benchmark::State& state, MirrorProfile profile) {
  run(state, std::move(profile), [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    return camera.pixelFromPoint(scene.points[i]);
  });
}

void pixelAndJacobianFromPoint(benchmark::State& state, MirrorProfile profile) {
  run(state, std::move(profile), [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    Eigen::Matrix<double, 2, 3> jacobian;
    const std::optional<Eigen::Vector2d> pixel = camera.pixelFromPoint(scene.points[i], &jacobian);
    return std::pair(pixel, jacobian);
  });
}

void rayFromPixel(benchmark::State& state, MirrorProfile profile) {
  run(state, std::move(profile), [](const CameraModel& camera, const Scene& scene, std::size_t i) {
    return camera.rayFromPixel(scene.pixels[i]);
  });
}

BENCHMARK_CAPTURE(pixelFromPoint, sphere, sphere());
BENCHMARK_CAPTURE(pixelFromPoint, hyperbola, hyperbola());
BENCHMARK_CAPTURE(pixelFromPoint, asphere, asphere());
BENCHMARK_CAPTURE(pixelFromPoint, table, table());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, sphere, sphere());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, hyperbola, hyperbola());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, asphere, asphere());
BENCHMARK_CAPTURE(pixelAndJacobianFromPoint, table, table());
BENCHMARK_CAPTURE(rayFromPixel, sphere, sphere());
BENCHMARK_CAPTURE(rayFromPixel, hyperbola, hyperbola());
BENCHMARK_CAPTURE(rayFromPixel, asphere, asphere());
BENCHMARK_CAPTURE(rayFromPixel, table, table());

}  // namespace
}  // namespace omnitag

BENCHMARK_MAIN();
