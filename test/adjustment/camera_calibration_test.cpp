#include "adjustment/camera_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "../support/sweep.h"
#include "drive.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

using test::catadioptricFile;
using test::kSphere;

constexpr double kNoise = 0.06;  // pixels

const std::string kTruth = catadioptricFile(1195, 251.3, 248.2, 0.21, kSphere);
const std::string kHyperbola = catadioptricFile(
    720, 250, 249, 0.11,
    "profile: hyperbolic, radius_of_curvature: 0.026, conic_constant: -1.5, rim_radius: 0.034");

/// A true camera, what it would read on a drive, and the calibration from it.
class CameraCalibrationTest : public testing::Test {
 protected:
  MountedCamera truthOf(const std::string& camera, const Eigen::Isometry3d& mounting) const {
    return {parseCamera(camera, "truth"), mounting};
  }

  CalibrationResult calibrate(const std::string& guess, const MountedCamera& truth,
                              const Eigen::Isometry3d& believed,
                              const CalibrationConfig& config = {}) {
    const auto frames = test::drive(map, truth, test::posesInRoom(24, 2.5, &generator), kNoise,
                                    believed, &generator);
    CalibrationConfig on_even_floor = config;
    on_even_floor.floor.lean_deviation = 0.0;
    on_even_floor.floor.height_deviation = 0.0;
    return calibrateCamera(CameraTemplate::fromText(guess, "guess"), map, frames, on_even_floor);
  }

  /// What matters: how far off markers image, RMS in pixels, whatever the parameters.
  double imagingError(const CalibrationResult& result, const std::string& guess,
                      const MountedCamera& truth, int poses = 10) {
    const MountedCamera found(
        CameraTemplate::fromText(guess, "guess").widened(result.camera_values),
        result.base_from_camera);
    double squares = 0.0;
    int count = 0;
    for (const Pose& pose : test::posesInRoom(poses, 2.5, &generator)) {
      for (const Marker& marker : map.markers) {
        const auto expected = truth.pixelFromMap(pose, marker.center());
        const auto pixel = found.pixelFromMap(pose, marker.center());
        if (!expected || !pixel) continue;
        squares += (*pixel - *expected).squaredNorm();
        ++count;
      }
    }
    EXPECT_GT(count, 80);
    return std::sqrt(squares / count);
  }

  static const CalibratedParameter& of(const CalibrationResult& result, const std::string& name) {
    for (const CalibratedParameter& parameter : result.parameters) {
      if (parameter.guess.name == name) return parameter;
    }
    throw InputError("no parameter " + name);
  }

  static void expectWithin(const CalibrationResult& result, const std::string& name, double truth) {
    const CalibratedParameter& parameter = of(result, name);
    EXPECT_TRUE(parameter.held.empty()) << name << ": " << parameter.held;
    EXPECT_LT(std::abs(parameter.value - truth), 4.0 * parameter.deviation) << name;
  }

  MarkerMap map = test::roomMap();
  std::mt19937 generator{5};
};

TEST_F(CameraCalibrationTest, RecoversASphereFromBadGuesses) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  for (const double sign : {-1.0, 1.0}) {
    const std::string guess = catadioptricFile(1195 * (1 + 0.1 * sign), 251.3 + 7 * sign, 248.2 + 7,
                                               0.21 * (1 - 0.1 * sign), kSphere);
    const CalibrationResult result =
        calibrate(guess, truth, test::mounting(1.1, radians(3.5) * sign, radians(-3.5)));
    EXPECT_LT(result.after.rms, 1.1 * std::sqrt(2.0) * kNoise);
    EXPECT_GT(result.before.rms, 1.0);
    expectWithin(result, "fx", 1195);
    expectWithin(result, "fy", 1195);
    expectWithin(result, "cx", 251.3);
    expectWithin(result, "cy", 248.2);
    expectWithin(result, "apex_distance", 0.21);
    expectWithin(result, "z", 1.1);
    EXPECT_EQ(of(result, "conic_constant").value, 0.0);
    EXPECT_FALSE(of(result, "radius_of_curvature").held.empty());
    EXPECT_LT(imagingError(result, guess, truth), 0.02);
  }
}

