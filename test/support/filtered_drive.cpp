#include "filtered_drive.h"

#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "level_floor.h"
#include "panorama_renderer.h"
#include "planar_filter.h"
#include "sample_cameras.h"
#include "sample_markers.h"

namespace omnitag::test {
namespace {

constexpr double kPeriod = 0.1;     // s between frames
constexpr double kGreyNoise = 8.0;  // grey levels, standard deviation of each pixel
constexpr double kStep = 0.03;      // m along x of the robot, from frame to frame
constexpr double kTurn = 0.15;      // rad
constexpr double kSlip = 0.01;      // m per m, m per rad, rad per m and rad per rad

/// In every other stretch of this many frames, no marker is in sight.
constexpr std::size_t kStretch = 8;
bool isDark(std::size_t frame) { return frame / kStretch % 2 == 1; }

Eigen::Vector3d numbersOf(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

/// Standard deviations of odometry's error from frame to frame (m, m, rad), see MotionModelConfig.
Eigen::Vector3d slipOf(const Pose& motion) {
  const double way = std::hypot(motion.x, motion.y);
  const double slip = kSlip * std::hypot(way, motion.yaw);
  return {slip, slip, slip};
}

LocalizerConfig driveConfig() {
  LocalizerConfig config = onLevelFloor();
  config.motion.odometry_translation_per_metre = kSlip;
  config.motion.odometry_translation_per_rotation = kSlip;
  config.motion.odometry_rotation_per_metre = kSlip;
  config.motion.odometry_rotation_per_rotation = kSlip;
  return config;
}

class Chance {
 public:
  explicit Chance(unsigned seed) : generator_(seed) {}
  double normal() { return normal_(generator_); }
  Eigen::Vector3d normals() { return {normal(), normal(), normal()}; }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_{0.0, 1.0};
};

MarkerMap misplaced(MarkerMap map, double deviation, Chance* chance) {
  const double turn = 3.5 * deviation;
  for (Marker& marker : map.markers) {
    marker.deviation = deviation;
    marker.orientation_deviation = turn;
    const Eigen::Vector3d rotation = turn * chance->normals();
    marker.map_from_marker.pretranslate(deviation * chance->normals());
    if (rotation.norm() > 0.0) {
      marker.map_from_marker.rotate(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()));
    }
  }
  return map;
}

cv::Mat withNoise(const cv::Mat& image, unsigned seed) {
  cv::RNG generator(seed);
  cv::Mat noise(image.size(), CV_16SC1);
  generator.fill(noise, cv::RNG::NORMAL, 0.0, kGreyNoise);
  cv::Mat noisy;
  cv::add(image, noise, noisy, cv::noArray(), CV_8UC1);
  return noisy;
}

}  // namespace

FilteredDrive::FilteredDrive(std::size_t frames)
    : map_{"map", {roomMarkers().at(0), roomMarkers().at(3), roomMarkers().at(6)}} {
  for (Marker& marker : map_.markers) marker.size = 0.5;
  Pose pose{0.2, -0.3, -0.2};
  for (std::size_t i = 0; i < frames; ++i) {
    route_.push_back(pose);
    const MountedCamera camera(sphericalCamera(), lookingDown());
    images_.push_back(isDark(i) ? cv::Mat(images_.front().size(), CV_8UC1, cv::Scalar(20))
                                : renderPanorama(map_, camera, pose));
    pose = pose * Pose{kStep, 0.0, kTurn};
  }
}

std::vector<double> FilteredDrive::nees(FilterInput input, double map_deviation,
                                        unsigned seed) const {
  Chance chance(seed);
  Localizer localizer(sphericalCamera(), misplaced(map_, map_deviation, &chance), driveConfig());
  localizer.setPose(route_.front());
  std::optional<PlanarFilter> filter;
  std::vector<double> nees;
  Pose odom_from_base;
  for (std::size_t i = 0; i < route_.size(); ++i) {
    if (i > 0) {
      const Pose motion = inverse(route_[i - 1]) * route_[i];
      const Eigen::Vector3d slip = slipOf(motion);
      const Eigen::Vector3d felt = numbersOf(motion) + slip.cwiseProduct(chance.normals());
      odom_from_base = odom_from_base * Pose{felt.x(), felt.y(), felt.z()};
      if (filter) filter->predict(felt, slip);
    }
    Frame frame{kPeriod * static_cast<double>(i),
                withNoise(images_[i], seed * 1000U + static_cast<unsigned>(i)), lookingDown(),
                odom_from_base};
    frame.wants_measured = true;
    const FrameResult result = localizer.process(frame);
    const std::optional<PoseEstimate>& pose =
        input == FilterInput::kMeasured ? result.measured : result.map_from_base;
    if (pose && filter) {
      filter->correct(numbersOf(pose->pose), floorCovariance(*pose));
    } else if (pose) {
      filter.emplace(numbersOf(pose->pose), floorCovariance(*pose));
    }
    if (filter) nees.push_back(filter->nees(numbersOf(route_[i])));
  }
  return nees;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace omnitag::test
