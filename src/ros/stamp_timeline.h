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
  /// s: by how much the clock was set (kClockStepped), or by how much the stamp lies behind the
  /// previous one (kLate, kWentBack); negative if time goes back.
  double step = 0.0;
};

/// Puts the stamps of images on a timeline that runs forward whatever the clocks do, until the
/// stamps alone go back.
class StampTimeline {
 public:
  /// `restart_time_jump`: s by which stamps alone may step back and count as late; beyond, they
  /// went back.
  explicit StampTimeline(double restart_time_jump) : restart_time_jump_(restart_time_jump) {}

  /// The clock was set by this many seconds. The next stamps may show it, or not if another clock
  /// stamps the images.
  void clockStepped(double seconds);

  /// Where an image that comes now would belong.
  StampPlace place(const ros::Time& stamp) const;

  /// s by which a stamp lies behind the last one, negative if after it; nothing before the first
  /// one. Among cameras, stamps from before the clock was set and after it come mixed for a while.
  std::optional<double> behind(const ros::Time& stamp) const;

  /// s, on the timeline, of the last image.
  double lastTime() const { return last_time_; }

  /// Takes the image that belongs there; not to be called for a late one.
  void take(const ros::Time& stamp, const StampPlace& place);

 private:
  double restart_time_jump_;
  std::optional<ros::Time> last_stamp_;
  double last_time_ = 0.0;
  /// s by which the clock was set without a stamp showing it yet, and how long ago on the timeline.
  double pending_step_ = 0.0;
  double pending_for_ = 0.0;
  /// The step that a stamp has shown, and how long ago on the timeline.
  double shown_step_ = 0.0;
  double shown_for_ = 0.0;
};

}  // namespace omnitag
