#include "ros/localizer_server.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <chrono>
#include <optional>
#include <utility>

#include "omnitag/common/error.h"
#include "ros/conversions.h"
#include "ros/image_conversion.h"
#include "ros/result_messages.h"

namespace omnitag {
namespace {

/// s: the longest that transforms wait while no image comes.
constexpr double kTransformsWait = 0.1;

/// Publishes through a pointer: subscribers in the same nodelet manager get the message without a
/// copy, and ROS need not wake a thread to hand it on.
template <typename Message>
void publishShared(const ros::Publisher& publisher, Message message) {
  publisher.publish(boost::make_shared<Message>(std::move(message)));
}

/// The index of a camera's source.
std::size_t sourceOf(const CameraParameters& camera, const std::vector<ImageSource>& sources) {
  const auto found =
      std::find_if(sources.begin(), sources.end(), [&camera](const ImageSource& source) {
        return source.topic == camera.image && source.transport == camera.image_transport;
      });
  return static_cast<std::size_t>(found - sources.begin());
}

std::vector<ImageSource> sourcesOf(const std::vector<CameraParameters>& cameras) {
  std::vector<ImageSource> sources;
  for (const CameraParameters& camera : cameras) {
    if (sourceOf(camera, sources) < sources.size()) continue;
    sources.push_back({camera.image, camera.image_transport});
  }
  return sources;
}

/// Does a step of the thread's work and reports an exception, which would end the process.
template <typename Step, typename Report>
void attempt(const Step& step, const Report& report) {
  try {
    step();
  } catch (const std::exception& error) {
    report(error.what());
  }
}

}  // namespace

LocalizerServer::LocalizerServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                 const LocalizerParameters& parameters,
                                 const std::vector<DescribedCamera>& cameras)
    : node_(node),
      name_(private_node.getNamespace()),
      parameters_(parameters),
      localizer_(parameters_, cameras),
      sources_(sourcesOf(parameters_.cameras)),
      input_(node, private_node, sources_, parameters_.queue_size),
      transforms_(node, localizer_.frames()),
      map_drawing_(localizer_.map(), localizer_.frames().map),
      frame_markers_(localizer_.frames().map, parameters_.robot_radius),
      path_(parameters_.path_min_step, parameters_.path_max_poses),
      image_transport_(node),
      debug_images_(parameters_.cameras, localizer_, &image_transport_),
      settings_(parameters_, localizer_.cameras(),
                [this](std::shared_ptr<Successor> successor) {
                  const std::lock_guard<std::mutex> lock(request_mutex_);
                  // If a successor that has not been used yet changed the map, this one changes it,
                  // too.
                  if (successor_) successor->has_other_map |= successor_->has_other_map;
                  successor_ = std::move(successor);
                }),
      map_publisher_(node, localizer_.frames().map, parameters_.publish_marker_tf),
      pose_keeper_(node, name_, parameters_.pose_file, parameters_.save_pose_period),
      health_(node, private_node, input_, localizer_.map()) {
  advertise();
  map_services_.emplace(node_, name_, !parameters_.frames.map.empty(), &settings_);
  tuning_ = std::make_unique<LiveTuning>(private_node, name_, parameters_.localizer, &settings_,
                                         [this](bool enabled) { is_enabled_ = enabled; });
  if (parameters_.drag_markers) {
    marker_dragging_ = std::make_unique<MarkerDragging>(node_.resolveName("edit_map"), name_,
                                                        localizer_.frames().map, &settings_,
                                                        [this] { return saveMap(); });
  }
  map_publisher_.publish(localizer_.map(), localizer_.ignoredMarkers());
  takeSavedPose();

  announce(cameras);
  thread_ = std::thread(&LocalizerServer::run, this);
}

void LocalizerServer::announce(const std::vector<DescribedCamera>& cameras) const {
  std::string text = name_ + ": ";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    text += "camera " + cameras[i].origin + ", images from " +
            input_.topic(sourceOf(parameters_.cameras[i], sources_)) + "; ";
  }
  text += std::to_string(localizer_.map().markers.size()) + " markers of " + parameters_.map_file;
  ROS_INFO_STREAM(text);
}

