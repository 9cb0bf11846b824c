#include "adjustment/time_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "../support/sweep.h"
#include "adjustment/timed_calibration.h"
#include "drive.h"
#include "omnitag/camera/camera_file.h"
#include "rolling_drive.h"

namespace omnitag {
namespace {

using test::RolledOdometry;

constexpr double kNoise = 0.06;  // pixels
constexpr double kEnd = 100.0;   // s: stamp of the first image; odometry starts 1 s earlier

class TimeCalibrationTest : public testing::Test {
 protected:
  RolledOdometry odometryOf(const test::Route& route, double error = 0.01) {
    return {route, kEnd - 1.0, kEnd + 14.0, error, &generator};
  }

  std::vector<FrameReadings> driven(const test::Route& route, const ShutterConfig& shutter) {
    return test::rollingDrive(map, camera, route, shutter, 60, kNoise, &generator);
  }

  TimeCalibration calibrate(const test::Route& route, const ShutterConfig& shutter) {
    return calibrateTime(map, camera, driven(route, shutter), odometryOf(route), {});
  }

  static void expectWithin(const EstimatedTime& found, double truth, double tolerance) {
    EXPECT_EQ(found.held, "");
    EXPECT_TRUE(found.is_observed);
    EXPECT_NEAR(found.value, truth, tolerance);
    EXPECT_NEAR(found.value, truth, 4.0 * found.deviation);
  }

  static void expectHeld(const EstimatedTime& found, const std::string& why) {
    EXPECT_EQ(found.value, 0.0);
    EXPECT_NE(found.held.find(why), std::string::npos) << found.held;
  }

