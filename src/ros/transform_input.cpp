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
  listener_.emplace(buffer_, node_, kListenerHasOwnThread);
}

}  // namespace omnitag