void LocalizerServer::advertise() {
  constexpr uint32_t kTransformQueue = 100;
  transform_publisher_ = node_.advertise<tf2_msgs::TFMessage>("/tf", kTransformQueue);
  pose_publisher_ = node_.advertise<geometry_msgs::PoseStamped>("pose", 10);
  pose_with_covariance_publisher_ =
      node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose_with_covariance", 10);
  pose_measured_publisher_ =
      node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose_measured", 10);
  detections_publisher_ = node_.advertise<MarkerDetectionArray>("detections", 10);
  status_publisher_ = node_.advertise<LocalizationStatus>("status", 10);
  constexpr bool kLatched = true;
  path_publisher_ = node_.advertise<nav_msgs::Path>("path", 1, kLatched);
  markers_publisher_ = node_.advertise<visualization_msgs::MarkerArray>(
      "markers", 10, [this](const ros::SingleSubscriberPublisher& subscriber) {
        const std::lock_guard<std::mutex> lock(map_mutex_);
        subscriber.publish(map_drawing_.markers());
      });
  initial_pose_subscriber_ =
      node_.subscribe("initialpose", 1, &LocalizerServer::onInitialPose, this);
  global_localization_server_ =
      node_.advertiseService<std_srvs::Empty::Request, std_srvs::Empty::Response>(
          "global_localization", [this](auto& /*request*/, auto& /*response*/) {
            forgetPose();
            return true;
          });
  save_map_server_ =
      node_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
          "save_map", [this](auto& /*request*/, auto& response) {
            onSaveMap(&response);
            return true;
          });
}

LocalizerServer::~LocalizerServer() {
  // Each waits for a running callback; afterwards, no callback uses what is being destroyed.
  initial_pose_subscriber_.shutdown();
  global_localization_server_.shutdown();
  save_map_server_.shutdown();
  map_services_->shutdown();
  tuning_->shutdown();
  input_.close();
  transforms_.close();
  thread_.join();
  marker_dragging_.reset();
}

void LocalizerServer::run() {
  const auto refuse = [this](const char* why) { health_.imageRefused(why); };
  while (!input_.isClosed()) {
    std::optional<ReceivedImage> received;
    attempt(
        [&] { received = input_.next(std::min(parameters_.transform_period, kTransformsWait)); },
        refuse);
    keepUp();
    attempt([this] { takeSuccessor(); }, refuse);
    if (received && is_enabled_) attempt([&] { onImage(*received); }, refuse);
  }
}

void LocalizerServer::keepUp() {
  std::string failure;
  attempt(
      [this] {
        watchClock();
        transforms_.serve(0.0);
        checkParent();
        repeatTransform();
      },
      [&failure](const char* why) { failure = why; });
  health_.transformsServed(failure);
}

void LocalizerServer::watchClock() {
  const ClockReading reading = readClocks([] { return ros::Time::now().toSec(); });
  const double step = clock_watch_.step(reading.clock, reading.steady);
  // Whatever plays the images sets simulated time, too: when it steps, the images start again.
  if (!ros::Time::isSimTime() && step != 0.0) localizer_.clockStepped(step);
}

bool LocalizerServer::checkParent() {
  if (!parameters_.publish_tf) return false;
  const std::optional<std::string> conflict = transforms_.parentConflict();
  health_.parentChecked(conflict.value_or(""));
  if (conflict) correction_.reset();
  return !conflict;
}

void LocalizerServer::takeSuccessor() {
  std::shared_ptr<Successor> successor;
  {
    const std::lock_guard<std::mutex> lock(request_mutex_);
    successor = std::exchange(successor_, nullptr);
  }
  if (!successor) return;
  const bool has_other_map = successor->has_other_map;
  localizer_.exchange(std::move(*successor));
  if (has_other_map) showMap();
}

