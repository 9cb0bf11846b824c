#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "ros/camera_info.h"
#include "ros/image_input.h"
#include "ros/localizer_server.h"
#include "ros/parameters.h"

namespace omnitag {

/// Starts the localizer as soon as its camera is known: with a camera file, at once, or with the
/// first image if the camera is scaled to its images; without a file, when `camera_info` beside the
/// images describes a camera. While waiting, it says so in the log and in /diagnostics. A wrong
/// parameter or map is always refused at once, but a wrong `ignore_markers` only once the camera is
/// known.
class LocalizerStarter {
 public:
  /// Throws InputError with one line if a parameter or a file is wrong.
  LocalizerStarter(const ros::NodeHandle& node, const ros::NodeHandle& private_node);
  ~LocalizerStarter();
  LocalizerStarter(const LocalizerStarter&) = delete;
  LocalizerStarter& operator=(const LocalizerStarter&) = delete;

 private:
  void waitForInfo();
  void waitForImage(const DescribedCamera& camera);
  void beginWaiting(const std::string& problem);
  void onInfo(const sensor_msgs::CameraInfo& info);
  void onImageTimer();
  /// To be called with the mutex locked.
  void start(const DescribedCamera& camera);
  void onTimer();
  bool isWaiting();
  void report(diagnostic_updater::DiagnosticStatusWrapper& report);
  void complain(const std::string& problem);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  std::string name_;
  LocalizerParameters parameters_;
  /// The topic of camera_info, or of the images.
  std::string topic_;
  /// How the camera became known, in words.
  std::string described_;

  /// Whether it waits for a camera_info that describes a camera, or for an image.
  bool is_waiting_ = true;
  /// Why there is no localizer yet; empty once there is.
  std::string problem_;
  ros::WallTime last_line_;
  std::mutex mutex_;
  /// The camera to scale, and the images that determine its size.
  std::optional<DescribedCamera> camera_;
  std::unique_ptr<ImageInput> images_;
  std::unique_ptr<LocalizerServer> server_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Subscriber info_subscriber_;
  ros::WallTimer timer_;
  ros::WallTimer image_timer_;
};

}  // namespace omnitag
