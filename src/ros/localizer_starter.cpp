#include "ros/localizer_starter.h"

#include <image_transport/camera_common.h>

#include <optional>

#include "ros/image_localizer.h"

namespace omnitag {

namespace {

/// The source of the only camera.
std::vector<ImageSource> sourceOf(const LocalizerParameters& parameters) {
  const CameraParameters& camera = parameters.cameras.front();
  return {{camera.image, camera.image_transport}};
}

/// `camera_info` if it is remapped, else the one beside the images.
std::string infoTopic(const ros::NodeHandle& node) {
  constexpr bool kWithRemapping = false;
  const std::string info = node.resolveName("camera_info");
  const bool is_remapped = info != node.resolveName("camera_info", kWithRemapping);
  return is_remapped ? info : image_transport::getCameraInfoTopic(node.resolveName("image"));
}

}  // namespace

LocalizerStarter::LocalizerStarter(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : node_(node),
      private_node_(private_node),
      name_(private_node.getNamespace()),
      parameters_(readParameters(name_)) {
  if (parameters_.hasCameraList()) {
    std::vector<DescribedCamera> cameras;
    for (const CameraParameters& camera : parameters_.cameras) {
      cameras.push_back(cameraFromFile(camera.camera_file));
      if (cameras.back().model->scalesToImage()) {
        throw InputError(camera.camera_file +
                         ": scale_to_image: expected no such key where there are several cameras");
      }
    }
    server_ = std::make_unique<LocalizerServer>(node_, private_node_, parameters_, cameras);
    return;
  }
  const std::string& camera_file = parameters_.cameras.front().camera_file;
  if (camera_file.empty()) {
    // Errors in these should be reported now, not when the camera_info comes. Whether a transport
    // can be loaded only shows when it is.
    ImageLocalizer::checkMap(parameters_);
    ImageInput(node_, private_node_, sourceOf(parameters_), parameters_.queue_size).close();
    waitForInfo();
    return;
  }
  const DescribedCamera camera = cameraFromFile(camera_file);
  if (camera.model->scalesToImage()) {
    ImageLocalizer::checkMap(parameters_);
    waitForImage(camera);
  } else {
    server_ = std::make_unique<LocalizerServer>(node_, private_node_, parameters_,
                                                std::vector<DescribedCamera>{camera});
  }
}

LocalizerStarter::~LocalizerStarter() {
  // Each waits for a running callback.
  timer_.stop();
  image_timer_.stop();
  info_subscriber_.shutdown();
}

void LocalizerStarter::waitForInfo() {
  topic_ = infoTopic(node_);
  described_ = "described by camera_info";
  beginWaiting("waiting for the first camera_info on " + topic_ + ", as there is no camera_file");
  info_subscriber_ = node_.subscribe(topic_, 1, &LocalizerStarter::onInfo, this);
}

void LocalizerStarter::waitForImage(const DescribedCamera& camera) {
  camera_ = camera;
  images_ = std::make_unique<ImageInput>(node_, private_node_, sourceOf(parameters_),
                                         parameters_.queue_size);
  topic_ = images_->topic(0);
  described_ = "scaled to the images";
  beginWaiting("waiting for the first image on " + topic_ + ", to whose size " + camera.origin +
               " is scaled");
  constexpr double kPeriod = 0.05;
  image_timer_ = node_.createWallTimer(ros::WallDuration(kPeriod),
                                       [this](const ros::WallTimerEvent&) { onImageTimer(); });
}

void LocalizerStarter::beginWaiting(const std::string& problem) {
  problem_ = problem;
  ROS_INFO_STREAM(name_ << ": " << problem_);
  last_line_ = ros::WallTime::now();
  updater_ = std::make_unique<diagnostic_updater::Updater>(node_, private_node_, name_);
  updater_->setHardwareID("none");
  updater_->add("camera", this, &LocalizerStarter::report);
  timer_ = node_.createWallTimer(ros::WallDuration(1.0),
                                 [this](const ros::WallTimerEvent&) { onTimer(); });
}

void LocalizerStarter::onInfo(const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_waiting_) return;
  std::optional<DescribedCamera> camera;
  try {
    camera = cameraFromInfo(info, topic_);
  } catch (const std::exception& error) {
    complain(error.what());
    return;
  }
  start(*camera);
}

void LocalizerStarter::onImageTimer() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_waiting_) return;
  ImageSize size;
  try {
    const std::optional<ReceivedImage> received = images_->next(0.0);
    if (!received) return;
    const cv_bridge::CvImageConstPtr image = received->decode();
    size = {image->image.cols, image->image.rows};
  } catch (const std::exception& error) {
    complain(error.what());
    return;
  }
  images_.reset();
  start(cameraForImages(*camera_, size));
}

void LocalizerStarter::start(const DescribedCamera& camera) {
  // If something else than the camera is wrong, the next message would not mend it.
  is_waiting_ = false;
  try {
    server_ = std::make_unique<LocalizerServer>(node_, private_node_, parameters_,
                                                std::vector<DescribedCamera>{camera});
    problem_.clear();
  } catch (const std::exception& error) {
    problem_ = error.what();
    last_line_ = ros::WallTime::now();
    ROS_FATAL_STREAM(problem_);
  }
}

// Stops the subscriptions, because more messages would only wake a thread: not in their own
// callback, which the destructor could then not wait for, nor with the mutex locked, which a
// callback may be waiting for.
void LocalizerStarter::onTimer() {
  updater_->force_update();
  if (isWaiting()) return;
  info_subscriber_.shutdown();
  image_timer_.stop();
}

bool LocalizerStarter::isWaiting() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_waiting_;
}

void LocalizerStarter::report(diagnostic_updater::DiagnosticStatusWrapper& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report.add("topic", topic_);
  if (server_) {
    report.summary(diagnostic_updater::DiagnosticStatusWrapper::OK, described_);
    return;
  }
  if (is_waiting_) {
    report.add("publishers",
               images_ ? images_->publishers(0) : info_subscriber_.getNumPublishers());
  }
  report.summary(diagnostic_updater::DiagnosticStatusWrapper::ERROR, problem_);
  complain(problem_);
}

void LocalizerStarter::complain(const std::string& problem) {
  // s between two log lines about the same lasting problem.
  constexpr double kLinePeriod = 10.0;
  const ros::WallTime now = ros::WallTime::now();
  const bool is_new = problem != problem_;
  problem_ = problem;
  if (!is_new && (now - last_line_).toSec() < kLinePeriod) return;
  last_line_ = now;
  ROS_WARN_STREAM(name_ << ": " << problem);
}

}  // namespace omnitag