void LocalizerServer::onImage(const ReceivedImage& received) {
  {
    const std::lock_guard<std::mutex> lock(request_mutex_);
    for (const Request& request : std::exchange(requests_, {})) request(&localizer_);
  }
  health_.imageCame(received.source);
  const cv_bridge::CvImageConstPtr image = received.decode();
  for (std::size_t i = 0; i < parameters_.cameras.size(); ++i) {
    const CameraParameters& camera = parameters_.cameras[i];
    if (sourceOf(camera, sources_) != received.source) continue;
    attempt([&] { localize(inFrame(image, camera.frame), i); },
            [this](const char* why) { health_.imageRefused(why); });
  }
}

void LocalizerServer::localize(const cv_bridge::CvImageConstPtr& image, std::size_t camera) {
  // An image without a frame or of another size is refused without waiting for tf.
  localizer_.assembler(camera).check(*image);
  waitForTransforms(image->header, camera);
  try {
    const WantedExtras wanted{debug_images_.areWanted(camera),
                              pose_measured_publisher_.getNumSubscribers() > 0};
    const std::optional<LocalizedImage> localized =
        localizer_.localize(image, transforms_.buffer(), wanted, camera);
    if (localized) {
      publish(*localized);
    } else {
      health_.imageLate();
    }
  } catch (const TransformError& error) {
    health_.transformMissing(error.what(), parameters_.cameras[camera].name);
  }
}

// In wall time, because a stopped clock must not stop the localizer.
void LocalizerServer::waitForTransforms(const std_msgs::Header& header, std::size_t camera) {
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  const auto deadline = Clock::now() + Seconds(parameters_.transform_timeout);
  const auto remaining = [&] { return Seconds(deadline - Clock::now()).count(); };
  while (!localizer_.assembler(camera).hasTransforms(header, transforms_.buffer()) &&
         remaining() > 0.0 && !input_.isClosed()) {
    transforms_.serve(std::min(remaining(), parameters_.transform_period));
    // Of the images that come meanwhile, only the newest should wait.
    input_.serve(0.0);
    keepUp();
  }
}

void LocalizerServer::logClockStep(double step) const {
  ROS_WARN_STREAM(name_ << ": the clock was set by " << step
                        << " s, and the images' stamps with it: the pose is kept");
}

void LocalizerServer::startAnew(double went_back) {
  const std::string what = ros::Time::isSimTime()
                               ? "simulated time and the images' stamps went back"
                               : "the images' stamps went back while this robot's clock did not, "
                                 "as when a bag is played "
                                 "again";
  ROS_WARN_STREAM(name_ << ": " << what << ", by " << went_back << " s: started anew");
  path_.clear();
  health_.startedAnew();
  const std::lock_guard<std::mutex> lock(map_mutex_);
  markers_publisher_.publish(map_drawing_.markers());
}

void LocalizerServer::publish(const LocalizedImage& localized) {
  if (localized.clock_step != 0.0) logClockStep(localized.clock_step);
  if (localized.went_back > 0.0) startAnew(localized.went_back);
  if (localizer_.learnsMap()) publishMap(localized.map_changed);
  const std::size_t camera = localized.input.frame.camera;
  ResultMessages messages =
      toMessages(localized, localizer_.map(), localizer_.frames(), parameters_.transform_tolerance);
  messages.status.image_age = ros::Time::now().toSec() - localized.input.header.stamp.toSec();
  messages.status.images_received = input_.received();
  messages.status.images_dropped = input_.dropped() + localizer_.lateImages();

  keepPose(localized);
  sendTransform(messages.transform, localized.result.map_from_base.has_value());
  if (messages.pose) {
    publishShared(pose_publisher_, *messages.pose);
    publishShared(pose_with_covariance_publisher_, std::move(*messages.pose_with_covariance));
    if (path_.add(*messages.pose)) path_publisher_.publish(path_.path());
  }
  if (messages.pose_measured) {
    publishShared(pose_measured_publisher_, std::move(*messages.pose_measured));
  }
  if (detections_publisher_.getNumSubscribers() > 0) {
    addMarkerPoses(localized, localizer_.map(), localizer_.cameras()[camera],
                   parameters_.localizer.estimation, &messages.detections);
  }
  publishShared(detections_publisher_, std::move(messages.detections));
  publishShared(status_publisher_, messages.status);
  if (markers_publisher_.getNumSubscribers() > 0) {
    markers_publisher_.publish(frame_markers_.draw(localized, localizer_.map()));
  }
  debug_images_.publish(localized, camera);
  health_.localized(messages.status, localized.result, localized.input.odometry_problem);
}

