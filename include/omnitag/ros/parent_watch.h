#pragma once

#include <geometry_msgs/TransformStamped.h>

#include <optional>
#include <string>

#include "omnitag/ros/parameters.h"

namespace omnitag {

/// Notices where somebody else gives the frame that is to be sent a parent in tf: a frame has only
/// one, and tf would jump between the two. What has the map as parent on /tf is taken for the
/// localizer's own, or a recording of it, whoever sends it.
class ParentWatch {
 public:
  /// `frames`: with the map's frame filled in.
  explicit ParentWatch(const FrameNames& frames);

  /// A transform of /tf or /tf_static; `now` in s, of any clock that is not set.
  void see(const geometry_msgs::TransformStamped& transform, bool is_static, double now);

  /// In one line, what the other parent is and what to set; nothing where there is none. One of /tf
  /// counts for 10 s.
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

/// The frame that the localizer gives the map as parent: odom, or base where there is no odometry.
const std::string& sentFrame(const FrameNames& frames);

}  // namespace omnitag
