#include "omnitag/calibration/camera_calibration.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <string>

#include "drive.h"
#include "omnitag/calibration/camera_template.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

using namespace test;            // NOLINT
constexpr double kNoise = 0.06;  // pixels

const std::string kSphere = R"(
model: catadioptric
image: {width: 500, height: 500}
lens: {fx: 1195, fy: 1199, cx: 251.3, cy: 248.2}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0375}
)";

Eigen::Isometry3d mounting(double height, double roll, double pitch) {
  return Eigen::Translation3d(0.1, 0.02, height) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
}

TEST(CameraCalibrationTest, Experiment) {
  std::mt19937 generator(5);
  const MarkerMap map = roomMap();
  const MountedCamera truth(parseCamera(kSphere, "truth"), mounting(1.1, 0.02, -0.01));
  const std::vector<Pose2> poses = posesInRoom(40, &generator);
  for (const char* guess : {"model: catadioptric\nimage: {width: 500, height: 500}\nlens: {fx: "
                            "1314, fy: 1314, cx: 259, cy: 255}\nmirror: {profile: spherical, "
                            "radius_of_curvature: 0.04, apex_distance: 0.19, rim_radius: 0.0375}",
                            "model: catadioptric\nimage: {width: 500, height: 500}\nlens: {fx: "
                            "1075, fy: 1075, cx: 242, cy: 242}\nmirror: {profile: spherical, "
                            "radius_of_curvature: 0.04, apex_distance: 0.23, rim_radius: 0.0375}",
                            "model: catadioptric\nimage: {width: 500, height: 500}\nlens: {fx: "
                            "700, fy: 700, cx: 249.5, cy: 249.5}\nmirror: {profile: spherical, "
                            "radius_of_curvature: 0.05, apex_distance: 0.15, rim_radius: 0.046}",
                            "model: catadioptric\nimage: {width: 500, height: 500}\nlens: {fx: "
                            "700, fy: 700, cx: 249.5, cy: 249.5}\nmirror: {profile: parabolic, "
                            "radius_of_curvature: 0.03, apex_distance: 0.10, rim_radius: 0.030}"}) {
    const CameraTemplate camera = CameraTemplate::fromText(guess, "guess");
    const auto frames = drive(map, truth, poses, kNoise, mounting(1.05, -0.05, 0.06), &generator);
    const auto result = calibrateCamera(
        camera, map, frames, {},
        [](const std::string& step, int i) { std::printf("%s %d\n", step.c_str(), i); });
    std::printf("before %.3f (%zu out) after %.4f (%zu, %zu out) noise %.4f frames %zu\n",
                result.before.rms, result.before.left_out, result.after.rms, result.after.counted,
                result.after.left_out, result.noise, result.frames);
    for (const auto& p : result.parameters)
      std::printf("%-20s %12.6f -> %12.6f +- %.6f %s\n", p.guess.name.c_str(), p.guess.value,
                  p.value, p.deviation, p.held.c_str());
    for (const auto& r : result.remarks) std::printf("%s\n", r.c_str());
    if (result.rim_radius) std::printf("rim %f\n", *result.rim_radius);
  }
}

}  // namespace
}  // namespace omnitag