// Without odometry, a transform is valid only at the image's stamp. With it, map -> odom is a
// correction that is valid until a better one comes or the pose is lost.
void LocalizerServer::sendTransform(const std::optional<geometry_msgs::TransformStamped>& transform,
                                    bool has_pose) {
  if (!has_pose) correction_.reset();
  // Transforms that came while the frame was processed may show that another parent is still there.
  transforms_.serve(0.0);
  if (!checkParent() || !transform) return;
  broadcast(*transform);
  const ros::Time now = ros::Time::now();
  if (!parameters_.frames.odom.empty()) correction_ = Correction{*transform, now, now};
}

void LocalizerServer::repeatTransform() {
  if (!correction_) return;
  // The images' clock may differ from this machine's, as when a bag is played without /clock: only
  // the time that has passed is taken from this machine's clock. Before the first /clock, it stands
  // at zero.
  const ros::Time now = ros::Time::now();
  if (correction_->made.isZero()) correction_->made = correction_->sent = now;
  const bool is_set_back = now < correction_->sent;
  if (!is_set_back && now - correction_->sent < ros::Duration(parameters_.transform_period)) return;
  correction_->sent = now;
  geometry_msgs::TransformStamped transform = correction_->transform;
  const double stamp = transform.header.stamp.toSec() + (now - correction_->made).toSec();
  // A bag that starts again brings other images, and no stamp may be negative.
  if ((is_set_back && ros::Time::isSimTime()) || stamp < 0.0 || stamp >= kTimesEnd) {
    correction_.reset();
    return;
  }
  transform.header.stamp += now - correction_->made;
  broadcast(transform);
}

void LocalizerServer::broadcast(const geometry_msgs::TransformStamped& transform) {
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  publishShared(transform_publisher_, std::move(message));
}

void LocalizerServer::keepPose(const LocalizedImage& localized) {
  const FrameResult& result = localized.result;
  if (!result.map_from_base || result.acceptedMarkers() == 0) return;
  pose_keeper_.keep(
      {localizer_.frames().map, localized.input.header.stamp.toSec(), result.publishedPose()});
}

void LocalizerServer::showMap() {
  debug_images_.setMap(localizer_.map());
  health_.startedAnew();
  map_publisher_.publish(localizer_.map(), localizer_.ignoredMarkers());
  std::vector<ProvisionalMarker> provisional = localizer_.provisional();
  health_.mapChanged(localizer_.map(), provisional);
  {
    const std::lock_guard<std::mutex> lock(map_mutex_);
    provisional_ = std::move(provisional);
    refined_ = localizer_.refined();
    map_drawing_.replace(localizer_.map(), provisional_);
    markers_publisher_.publish(map_drawing_.markers());
  }
  // Without the lock, because its callbacks save the map.
  if (marker_dragging_) marker_dragging_->show();
}

void LocalizerServer::publishMap(bool is_changed) {
  std::vector<ProvisionalMarker> provisional = localizer_.provisional();
  if (is_changed) {
    debug_images_.setMap(localizer_.map());
    map_publisher_.publish(localizer_.map(), localizer_.ignoredMarkers());
  }
  const std::lock_guard<std::mutex> lock(map_mutex_);
  provisional_ = std::move(provisional);
  if (is_changed) refined_ = localizer_.refined();
  const bool is_refined = is_changed && parameters_.refine_map;
  if (!map_drawing_.update(localizer_.map(), provisional_, is_refined)) return;
  health_.mapChanged(localizer_.map(), provisional_);
  markers_publisher_.publish(map_drawing_.markers());
}

}  // namespace omnitag
