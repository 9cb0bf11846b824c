#include "ros/localize_bag/result_bag.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <set>

#include "omnitag/common/error.h"
#include "ros/conversions.h"
#include "ros/map_markers.h"
#include "ros/map_publisher.h"
#include "ros/parent_watch.h"
#include "ros/result_messages.h"

namespace omnitag {
namespace {

const std::string kCompressed = "/compressed";

/// The header of a connection that rosbag play will latch.
template <typename Message>
boost::shared_ptr<ros::M_string> latched(const Message& message) {
  namespace traits = ros::message_traits;
  auto header = boost::make_shared<ros::M_string>();
  (*header)["latching"] = "1";
  (*header)["type"] = traits::datatype(message);
  (*header)["md5sum"] = traits::md5sum(message);
  (*header)["message_definition"] = traits::definition(message);
  return header;
}

}  // namespace

ResultBag::ResultBag(const std::string& path, const LocalizerParameters& parameters,
                     const ImageLocalizer& localizer, bool sends_transform)
    : frames_(localizer.frames()),
      transform_tolerance_(parameters.transform_tolerance),
      sends_transform_(sends_transform),
      sends_marker_transforms_(parameters.publish_marker_tf),
      estimation_(parameters.localizer.estimation),
      frame_markers_(frames_.map, parameters.robot_radius),
      path_(parameters.path_min_step, parameters.path_max_poses) {
  for (std::size_t i = 0; i < parameters.cameras.size(); ++i) {
    debug_image_topics_.push_back("/" + debugImageTopic(parameters.cameras[i].name));
    debug_image_painters_.emplace_back(localizer.cameras()[i], localizer.map());
  }
  try {
    bag_.open(path, rosbag::bagmode::Write);
  } catch (const std::exception&) {
    throw InputError(path + ": cannot be written");
  }
}

bool ResultBag::isOwn(const std::string& topic) const {
  static const std::set<std::string> kOwn = {"/pose",          "/pose_with_covariance",
                                             "/pose_measured", "/detections",
                                             "/status",        "/path",
                                             "/markers",       "/marker_map"};
  return kOwn.count(topic) > 0 ||
         std::any_of(debug_image_topics_.begin(), debug_image_topics_.end(),
                     [&topic](const std::string& debug_image) {
                       return topic == debug_image || topic == debug_image + kCompressed;
                     });
}

void ResultBag::copy(const rosbag::MessageInstance& message, const ros::Time& time) {
  if (isOwn(message.getTopic())) return;
  if (message.getTopic() == "/tf") {
    if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
      tf2_msgs::TFMessage kept = *transforms;
      kept.transforms.erase(std::remove_if(kept.transforms.begin(), kept.transforms.end(),
                                           [&](const geometry_msgs::TransformStamped& transform) {
                                             return withoutSlash(transform.header.frame_id) ==
                                                        withoutSlash(frames_.map) &&
                                                    withoutSlash(transform.child_frame_id) ==
                                                        withoutSlash(sentFrame(frames_));
                                           }),
                            kept.transforms.end());
      if (!kept.transforms.empty()) bag_.write("/tf", time, kept);
      return;
    }
  }
  bag_.write(message.getTopic(), time, message, message.getConnectionHeader());
}

void ResultBag::add(const ros::Time& time, const LocalizedImage& localized,
                    const ImageLocalizer& localizer) {
  const MarkerMap& map = localizer.map();
  if (!has_map_markers_ || localized.map_changed) addMap(time, localizer);
  has_map_markers_ = true;
  if (localized.went_back > 0.0) path_.clear();

  ResultMessages messages = toMessages(localized, map, frames_, transform_tolerance_);
  if (messages.transform && sends_transform_) {
    tf2_msgs::TFMessage transforms;
    transforms.transforms.push_back(*messages.transform);
    bag_.write("/tf", time, transforms);
  }
  if (messages.pose) {
    bag_.write("/pose", time, *messages.pose);
    bag_.write("/pose_with_covariance", time, *messages.pose_with_covariance);
    if (path_.add(*messages.pose)) {
      bag_.write("/path", time, path_.path(), latched(path_.path()));
    }
  }
  if (messages.pose_measured) bag_.write("/pose_measured", time, *messages.pose_measured);
  addMarkerPoses(localized, map, localizer.cameras()[localized.input.frame.camera], estimation_,
                 &messages.detections);
  bag_.write("/detections", time, messages.detections);
  bag_.write("/status", time, messages.status);
  bag_.write("/markers", time, frame_markers_.draw(localized, map));
  addDebugImage(time, localized);
}

void ResultBag::addMap(const ros::Time& time, const ImageLocalizer& localizer) {
  const MarkerMap& map = localizer.map();
  bag_.write("/markers", time, mapMarkers(map, localizer.provisional(), frames_.map));
  MapMarkerArray markers = toMessage(map, localizer.ignoredMarkers(), frames_.map);
  markers.header.stamp = time;
  bag_.write("/marker_map", time, markers, latched(markers));
  for (DebugImagePainter& painter : debug_image_painters_) painter.setMap(map);
  if (!sends_marker_transforms_) return;
  const tf2_msgs::TFMessage transforms = markerTransforms(map, frames_.map, time);
  bag_.write("/tf_static", time, transforms, latched(transforms));
}

void ResultBag::addDebugImage(const ros::Time& time, const LocalizedImage& localized) {
  const std::size_t camera = localized.input.frame.camera;
  const cv::Mat painting =
      debug_image_painters_[camera].paint(localized.input.frame.image, localized.result);
  const cv_bridge::CvImage image(localized.input.header, sensor_msgs::image_encodings::BGR8,
                                 painting);
  bag_.write(debug_image_topics_[camera] + kCompressed, time,
             *image.toCompressedImageMsg(cv_bridge::JPG));
}

}  // namespace omnitag
