#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "omnitag/ros/localizer_server.h"

namespace omnitag {

/// The localizer in a nodelet manager.
class LocalizerNodelet : public nodelet::Nodelet {
 private:
  /// The manager reports a nodelet that throws as not loaded, and goes on.
  void onInit() override {
    try {
      server_ = std::make_unique<LocalizerServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM(error.what());
      throw;
    }
  }

  std::unique_ptr<LocalizerServer> server_;
};

}  // namespace omnitag

PLUGINLIB_EXPORT_CLASS(omnitag::LocalizerNodelet, nodelet::Nodelet)
