#pragma once

#include <Eigen/Core>
#include <vector>

#include "omnitag/localization/localizer.h"

namespace omnitag::test {

/// Which of the localizer's poses a filter takes as measurements.
enum class FilterInput {
  kMeasured,  ///< FrameResult::measured
  kPose,      ///< FrameResult::map_from_base, which already includes the odometry
};

/// A drive in circles among three markers, hidden in every other stretch. The images are rendered
/// once; each drive has its own noise, odometry and map.
class FilteredDrive {
 public:
  explicit FilteredDrive(std::size_t frames);

  /// The normalised estimation error squared (NEES) of each frame, with three degrees of freedom,
  /// of an extended Kalman filter of (x, y, yaw) that fuses odometry with the localizer's poses.
  /// The localizer's map is off by `map_deviation` (m, and 3.5 times that in rad; standard
  /// deviation along and about each axis), and says so.
  std::vector<double> nees(FilterInput input, double map_deviation, unsigned seed) const;

 private:
  MarkerMap map_;
  std::vector<Pose> route_;
  std::vector<cv::Mat> images_;
};

double mean(const std::vector<double>& values);

}  // namespace omnitag::test
