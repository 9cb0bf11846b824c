#pragma once

#include <ros/time.h>

#include <optional>

namespace omnitag {

/// Where the stamp of an image belongs on the timeline.
struct StampPlace {
  enum class Kind {
    kLater,         ///< after the previous image
    kLate,          ///< not after the previous image, e.g. overtaken on its way
    kClockStepped,  ///< after the previous image, though the stamping clock was set in between
    kWentBack,      ///< the stamps alone started again, as in a bag that loops
  };
  Kind kind = Kind::kLater;
  /// s, on the timeline.
  double time = 0.0;
  /// s: how far the clock was set (kClockStepped), or how far the stamp lies behind the previous
  /// one (kLate, kWentBack); negative if time goes back.
  double step = 0.0;
};

/// Puts the stamps of images on a timeline that runs forward even when clocks are set. It starts
/// afresh when the stamps alone go back.
class StampTimeline {
 public:
  /// `restart_time_jump`: s; stamps alone that step back by less are late, by more went back.
  explicit StampTimeline(double restart_time_jump) : restart_time_jump_(restart_time_jump) {}

  /// The clock was set by this many seconds. The next stamps may show it, or not if another clock
  /// stamps the images.
  void clockStepped(double seconds);

  /// Where an image that comes now would belong.
  StampPlace place(const ros::Time& stamp) const;

  /// s: how far a stamp lies behind the last one, negative if after it; nothing before the first
  /// one. With several cameras, stamps from before and after the clock was set come mixed for a
  /// while.
  std::optional<double> behind(const ros::Time& stamp) const;

  /// s, on the timeline, of the last image.
  double lastTime() const { return last_time_; }

  /// Takes the image at its place; not to be called for a late one.
  void take(const ros::Time& stamp, const StampPlace& place);

 private:
  double restart_time_jump_;
  std::optional<ros::Time> last_stamp_;
  double last_time_ = 0.0;
  /// s: how far the clock was set without a stamp showing it yet, and how long ago on the timeline.
  double pending_step_ = 0.0;
  double pending_for_ = 0.0;
  /// s: the step that a stamp has shown, and how long ago on the timeline.
  double shown_step_ = 0.0;
  double shown_for_ = 0.0;
};

}  // namespace omnitag
