#include "ros/stamp_timeline.h"

#include <cmath>

namespace omnitag {
namespace {

/// s: after this time, all images from before the clock was set have come.
constexpr double kImagesInFlight = 10.0;

/// s: the smallest step that counts.
constexpr double kLeastStep = 1e-3;

}  // namespace

void StampTimeline::clockStepped(double seconds) {
  pending_step_ += seconds;
  // The clock was set and set back.
  if (std::abs(pending_step_) < kLeastStep) pending_step_ = 0.0;
  pending_for_ = 0.0;
}

StampPlace StampTimeline::place(const ros::Time& stamp) const {
  if (!last_stamp_) return {StampPlace::Kind::kLater, stamp.toSec(), 0.0};
  // In doubles, because ros::Duration throws beyond 68 years.
  const double passed = stamp.toSec() - last_stamp_->toSec();
  // Images that are still on their way have stamps from before the clock was set. If the stamp may
  // be from before or after, the shorter time is taken as the one that passed.
  const double without_step = passed - pending_step_;
  const bool shows_step = without_step > 0.0 && (passed <= 0.0 || without_step < passed);
  if (pending_step_ != 0.0 && shows_step) {
    return {StampPlace::Kind::kClockStepped, last_time_ + without_step, pending_step_};
  }
  if (passed > 0.0) return {StampPlace::Kind::kLater, last_time_ + passed, 0.0};
  if (-passed > restart_time_jump_) return {StampPlace::Kind::kWentBack, stamp.toSec(), passed};
  return {StampPlace::Kind::kLate, last_time_, passed};
}

std::optional<double> StampTimeline::behind(const ros::Time& stamp) const {
  if (!last_stamp_) return std::nullopt;
  const double passed = stamp.toSec() - last_stamp_->toSec();
  const double with_step = passed + shown_step_;
  return -(std::abs(with_step) < std::abs(passed) ? with_step : passed);
}

void StampTimeline::take(const ros::Time& stamp, const StampPlace& place) {
  pending_for_ += place.time - last_time_;
  shown_for_ += place.time - last_time_;
  if (shown_for_ > kImagesInFlight) shown_step_ = 0.0;
  if (place.kind == StampPlace::Kind::kClockStepped) {
    shown_step_ = place.step;
    shown_for_ = 0.0;
  }
  if (place.kind != StampPlace::Kind::kLater || pending_for_ > kImagesInFlight) pending_step_ = 0.0;
  last_stamp_ = stamp;
  last_time_ = place.time;
}

}  // namespace omnitag
