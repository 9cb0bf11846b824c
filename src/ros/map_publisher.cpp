#include "ros/map_publisher.h"

#include <Eigen/Geometry>
#include <cctype>
#include <map>
#include <utility>

#include "ros/conversions.h"

namespace omnitag {
namespace {

MapMarker mapMarkerOf(const Marker& marker, bool is_ignored) {
  MapMarker message;
  message.id = marker.id;
  message.family = marker.family;
  message.name = marker.name;
  message.size = marker.size;
  message.pose = poseOf(marker);
  message.deviation = marker.deviation;
  message.orientation_deviation = marker.orientation_deviation;
  message.ignored = static_cast<std::uint8_t>(is_ignored);
  return message;
}

/// Without characters that tools trip over in names of frames, such as blanks.
std::string frameOf(const Marker& marker) {
  std::string name =
      marker.name.empty() ? marker.family + "_" + std::to_string(marker.id) : marker.name;
  for (char& c : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.';
    if (!is_plain) c = '_';
  }
  return "marker_" + name;
}

}  // namespace

MapMarkerArray toMessage(const MarkerMap& map, const std::vector<Marker>& ignored,
                         const std::string& map_frame) {
  MapMarkerArray message;
  message.header.frame_id = map_frame;
  for (const Marker& marker : map.markers) message.markers.push_back(mapMarkerOf(marker, false));
  for (const Marker& marker : ignored) message.markers.push_back(mapMarkerOf(marker, true));
  return message;
}

tf2_msgs::TFMessage markerTransforms(const MarkerMap& map, const std::string& map_frame,
                                     const ros::Time& stamp) {
  tf2_msgs::TFMessage message;
  std::map<std::string, int> counts;
  for (const Marker& marker : map.markers) {
    std::string frame = frameOf(marker);
    if (const int count = ++counts[frame]; count > 1) frame += "_" + std::to_string(count);
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = map_frame;
    transform.header.stamp = stamp;
    transform.child_frame_id = frame;
    transform.transform = toMessage(marker.map_from_marker);
    message.transforms.push_back(std::move(transform));
  }
  return message;
}

MapPublisher::MapPublisher(ros::NodeHandle node, std::string map_frame, bool sends_transforms)
    : map_frame_(std::move(map_frame)) {
  constexpr bool kLatched = true;
  map_publisher_ = node.advertise<MapMarkerArray>("marker_map", 1, kLatched);
  if (sends_transforms) {
    transform_publisher_ = node.advertise<tf2_msgs::TFMessage>("/tf_static", 10, kLatched);
  }
}

void MapPublisher::publish(const MarkerMap& map, const std::vector<Marker>& ignored) {
  const ros::Time now = ros::Time::now();
  MapMarkerArray message = toMessage(map, ignored, map_frame_);
  message.header.stamp = now;
  map_publisher_.publish(message);
  if (transform_publisher_) {
    transform_publisher_.publish(markerTransforms(map, map_frame_, now));
  }
}

}  // namespace omnitag
