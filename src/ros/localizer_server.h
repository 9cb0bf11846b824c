#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ros/clock_watch.h"
#include "ros/debug_images.h"
#include "ros/frame_markers.h"
#include "ros/health_monitor.h"
#include "ros/image_input.h"
#include "ros/image_localizer.h"
#include "ros/live_tuning.h"
#include "ros/localizer_settings.h"
#include "ros/map_markers.h"
#include "ros/map_publisher.h"
#include "ros/map_services.h"
#include "ros/marker_dragging.h"
#include "ros/parameters.h"
#include "ros/path_recorder.h"
#include "ros/pose_keeper.h"
#include "ros/transform_input.h"

namespace omnitag {

/// The localizer on topics, tf and services. Nodelet and node both run this class, started by
/// LocalizerStarter.
///
/// Callbacks only store what they receive, or prepare a Successor. One thread takes the images and
/// does all the work, so that the newest image waits for nothing else.
class LocalizerServer {
 public:
  /// `parameters`: those of `private_node`. `cameras`: those of the parameters, in their order.
  /// Throws InputError with one line if one of them or the map is wrong.
  LocalizerServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                  const LocalizerParameters& parameters,
                  const std::vector<DescribedCamera>& cameras);
  ~LocalizerServer();
  LocalizerServer(const LocalizerServer&) = delete;
  LocalizerServer& operator=(const LocalizerServer&) = delete;

 private:
  /// Its own topics and services.
  void advertise();
  /// Logs what it starts with.
  void announce(const std::vector<DescribedCamera>& cameras) const;
  void run();
  /// Does what is needed whether images come or not: the clock, tf, repeating map -> odom.
  void keepUp();
  void watchClock();
  /// Whether a transform may be sent. If its frame has another parent in tf, reports that and stops
  /// repeating.
  bool checkParent();
  /// Switches to a localizer with another map or other settings, if there is one.
  void takeSuccessor();
  void onImage(const ReceivedImage& received);
  void localize(const cv_bridge::CvImageConstPtr& image, std::size_t camera);
  void waitForTransforms(const std_msgs::Header& header, std::size_t camera);
  void logClockStep(double step) const;
  /// Forgets what was shown and reported before stamps went back by this many s.
  void startAnew(double went_back);
  void publish(const LocalizedImage& localized);
  void sendTransform(const std::optional<geometry_msgs::TransformStamped>& transform,
                     bool has_pose);
  void repeatTransform();
  void broadcast(const geometry_msgs::TransformStamped& transform);

  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message);
  /// Throws InputError.
  void takePose(const geometry_msgs::PoseWithCovarianceStamped& message);
  /// map_from_frame, the latest in tf. Throws InputError.
  Eigen::Isometry3d mapFrom(const std::string& frame) const;
  /// Odometry at a message's stamp; the newest if tf ends before it, none if tf has none.
  std::optional<Pose> odometryAt(const ros::Time& stamp) const;
  void forgetPose();
  void onSaveMap(std_srvs::Trigger::Response* response);
  /// Saves the map; returns in words what was done. Throws InputError.
  std::string saveMap();
  /// Adds the markers that mapping has found to a map file.
  std::string saveLearnt(const std::string& path);
  /// Starts at the saved pose, unless another was given.
  void takeSavedPose();
  /// Shows a map that replaces the previous one.
  void showMap();
  /// Shows what mapping has found. `is_changed`: whether markers that the localizer uses changed.
  void publishMap(bool is_changed);
  void keepPose(const LocalizedImage& localized);
  using Request = std::function<void(ImageLocalizer*)>;
  void request(Request request);

  ros::NodeHandle node_;
  std::string name_;
  LocalizerParameters parameters_;
  ImageLocalizer localizer_;
  /// The cameras' sources, each once.
  std::vector<ImageSource> sources_;
  ImageInput input_;
  TransformInput transforms_;
  ClockWatch clock_watch_;

  /// The map as RViz shows it, and what images have shown so far of other markers and of its own.
  std::mutex map_mutex_;
  MapDrawing map_drawing_;
  std::vector<ProvisionalMarker> provisional_;
  std::vector<RefinedMarker> refined_;
  FrameMarkers frame_markers_;
  PathRecorder path_;

  image_transport::ImageTransport image_transport_;
  DebugImages debug_images_;
  ros::Publisher transform_publisher_;
  ros::Publisher pose_publisher_;
  ros::Publisher pose_with_covariance_publisher_;
  ros::Publisher pose_measured_publisher_;
  ros::Publisher detections_publisher_;
  ros::Publisher status_publisher_;
  ros::Publisher path_publisher_;
  ros::Publisher markers_publisher_;
  ros::Subscriber initial_pose_subscriber_;
  ros::ServiceServer global_localization_server_;
  ros::ServiceServer save_map_server_;

  /// map -> odom of the last image, while it is valid; when it was made and when it was last sent,
  /// by this machine's clock.
  struct Correction {
    geometry_msgs::TransformStamped transform;
    ros::Time made;
    ros::Time sent;
  };
  std::optional<Correction> correction_;

  /// Requests that run before the next image.
  std::mutex request_mutex_;
  std::vector<Request> requests_;
  std::shared_ptr<Successor> successor_;

  LocalizerSettings settings_;
  MapPublisher map_publisher_;
  PoseKeeper pose_keeper_;
  std::optional<MapServices> map_services_;
  std::unique_ptr<LiveTuning> tuning_;
  /// Whether images are processed.
  std::atomic<bool> is_enabled_{true};
  std::unique_ptr<MarkerDragging> marker_dragging_;

  HealthMonitor health_;
  std::thread thread_;
};

}  // namespace omnitag
