#pragma once

#include <omnitag/MapMarkerArray.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The map as a message; ignored markers come last.
MapMarkerArray toMessage(const MarkerMap& map, const std::vector<Marker>& ignored,
                         const std::string& map_frame);

/// The markers' frames in the map's frame: `marker_NAME` if the marker has a name, else
/// `marker_FAMILY_ID`, with `_` for blanks and the like. If another marker has the same frame, `_2`
/// and so on are appended.
tf2_msgs::TFMessage markerTransforms(const MarkerMap& map, const std::string& map_frame,
                                     const ros::Time& stamp);

/// Publishes where the markers hang: latched on `marker_map` and, if asked for, on /tf_static.
class MapPublisher {
 public:
  MapPublisher(ros::NodeHandle node, std::string map_frame, bool sends_transforms);

  void publish(const MarkerMap& map, const std::vector<Marker>& ignored);

 private:
  std::string map_frame_;
  ros::Publisher map_publisher_;
  /// None if no transforms are sent.
  ros::Publisher transform_publisher_;
};

}  // namespace omnitag