TEST_F(CameraCalibrationTest, SaysWhatIsLeftOfTheCamerasError) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  // Over drives with different noise: how far off markers image is about as large as the remaining
  // uncertainty says.
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  const std::string guess = catadioptricFile(1190, 252.0, 247.5, 0.21, kSphere);
  const Eigen::Vector2d center(251.3, 248.2);
  constexpr double kCircle = 190.0;  // pixels
  double expected = 0.0;
  double found = 0.0;
  int count = 0;
  for (int drive = 0; drive < 6; ++drive) {
    const CalibrationResult result = calibrate(guess, truth, test::mounting(1.1, 0.0, 0.0));
    const CameraUncertainty& left = result.uncertainty;
    const MountedCamera calibrated(
        CameraTemplate::fromText(guess, "guess").widened(result.camera_values),
        result.base_from_camera);
    for (const Pose& pose : test::posesInRoom(10, 2.5, &generator)) {
      for (const Marker& marker : map.markers) {
        const auto a = truth.pixelFromMap(pose, marker.center());
        const auto b = calibrated.pixelFromMap(pose, marker.center());
        if (!a || !b) continue;
        found += (*b - *a).squaredNorm();
        const double n = (*a - center).norm() / kCircle;
        expected += 2.0 * std::pow(left.principal_point, 2) + std::pow(left.scale * n, 2) +
                    std::pow(left.tilt * n * n, 2) + std::pow(left.rim * n * n * n, 2);
        ++count;
      }
    }
  }
  ASSERT_GT(count, 400);
  const double ratio = std::sqrt(found / expected);
  EXPECT_GT(ratio, 0.33);
  EXPECT_LT(ratio, 1.1);
}

TEST_F(CameraCalibrationTest, RecoversHowACameraLeans) {
  const Eigen::Isometry3d mounting = test::mounting(1.1, radians(9.0), radians(-12.0));
  const MountedCamera truth = truthOf(kTruth, mounting);
  const std::string guess = catadioptricFile(1100, 255, 245, 0.2, kSphere);
  const CalibrationResult result = calibrate(guess, truth, test::mounting(1.1, 0.0, 0.0));
  EXPECT_LT(
      Eigen::AngleAxisd(mounting.linear().transpose() * result.base_from_camera.linear()).angle(),
      radians(0.05));
  // If the camera leans, an error of the mirror's distance moves the mirror sideways: a shift of
  // the robot that images do not reveal.
  EXPECT_LT(imagingError(result, guess, truth), 0.06);
}

TEST_F(CameraCalibrationTest, NeedsNoMoreThanTheImagesCircle) {
  // The circles have about the true radius; nothing else is right.
  const std::pair<std::string, std::string> guesses_and_truths[] = {
      {catadioptricFile(800, 250, 250, 0.15,
                        "profile: parabolic, radius_of_curvature: 0.03, rim_radius: 0.0385"),
       kTruth},
      {catadioptricFile(700, 250, 250, 0.15,
                        "profile: spherical, radius_of_curvature: 0.05, rim_radius: 0.046"),
       kHyperbola}};
  for (const auto& [guess, file] : guesses_and_truths) {
    const MountedCamera truth = truthOf(file, test::mounting(1.1, 0.0, 0.0));
    const CalibrationResult result = calibrate(guess, truth, test::mounting(1.1, 0.0, 0.0));
    EXPECT_LT(result.after.rms, 1.15 * std::sqrt(2.0) * kNoise) << guess << file;
    EXPECT_LT(imagingError(result, guess, truth), 0.05) << guess << file;
  }
}

