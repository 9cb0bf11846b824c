#include "omnitag/ros/transform_input.h"

namespace omnitag {
namespace {

/// s of tf that are kept: images that waited in a long queue still find theirs.
constexpr double kKept = 30.0;

constexpr bool kListenerHasOwnThread = false;

}  // namespace

TransformInput::TransformInput(const ros::NodeHandle& node)
    : node_(node), buffer_(ros::Duration(kKept)) {
  node_.setCallbackQueue(&queue_);
  listener_ = std::make_unique<tf2_ros::TransformListener>(buffer_, node_, kListenerHasOwnThread);
}

void TransformInput::serve(double duration) {
  queue_.callAvailable(ros::WallDuration(duration));
  // What came before the clock was set back, as when a bag is played again, would seem to be the
  // newest from then on. What the listener clears by itself, it may fill again with that.
  const ros::Time now = ros::Time::now();
  if (now < last_served_) buffer_.clear();
  last_served_ = now;
}

}  // namespace omnitag
