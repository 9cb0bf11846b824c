#pragma once

#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

#include "ros/localizer_settings.h"

namespace omnitag {

/// The services that change the map while the localizer runs: reload_map, change_map, add_marker,
/// remove_marker and ignore_markers. Each answers in words, in the log, too.
class MapServices {
 public:
  /// `settings` must outlive it. `may_change_frame`: whether the parameter map_frame names the
  /// map's frame, whatever the file says.
  MapServices(const ros::NodeHandle& node, std::string name, bool may_change_frame,
              LocalizerSettings* settings);

  /// Waits for a running callback; afterwards, none starts.
  void shutdown();

 private:
  template <typename Service>
  void offer(const std::string& service,
             std::function<std::string(const typename Service::Request&)> work);

  ros::NodeHandle node_;
  std::string name_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace omnitag