  MarkerMap map = test::roomMap();
  std::mt19937 generator{8};
  MountedCamera camera{
      parseCamera(test::catadioptricFile(1195, 251.3, 248.2, 0.21, test::kSphere), "truth"),
      test::mounting(1.1, 0.0, 0.0)};
};

TEST_F(TimeCalibrationTest, RecoversOffsetAndReadout) {
  const ShutterConfig shutters[] = {
      {-0.030, 5e-5, 0.0}, {0.020, -5e-5, 0.0}, {0.150, 2e-5, 0.0}, {0.0, 6e-5, 0.0}};
  for (const ShutterConfig& shutter : shutters) {
    const TimeCalibration time = calibrate(test::livelyRoute, shutter);
    expectWithin(time.image_time_offset, shutter.image_time_offset, 1e-3);
    expectWithin(time.row_readout_time, shutter.row_readout_time,
                 0.05 * std::abs(shutter.row_readout_time));
    EXPECT_LT(time.image_time_offset.deviation, 1e-3);
    EXPECT_NEAR(time.middle_row_offset, shutter.timeOf(250), 1e-3);
  }
}

TEST_F(TimeCalibrationTest, SaysHowExactItIs) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  const ShutterConfig shutter{0.02, 5e-5, 0.0};
  constexpr int kDrives = 20;
  double offsets = 0.0;
  double readouts = 0.0;
  for (int drive = 0; drive < kDrives; ++drive) {
    const TimeCalibration time = calibrate(test::livelyRoute, shutter);
    const auto squareOf = [](const EstimatedTime& found, double truth) {
      return std::pow((found.value - truth) / found.deviation, 2);
    };
    offsets += squareOf(time.image_time_offset, shutter.image_time_offset) / kDrives;
    readouts += squareOf(time.row_readout_time, shutter.row_readout_time) / kDrives;
  }
  EXPECT_LT(std::sqrt(offsets), 1.5);
  EXPECT_GT(std::sqrt(offsets), 0.5);
  // Odometry is better here than assumed.
  EXPECT_LT(std::sqrt(readouts), 1.3);
  EXPECT_GT(std::sqrt(readouts), 0.1);
}

TEST_F(TimeCalibrationTest, MovesReadingsToTheMiddleRowsTime) {
  const ShutterConfig shutter{-0.01, 5e-5, 0.0};
  const TimeCalibration time = calibrate(test::livelyRoute, shutter);
  ASSERT_EQ(time.at_middle_row.size(), 60U);
  double squares = 0.0;
  int count = 0;
  for (const FrameReadings& frame : time.at_middle_row) {
    const Pose pose = test::livelyRoute(frame.stamp + shutter.timeOf(250));
    for (const MarkerReading& reading : frame.readings) {
      const Marker& marker = map.markers[static_cast<std::size_t>(reading.id)];
      for (std::size_t k = 0; k < 4; ++k) {
        const auto pixel = camera.pixelFromMap(pose, marker.corners()[k]);
        ASSERT_TRUE(pixel);
        squares += (*pixel - reading.corners[k]).squaredNorm();
        count += 2;
      }
    }
  }
  EXPECT_GT(count, 2000);
  EXPECT_LT(std::sqrt(squares / count), 1.2 * kNoise);
}

TEST_F(TimeCalibrationTest, TellsAGlobalShutter) {
  const TimeCalibration time = calibrate(test::livelyRoute, {0.02, 0.0, 0.0});
  expectHeld(time.row_readout_time, "global shutter");
  EXPECT_TRUE(time.row_readout_time.is_observed);
  expectWithin(time.image_time_offset, 0.02, 1e-3);
}

TEST_F(TimeCalibrationTest, HoldsTheOffsetOfARobotThatGoesOnAsItDoes) {
  const TimeCalibration time = calibrate(test::steadyRoute, {0.02, 5e-5, 0.0});
  expectHeld(time.image_time_offset, "turn left and right");
  EXPECT_FALSE(time.image_time_offset.is_observed);
  expectWithin(time.row_readout_time, 5e-5, 0.05 * 5e-5);
}

TEST_F(TimeCalibrationTest, HoldsBothOfARobotThatStands) {
  const TimeCalibration time = calibrate(test::standing, {0.02, 5e-5, 0.0});
  expectHeld(time.image_time_offset, "turn left and right");
  expectHeld(time.row_readout_time, "turn faster");
  EXPECT_FALSE(time.row_readout_time.is_observed);
}

TEST_F(TimeCalibrationTest, HoldsBothWithoutOdometry) {
  const auto frames = driven(test::livelyRoute, {0.02, 0.0, 0.0});
  const TimeCalibration time =
      calibrateTime(map, camera, frames, [](double) { return std::nullopt; }, {});
  expectHeld(time.image_time_offset, "odometry has 0 motions");
  EXPECT_EQ(time.row_readout_time.value, 0.0);
  EXPECT_EQ(time.at_middle_row.size(), 60U);
}

TEST_F(TimeCalibrationTest, IsNotMisledByWheelsThatSlip) {
  const ShutterConfig shutter{0.02, 5e-5, 0.0};
  const RolledOdometry wheels = odometryOf(test::livelyRoute);
  const auto slipping = [&](double stamp) -> std::optional<Pose> {
    const std::optional<Pose> pose = wheels(stamp);
    if (!pose) return std::nullopt;
    // Two slips of half a metre and 0.6 rad.
    Pose slipped = *pose;
    for (const double since : {103.05, 107.65}) {
      if (stamp > since) slipped = slipped * Pose{0.5, 0.0, 0.6};
    }
    return slipped;
  };
  const TimeCalibration time =
      calibrateTime(map, camera, driven(test::livelyRoute, shutter), slipping, {});
  expectWithin(time.image_time_offset, 0.02, 1.5e-3);
}

TEST_F(TimeCalibrationTest, CalibratesACameraWithARollingShutter) {
  const ShutterConfig shutter{0.02, 5e-5, 0.0};
  const auto frames = driven(test::livelyRoute, shutter);
  const auto guess = CameraTemplate::fromText(
      test::catadioptricFile(1150, 254, 246, 0.21, test::kSphere), "guess");
  CalibrationConfig config;
  config.fixed = {"apex_distance"};
  const TimedCalibration found =
      calibrateCameraAndTime(guess, map, frames, config, odometryOf(test::livelyRoute), {});
  expectWithin(found.time.image_time_offset, 0.02, 1e-3);
  expectWithin(found.time.row_readout_time, 5e-5, 0.05 * 5e-5);
  EXPECT_LT(found.camera.after.rms, 1.2 * std::sqrt(2.0) * kNoise);
  const auto expectNear = [&](std::size_t index, const std::string& name, double truth,
                              double tolerance) {
    const CalibratedParameter& parameter = found.camera.parameters[index];
    EXPECT_EQ(parameter.guess.name, name);
    EXPECT_NEAR(parameter.value, truth, tolerance);
  };
  expectNear(0, "fx", 1195.0, 2.0);
  expectNear(2, "cx", 251.3, 0.05);
  expectNear(3, "cy", 248.2, 0.05);
}

}  // namespace
}  // namespace omnitag
