#pragma once

#include <omnitag/MapMarkerArray.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The map as a message; what is ignored comes last.
MapMarkerArray toMessage(const MarkerMap& map, const std::vector<Marker>& ignored,
                         const std::string& map_frame);

/// The markers' frames in the map's: `marker_NAME` where the marker has a name, else
/// `marker_FAMILY_ID`, with `_` for blanks and the like, and `_2` and so on behind where another
/// has the same.
tf2_msgs::TFMessage markerTransforms(const MarkerMap& map, const std::string& map_frame,
                                     const ros::Time& stamp);

/// Tells others where the markers hang: latched on `marker_map`, and, where that is asked for, on
/// /tf_static.
class MapPublisher {
 public:
  MapPublisher(ros::NodeHandle node, std::string map_frame, bool sends_transforms);

  void publish(const MarkerMap& map, const std::vector<Marker>& ignored);

 private:
  std::string map_frame_;
  ros::Publisher map_publisher_;
  /// None where no transforms are sent.
  ros::Publisher transform_publisher_;
};

}  // namespace omnitag