TEST_F(CameraCalibrationTest, TellsASphereThoughTheGuessIsAParaboloid) {
  const Eigen::Isometry3d mounting = test::mounting(1.1, radians(9.0), radians(-12.0));
  const std::string guess = catadioptricFile(
      800, 250, 250, 0.15, "profile: parabolic, radius_of_curvature: 0.04, rim_radius: 0.0385");
  const CalibrationResult result =
      calibrate(guess, truthOf(kTruth, mounting), test::mounting(1.1, 0.0, 0.0));
  EXPECT_EQ(of(result, "conic_constant").value, 0.0);
  EXPECT_FALSE(of(result, "conic_constant").held.empty());
  expectWithin(result, "apex_distance", 0.21);
  const auto about_lean = std::find_if(
      result.remarks.begin(), result.remarks.end(),
      [](const std::string& remark) { return remark.find("camera leans") != std::string::npos; });
  EXPECT_NE(about_lean, result.remarks.end());
}

TEST_F(CameraCalibrationTest, RecoversCentralCameras) {
  const Eigen::Isometry3d up(Eigen::Translation3d(0.1, 0.0, 0.5));
  const std::string image = "image: {width: 700, height: 700}\n";
  const std::string truths[] = {
      "model: equidistant\n" + image +
          "lens: {fx: 210, fy: 208, cx: 352.3, cy: 347.1}\n"
          "distortion: [-0.012, 0.003, -0.0008, 0.0001]\nmax_angle: 1.65\n",
      "model: unified\n" + image +
          "lens: {fx: 440, fy: 442, cx: 347.7, cy: 351.2}\nxi: 1.4\n"
          "distortion: [-0.08, 0.03, 0.0004, -0.0006]\nmax_angle: 1.6\n",
      "model: ocam\n" + image +
          "calibration: {polynomial: [-213, 0, 1.2e-3, -2e-7, 7.6e-9], center: [347.1, 352.3], "
          "affine: [1.004, 0.0006, 0]}\nmax_angle: 1.65\n"};
  const std::string guesses[] = {"model: equidistant\n" + image +
                                     "lens: {fx: 190, fy: 190, cx: 345, cy: 354}\n"
                                     "distortion: [0, 0, 0, 0]\nmax_angle: 1.65\n",
                                 "model: unified\n" + image +
                                     "lens: {fx: 400, fy: 400, cx: 354, cy: 345}\nxi: 1.2\n"
                                     "distortion: [0, 0, 0, 0]\nmax_angle: 1.6\n",
                                 "model: ocam\n" + image +
                                     "calibration: {polynomial: [-205, 0, 1.3e-3, 0, 6.5e-9], "
                                     "center: [354, 345], affine: [1, 0, 0]}\nmax_angle: 1.65\n"};
  for (std::size_t i = 0; i < std::size(truths); ++i) {
    const MountedCamera truth = truthOf(truths[i], up);
    const CalibrationResult result =
        calibrate(guesses[i], truth, up * Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitX()));
    EXPECT_LT(result.after.rms, 1.1 * std::sqrt(2.0) * kNoise) << truths[i];
    EXPECT_LT(imagingError(result, guesses[i], truth), 0.05) << truths[i];
    EXPECT_FALSE(result.rim_radius);
  }
}

TEST_F(CameraCalibrationTest, RecoversOneThatLooksAhead) {
  const std::string head = "model: equidistant\nimage: {width: 700, height: 700}\n";
  const std::string tail = "distortion: [0, 0, 0, 0]\nmax_angle: 1.65\n";
  const Eigen::Isometry3d ahead =
      Eigen::Translation3d(0.15, 0.0, 1.0) * Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5);
  const MountedCamera truth =
      truthOf(head + "lens: {fx: 210, fy: 208, cx: 352.3, cy: 347.1}\n" + tail, ahead);
  const std::string guess = head + "lens: {fx: 203, fy: 215, cx: 348, cy: 351}\n" + tail;
  const CalibrationResult result =
      calibrate(guess, truth, ahead * Eigen::AngleAxisd(0.04, Eigen::Vector3d(1.0, 0.0, 0.5)));
  EXPECT_GT(result.before.rms, 3.0);
  EXPECT_LT(result.after.rms, 1.1 * std::sqrt(2.0) * kNoise);
  expectWithin(result, "z", 1.0);
  expectWithin(result, "roll", -0.5 * kPi);
  expectWithin(result, "pitch", 0.0);
  EXPECT_LT(imagingError(result, guess, truth, 20), 0.1) << "which sees half of the room at once";
}

