#include "ros/rviz_marker.h"

namespace omnitag {

std_msgs::ColorRGBA color(double red, double green, double blue, double opacity) {
  std_msgs::ColorRGBA message;
  message.r = static_cast<float>(red);
  message.g = static_cast<float>(green);
  message.b = static_cast<float>(blue);
  message.a = static_cast<float>(opacity);
  return message;
}

visualization_msgs::Marker rvizMarker(const std::string& frame_id, const std::string& name_space,
                                      int type, const std_msgs::ColorRGBA& color) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = frame_id;
  marker.ns = name_space;
  marker.type = type;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = color;
  return marker;
}

}  // namespace omnitag
