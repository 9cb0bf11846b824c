#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ros/localizer_starter.h"

namespace omnitag {

/// The localizer in a nodelet manager.
class LocalizerNodelet : public nodelet::Nodelet {
 private:
  /// If this throws, the manager reports the nodelet as not loaded and continues.
  void onInit() override {
    try {
      starter_ = std::make_unique<LocalizerStarter>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM(error.what());
      throw;
    }
  }

  std::unique_ptr<LocalizerStarter> starter_;
};

}  // namespace omnitag

PLUGINLIB_EXPORT_CLASS(omnitag::LocalizerNodelet, nodelet::Nodelet)
