#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../support/sample_markers.h"
#include "adjustment/camera_calibration.h"
#include "marker/board_file.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kNoise = 0.06;  // pixels

std::string fisheye(double focal_length, double cx, double cy, const std::string& distortion) {
  return "{model: equidistant, image: {width: 700, height: 700}, lens: {fx: " +
         std::to_string(focal_length) + ", fy: " + std::to_string(focal_length) +
         ", cx: " + std::to_string(cx) + ", cy: " + std::to_string(cy) +
         "}, distortion: " + distortion + ", max_angle: 1.6}";
}

std::string mirror(double focal_length, double cx, double cy, double apex_distance) {
  return "{model: catadioptric, image: {width: 1000, height: 1000}, lens: {fx: " +
         std::to_string(focal_length) + ", fy: " + std::to_string(focal_length) +
         ", cx: " + std::to_string(cx) + ", cy: " + std::to_string(cy) +
         "}, mirror: {profile: hyperbolic, radius_of_curvature: 0.03, conic_constant: -1.6, "
         "apex_distance: " +
         std::to_string(apex_distance) + ", rim_radius: 0.035}}";
}

/// A board of 6 x 6 tags, 0.6 m wide, in front of a free camera.
class BoardCalibrationTest : public testing::Test {
 protected:
  /// A pose of the camera in the board's frame: the board's middle is at this distance (m) in this
  /// direction from the camera, with a random tilt.
  Pose poseBefore(const Eigen::Vector3d& in_camera, double distance) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const Eigen::Vector3d toward = in_camera.normalized();
    // The board's face looks back at the camera, within 35 degrees.
    const Eigen::Quaterniond facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -toward);
    const Eigen::Quaterniond tilt(
        Eigen::AngleAxisd(radians(35.0) * uniform(generator), Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(radians(35.0) * uniform(generator), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(kPi * uniform(generator), Eigen::Vector3d::UnitZ()));
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
    camera_from_board.linear() = (facing * tilt).toRotationMatrix();
    const Eigen::Vector3d middle(0.3, 0.3, 0.0);
    camera_from_board.translation() = distance * toward - camera_from_board.linear() * middle;
    return Pose::fromIsometry(camera_from_board.inverse());
  }

  /// What a camera sees of the board at directions from `least` to `most` (rad) off its axis.
  std::vector<FrameReadings> record(const MountedCamera& camera, double least, double most) {
    constexpr int kImages = 24;
    std::vector<FrameReadings> frames;
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kImages; ++i) {
      const double angle = least + (most - least) * std::sqrt(uniform(generator));
      const double azimuth = 2.0 * kPi * i / 8.0;
      const Eigen::Vector3d direction(std::sin(angle) * std::cos(azimuth),
                                      std::sin(angle) * std::sin(azimuth), std::cos(angle));
      const Pose pose = poseBefore(direction, 0.5 + 0.5 * uniform(generator));
      FrameReadings frame;
      frame.stamp = i;
      frame.base_from_camera = Eigen::Isometry3d::Identity();
      for (const Marker& marker : board.markers) {
        const auto reading = test::exactReading(marker, camera, pose);
        if (reading) frame.readings.push_back(test::withNoise(*reading, kNoise, &generator));
      }
      frames.push_back(frame);
    }
    return frames;
  }

  CalibrationResult calibrate(const std::string& truth, const std::string& guess, double least,
                              double most) {
    CalibrationConfig config;
    config.is_free = true;
    const MountedCamera camera(parseCamera(truth, "truth"), Eigen::Isometry3d::Identity());
    return calibrateCamera(CameraTemplate::fromText(guess, "guess"), board,
                           record(camera, least, most), config);
  }

  static const CalibratedParameter& of(const CalibrationResult& result, const std::string& name) {
    const auto found = std::find_if(
        result.parameters.begin(), result.parameters.end(),
        [&name](const CalibratedParameter& parameter) { return parameter.guess.name == name; });
    if (found == result.parameters.end()) throw InputError("no parameter " + name);
    return *found;
  }

  static void expectWithin(const CalibrationResult& result, const std::string& name, double truth) {
    const CalibratedParameter& parameter = of(result, name);
    EXPECT_TRUE(parameter.held.empty()) << name << ": " << parameter.held;
    EXPECT_LT(std::abs(parameter.value - truth), 4.0 * parameter.deviation) << name;
  }

  MarkerMap board = parseBoard(
      "{target_type: aprilgrid, tagCols: 6, tagRows: 6, tagSize: 0.08, tagSpacing: 0.3}", "board");
  std::mt19937 generator{8};
};

