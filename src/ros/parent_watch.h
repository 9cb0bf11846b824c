#pragma once

#include <geometry_msgs/TransformStamped.h>

#include <optional>
#include <string>

#include "ros/parameters.h"

namespace omnitag {

/// Notices when another node gives the sent frame another parent in tf: a frame has only one
/// parent, and tf would jump between the two. A transform on /tf with the map as parent counts as
/// the localizer's own, or a recording of it, whoever sends it.
class ParentWatch {
 public:
  /// `frames`: with the map's frame filled in.
  explicit ParentWatch(const FrameNames& frames);

  /// A transform of /tf or /tf_static. `now`: s, by any clock that is never set.
  void see(const geometry_msgs::TransformStamped& transform, bool is_static, double now);

  /// One line that says what the other parent is and what to set; nothing if there is no other. A
  /// parent on /tf is remembered for 10 s.
  std::optional<std::string> conflict(double now) const;

 private:
  struct Parent {
    std::string frame;
    bool is_static = false;
    double last_seen = 0.0;
  };

  FrameNames frames_;
  std::optional<Parent> other_;
};

/// The frame that the localizer sends with the map as its parent: odom, or base without odometry.
const std::string& sentFrame(const FrameNames& frames);

}  // namespace omnitag
