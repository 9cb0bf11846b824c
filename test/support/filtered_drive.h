#pragma once

#include <Eigen/Core>
#include <vector>

#include "omnitag/localization/localizer.h"

namespace omnitag::test {

/// Which of the localizer's poses a filter takes for a measurement.
enum class FilterInput {
  kMeasured,  ///< FrameResult::measured
  kPose,      ///< FrameResult::map_from_base, in which the odometry is already
};

/// A drive in circles among three markers that every other stretch hides, with images that are
/// rendered once, and noise, odometry and a map of its own for each drive.
class FilteredDrive {
 public:
  explicit FilteredDrive(std::size_t frames);

  /// The normalised estimation error squared (NEES) of each frame, with three degrees of freedom,
  /// of an extended Kalman filter of (x, y, yaw) that fuses odometry with the localizer's poses.
  /// The markers hang `map_deviation` (m, and that times 3.5 rad) beside their places in the map
  /// that the localizer is told, which says so.
  std::vector<double> nees(FilterInput input, double map_deviation, unsigned seed) const;

 private:
  MarkerMap map_;
  std::vector<Pose> route_;
  std::vector<cv::Mat> images_;
};

double mean(const std::vector<double>& values);

}  // namespace omnitag::test
