#include "adjustment/calibration_checks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

std::string rounded(double number, int digits) {
  const double unit = std::pow(10.0, digits);
  std::string text = std::to_string(std::round(number * unit) / unit);
  text.resize(text.find('.') + (digits > 0 ? 1 + static_cast<std::size_t>(digits) : 0));
  return text;
}

}  // namespace

void checkMounting(const std::vector<FrameReadings>& frames) {
  constexpr double kTolerance = 1e-6;
  for (const FrameReadings& frame : frames) {
    if (frame.base_from_camera.isApprox(frames.front().base_from_camera, kTolerance)) continue;
    throw InputError("tf: the camera moves on the robot at stamp " + rounded(frame.stamp, 3) +
                     ", expected the same mounting in all images: calibrate with a fixed one");
  }
}

void checkCoverage(const std::vector<CalibrationFrame>& frames, const ImagePlane& plane,
                   bool is_board) {
  constexpr double kLargestGap = radians(120.0);
  std::vector<double> azimuths;
  for (const CalibrationFrame& frame : frames) {
    for (const MarkerObservation& observation : frame.observations) {
      const Eigen::Vector2d way = observation.center - plane.principalPoint();
      azimuths.push_back(std::atan2(way.y(), way.x()));
    }
  }
  std::sort(azimuths.begin(), azimuths.end());
  double gap = azimuths.front() + 2.0 * kPi - azimuths.back();
  for (std::size_t i = 1; i < azimuths.size(); ++i) {
    gap = std::max(gap, azimuths[i] - azimuths[i - 1]);
  }
  if (gap <= kLargestGap) return;
  throw InputError("markers were seen on one side of the image only: " + rounded(degrees(gap), 0) +
                   " degrees of it show none, which leaves the centre and the lean open; " +
                   (is_board ? "hold the board all around the middle"
                             : "turn the robot all around while it drives"));
}

void checkMotion(const std::vector<Pose>& poses) {
  constexpr double kLeastMotion = 0.5;  // m
  const auto [west, east] = std::minmax_element(
      poses.begin(), poses.end(), [](const Pose& a, const Pose& b) { return a.x < b.x; });
  const auto [south, north] = std::minmax_element(
      poses.begin(), poses.end(), [](const Pose& a, const Pose& b) { return a.y < b.y; });
  const double motion = std::hypot(east->x - west->x, north->y - south->y);
  if (motion >= kLeastMotion) return;
  throw InputError(
      "the robot moved by " + rounded(motion, 2) + " m only, expected at least " +
      rounded(kLeastMotion, 1) +
      " m: drive toward markers and away from them, so that they are seen high and low "
      "in the image");
}

void checkViews(const std::vector<Pose>& poses) {
  constexpr double kLeastAngle = radians(20.0);
  double largest = 0.0;
  for (const Pose& pose : poses) {
    const Eigen::Matrix3d between =
        poses.front().toIsometry().linear().transpose() * pose.toIsometry().linear();
    largest = std::max(largest, Eigen::AngleAxisd(between).angle());
  }
  if (largest >= kLeastAngle) return;
  throw InputError("the board was seen from one side only: its images differ by " +
                   rounded(degrees(largest), 0) + " degrees, expected at least " +
                   rounded(degrees(kLeastAngle), 0) +
                   ": hold it in other places of the image, near and far, and tilt it");
}

}  // namespace omnitag