TEST_F(BoardCalibrationTest, CalibratesAFisheye) {
  const CalibrationResult result =
      calibrate(fisheye(210.0, 352.3, 347.1, "[-0.012, 0.003, -0.0008, 0.0001]"),
                fisheye(216.0, 349.5, 349.5, "[0, 0, 0, 0]"), 0.0, radians(75.0));
  EXPECT_LT(result.after.rms, 1.1 * std::sqrt(2.0) * kNoise);
  expectWithin(result, "fx", 210.0);
  expectWithin(result, "fy", 210.0);
  expectWithin(result, "cx", 352.3);
  expectWithin(result, "cy", 347.1);
  for (const char* name : {"z", "roll", "pitch"}) EXPECT_FALSE(of(result, name).held.empty());
}

TEST_F(BoardCalibrationTest, CalibratesAMirror) {
  const CalibrationResult result =
      calibrate(mirror(1700.0, 502.0, 497.0, 0.11), mirror(1735.0, 499.5, 499.5, 0.113),
                radians(60.0), radians(110.0));
  EXPECT_LT(result.after.rms, 1.1 * std::sqrt(2.0) * kNoise);
  expectWithin(result, "cx", 502.0);
  expectWithin(result, "cy", 497.0);
  expectWithin(result, "fx", 1700.0);
}

TEST_F(BoardCalibrationTest, SaysWhereTheFieldWasNotCovered) {
  // The board is never farther out than two fifths of the field.
  const CalibrationResult result =
      calibrate(fisheye(210.0, 352.3, 347.1, "[0, 0, 0, 0]"),
                fisheye(212.0, 349.5, 349.5, "[0, 0, 0, 0]"), 0.0, radians(25.0));
  const bool is_told =
      std::any_of(result.remarks.begin(), result.remarks.end(), [](const std::string& remark) {
        return remark.find("none in") != std::string::npos &&
               remark.find("the rim") != std::string::npos;
      });
  EXPECT_TRUE(is_told);
}

TEST_F(BoardCalibrationTest, ABoardThatIsNeverTiltedIsRefused) {
  CalibrationConfig config;
  config.is_free = true;
  const std::string truth = fisheye(210.0, 352.3, 347.1, "[0, 0, 0, 0]");
  const MountedCamera camera(parseCamera(truth, "truth"), Eigen::Isometry3d::Identity());
  std::vector<FrameReadings> frames;
  for (int i = 0; i < 20; ++i) {
    FrameReadings frame;
    frame.stamp = i;
    frame.base_from_camera = Eigen::Isometry3d::Identity();
    // The camera looks straight at the board.
    const Pose pose = Pose::fromIsometry(Eigen::Translation3d(0.3, 0.3, 0.3 + 0.01 * i) *
                                         Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
    for (const Marker& marker : board.markers) {
      const auto reading = test::exactReading(marker, camera, pose);
      if (reading) frame.readings.push_back(test::withNoise(*reading, kNoise, &generator));
    }
    frames.push_back(frame);
  }
  try {
    calibrateCamera(CameraTemplate::fromText(truth, "guess"), board, frames, config);
    FAIL() << "was not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("from one side only"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace omnitag