TEST_F(CameraCalibrationTest, LeavesOutAMarkerThatHangsElsewhere) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  const auto frames = test::drive(map, truth, test::posesInRoom(24, 2.5, &generator), kNoise,
                                  truth.baseFromCamera(), &generator);
  map.markers[6].map_from_marker.translation().y() += 0.3;
  const CalibrationResult result =
      calibrateCamera(CameraTemplate::fromText(kTruth, "guess"), map, frames, {});
  EXPECT_TRUE(std::any_of(result.remarks.begin(), result.remarks.end(), [](const auto& remark) {
    return remark.find("marker 6") != std::string::npos;
  }));
  EXPECT_EQ(result.markers, 9U);
  EXPECT_LT(imagingError(result, kTruth, truth), 0.02);
}

TEST_F(CameraCalibrationTest, KeepsWhatItIsToldToKeep) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  const std::string guess = catadioptricFile(1150, 255, 245, 0.21, kSphere);
  CalibrationConfig config;
  config.fixed = {"apex_distance", "roll"};
  const CalibrationResult result = calibrate(guess, truth, truth.baseFromCamera(), config);
  EXPECT_EQ(of(result, "apex_distance").value, 0.21);
  EXPECT_EQ(of(result, "apex_distance").held, "as told");
  expectWithin(result, "fx", 1195);

  config.fixed = {"focus"};
  const std::string message =
      test::refusalOf([&] { calibrate(guess, truth, truth.baseFromCamera(), config); });
  EXPECT_NE(message.find("apex_distance"), std::string::npos) << message;
  EXPECT_NE(message.find("'focus'"), std::string::npos) << message;
}

TEST_F(CameraCalibrationTest, RefusesARobotThatStands) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  const auto frames = test::drive(map, truth, test::posesInRoom(40, 0.05, &generator), kNoise,
                                  truth.baseFromCamera(), &generator);
  const std::string message = test::refusalOf(
      [&] { calibrateCamera(CameraTemplate::fromText(kTruth, "guess"), map, frames, {}); });
  EXPECT_NE(message.find("the robot moved by"), std::string::npos) << message;
}

TEST_F(CameraCalibrationTest, RefusesMarkersOnOneSide) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  map.markers.resize(4);
  std::vector<Pose> poses = test::posesInRoom(40, 2.0, &generator);
  for (Pose& pose : poses) pose.yaw = 0.1;
  const auto frames = test::drive(map, truth, poses, kNoise, truth.baseFromCamera(), &generator);
  const std::string message = test::refusalOf(
      [&] { calibrateCamera(CameraTemplate::fromText(kTruth, "guess"), map, frames, {}); });
  EXPECT_NE(message.find("on one side"), std::string::npos) << message;
}

TEST_F(CameraCalibrationTest, RefusesAMountingThatMoves) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  auto frames = test::drive(map, truth, test::posesInRoom(12, 2.0, &generator), kNoise,
                            truth.baseFromCamera(), &generator);
  frames[5].base_from_camera = test::mounting(1.1, 0.1, 0.0);
  const std::string message = test::refusalOf(
      [&] { calibrateCamera(CameraTemplate::fromText(kTruth, "guess"), map, frames, {}); });
  EXPECT_NE(message.find("moves on the robot"), std::string::npos) << message;
}

TEST_F(CameraCalibrationTest, RefusesAMapThatIsWrong) {
  const MountedCamera truth = truthOf(kTruth, test::mounting(1.1, 0.0, 0.0));
  const auto frames = test::drive(map, truth, test::posesInRoom(24, 2.5, &generator), kNoise,
                                  truth.baseFromCamera(), &generator);
  std::normal_distribution<double> normal(0.0, 0.4);
  for (Marker& marker : map.markers) {
    marker.map_from_marker.translation() +=
        Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  }
  EXPECT_NE(test::refusalOf([&] {
              calibrateCamera(CameraTemplate::fromText(kTruth, "guess"), map, frames, {});
            }),
            "");
}

}  // namespace
}  // namespace omnitag
