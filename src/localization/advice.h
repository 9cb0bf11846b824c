#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Explains in words what is most likely wrong with a robot's files and settings, and what to do
/// about it, once its images have shown it repeatedly.
class Advisor {
 public:
  void add(const FrameResult& result, const MarkerMap& map, const CameraModel& camera);

  /// One line for each finding; none if everything agrees with the files.
  std::vector<std::string> lines() const;

 private:
  /// A mean over recent images.
  class Mean {
   public:
    void add(double value) {
      constexpr double kRemembered = 0.95;
      weight_ = kRemembered * weight_ + 1.0;
      sum_ = kRemembered * sum_ + value;
    }
    /// 0 while there are only a few values.
    double value() const {
      constexpr double kFew = 8.0;
      return weight_ < kFew ? 0.0 : sum_ / weight_;
    }

   private:
    double weight_ = 0.0;
    double sum_ = 0.0;
  };

  Mean excess_;
  /// m: how far markers are off their places at the estimated pose.
  Mean misplacement_;
  /// How far the image seems off at the rim, in pixels and in standard deviations.
  Mean rim_error_;
  Mean rim_deviations_;
  Mean blur_;
  ImageExposure exposure_ = ImageExposure::kGood;
  std::optional<double> lag_;
};

}  // namespace omnitag
