#pragma once

#include <ros/time.h>

#include <optional>

namespace omnitag {

/// Where the stamp of an image belongs on the timeline.
struct StampPlace {
  enum class Kind {
    kLater,         ///< after the image before
    kLate,          ///< not after the image before, as one that was overtaken on its way
    kClockStepped,  ///< after the image before, though the clock that stamps them was set meanwhile
    kWentBack,      ///< the stamps alone began again, as those of a bag that loops
  };
  Kind kind = Kind::kLater;
  /// s, on the timeline.
  double time = 0.0;
  /// s: by how much the clock was set (kClockStepped), or the stamp lies behind the one before
  /// (kLate, kWentBack); negative where time goes back.
  double step = 0.0;
};

/// Puts the stamps of images on a line of time that only runs forward, whatever the clocks do.
class StampTimeline {
 public:
  /// s by which stamps alone may step back and count as late; by more, they went back.
  explicit StampTimeline(double restart_time_jump) : restart_time_jump_(restart_time_jump) {}

  /// The clock was set by this many seconds; the next stamps may show it, or not, where another
  /// clock stamps the images.
  void clockStepped(double seconds);

  /// Where an image that comes now would belong.
  StampPlace place(const ros::Time& stamp) const;

  /// Takes the image that belongs there; not for one that is late.
  void take(const ros::Time& stamp, const StampPlace& place);

 private:
  double restart_time_jump_;
  std::optional<ros::Time> last_stamp_;
  double last_time_ = 0.0;
  /// s by which the clock was set, which no stamp has shown yet, and how long ago on the timeline.
  double pending_step_ = 0.0;
  double pending_for_ = 0.0;
};

}  // namespace omnitag
