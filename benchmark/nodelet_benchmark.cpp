// What the nodelet takes beside the core that it wraps: images and odometry come to it at 30 frames
// a second inside one process, as from a camera's driver in the same nodelet manager, and the core
// alone gets the same images, the same odometry and the same pauses. The robot stands for a second
// where each image was taken, and is then told by odometry how it went on to the next. What ROS
// itself takes is seen from a node that only receives the same and publishes as many messages. They
// take turns, since a processor's speed changes from minute to minute; the means over the turns are
// printed for all frames and for their middle half, which leaves out what else the machine did.
// Times are processor time: the nodelet's are of all threads but those that send and listen to it,
// less what they take while no nodelet is loaded. The core's time within the nodelet, where its
// caches are cold, is wall time, and so is the latency, from an image's stamp to its pose. Needs a
// ROS master.
//
//   nodelet_benchmark [--two] [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by
//                                                  default; --two: two cameras, each with all
//                                                  images
//   taskset -c 0 rosrun omnitag nodelet_benchmark ...     on one core

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <deque>
#include <future>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <vector>

#include "omnitag/LocalizationStatus.h"
#include "omnitag/MarkerDetectionArray.h"
#include "omnitag/localization/localizer.h"
#include "processor_time.h"
#include "program.h"
#include "recorded_sequence.h"
#include "ros/conversions.h"
#include "ros/transform_input.h"
#include "statistics.h"

namespace omnitag {
namespace {

constexpr double kFrameInterval = 1.0 / 30.0;  // s
constexpr int kTurns = 21;
/// Of each turn, and how many of them are not measured.
constexpr int kFrames = 60;
constexpr int kWarmUp = 15;
constexpr int kFramesPerPlace = 30;
const std::string kNodelet = "/localizer";

/// The topics of that many cameras.
std::vector<std::string> topicsOf(int cameras) {
  if (cameras == 1) return {"/image"};
  return {"/front/image", "/back/image"};
}

double threadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Calls back with the numbers 0 to kFrames - 1 at the frames' pace.
template <typename Callback>
void atPace(const Callback& callback) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (int i = 0; i < kFrames; ++i) {
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(i * kFrameInterval)));
    callback(i);
  }
}

/// The frame of the sequence that is sent as the one with this number, with the odometry.
Frame frameOf(const RecordedSequence& sequence, int number) {
  const auto index = static_cast<std::size_t>(number / kFramesPerPlace) % sequence.frames.size();
  Frame frame = sequence.frames[index];
  frame.odom_from_base = sequence.truth[index];
  return frame;
}

/// What came back.
struct Answers {
  int all = 0;
  int poses = 0;
  unsigned long long dropped = 0;
  /// ms of wall time that the core took within the nodelet, of each frame that sendAll() measures.
  std::vector<double> within;
  /// ms of wall time from the stamps of these frames to their answers.
  std::vector<double> latencies;

  void add(const Answers& more) {
    all += more.all;
    poses += more.poses;
    dropped += more.dropped;
    within.insert(within.end(), more.within.begin(), more.within.end());
    latencies.insert(latencies.end(), more.latencies.begin(), more.latencies.end());
  }
};

/// Listens to the nodelet in a thread of its own, whose time is not the nodelet's.
class Listener {
 public:
  explicit Listener(int cameras) : cameras_(cameras) {
    node_.setCallbackQueue(&queue_);
    statuses_ = node_.subscribe("/status", 2 * kFrames, &Listener::onStatus, this);
    thread_ = std::thread([this] {
      while (!is_done_) {
        queue_.callAvailable(ros::WallDuration(0.1));
        spent_ = threadTime();
      }
    });
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { stop(); }

  /// What came until then.
  Answers stop() {
    is_done_ = true;
    if (thread_.joinable()) thread_.join();
    return answers_;
  }

  /// s of processor time.
  double spent() const { return spent_; }

 private:
  void onStatus(const LocalizationStatus::ConstPtr& status) {
    ++answers_.all;
    if (status->has_pose != 0) ++answers_.poses;
    answers_.dropped = status->images_dropped;
    if (answers_.all > cameras_ * kWarmUp && answers_.all < cameras_ * kFrames) {
      answers_.within.push_back(1e3 * status->total_time);
      answers_.latencies.push_back(1e3 * status->image_age);
    }
  }

  const int cameras_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::Subscriber statuses_;
  Answers answers_;
  std::atomic<bool> is_done_ = false;
  std::atomic<double> spent_ = 0.0;
  std::thread thread_;
};

class Sender {
 public:
  Sender(const RecordedSequence& sequence, const std::vector<std::string>& topics)
      : sequence_(sequence) {
    for (const std::string& topic : topics) {
      images_.push_back(node_.advertise<sensor_msgs::Image>(topic, 1));
    }
    mounting_.sendTransform(transform("base_link", "camera",
                                      sequence.frames.front().base_from_camera, ros::Time::now()));
  }

  void send(int number) {
    const ros::Time stamp = ros::Time::now();
    const Frame frame = frameOf(sequence_, number);
    odometry_.sendTransform(
        transform("odom", "base_link", frame.odom_from_base->toIsometry(), stamp));
    for (const ros::Publisher& publisher : images_) send(frame.image, stamp, publisher);
  }

  bool isHeard() const { return images_.back().getNumSubscribers() > 0; }

 private:
  void send(const cv::Mat& pixels, const ros::Time& stamp, const ros::Publisher& publisher) {
    const auto image = boost::make_shared<sensor_msgs::Image>();
    image->header.stamp = stamp;
    image->header.frame_id = "camera";
    image->encoding = sensor_msgs::image_encodings::MONO8;
    image->width = static_cast<std::uint32_t>(pixels.cols);
    image->height = static_cast<std::uint32_t>(pixels.rows);
    image->step = image->width;
    image->data.assign(pixels.datastart, pixels.dataend);
    publisher.publish(image);
    // As a driver's buffer, it goes when the nodelet is long done with it.
    sent_.emplace_back(image);
    constexpr std::size_t kKept = 8;
    if (sent_.size() > kKept) sent_.pop_front();
  }

  static geometry_msgs::TransformStamped transform(const std::string& target,
                                                   const std::string& source,
                                                   const Eigen::Isometry3d& target_from_source,
                                                   const ros::Time& stamp) {
    geometry_msgs::TransformStamped message;
    message.header.frame_id = target;
    message.header.stamp = stamp;
    message.child_frame_id = source;
    message.transform = toMessage(target_from_source);
    return message;
  }

  const RecordedSequence& sequence_;
  ros::NodeHandle node_;
  std::vector<ros::Publisher> images_;
  std::deque<sensor_msgs::ImageConstPtr> sent_;
  tf2_ros::StaticTransformBroadcaster mounting_;
  tf2_ros::TransformBroadcaster odometry_;
};

/// A node that localizes nothing: it receives images and transforms, looks these up and publishes
/// as many messages as the nodelet does, without content, all in a thread of its own.
class IdleNode {
 public:
  explicit IdleNode(const std::vector<std::string>& topics)
      : transforms_(node_, {"map", "odom", "base_link"}) {
    node_.setCallbackQueue(&queue_);
    for (const std::string& topic : topics) {
      images_.push_back(node_.subscribe(topic, 1, &IdleNode::onImage, this));
    }
    transform_ = node_.advertise<tf2_msgs::TFMessage>("/tf", 10);
    pose_ = node_.advertise<geometry_msgs::PoseStamped>("/pose", 10);
    pose_with_covariance_ =
        node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("/pose_with_covariance", 10);
    detections_ = node_.advertise<MarkerDetectionArray>("/detections", 10);
    status_ = node_.advertise<LocalizationStatus>("/status", 10);
    thread_ = std::thread([this] {
      while (!is_done_) queue_.callAvailable(ros::WallDuration(0.1));
    });
  }
  IdleNode(const IdleNode&) = delete;
  IdleNode& operator=(const IdleNode&) = delete;
  ~IdleNode() {
    is_done_ = true;
    thread_.join();
  }

 private:
  void onImage(const sensor_msgs::ImageConstPtr& image) {
    const ros::Time& stamp = image->header.stamp;
    transforms_.serve(0.0);
    try {
      transforms_.buffer().lookupTransform("base_link", image->header.frame_id, stamp);
      transforms_.buffer().lookupTransform("odom", "base_link", stamp);
    } catch (const tf2::TransformException&) {
      return;
    }
    transform_.publish(boost::make_shared<tf2_msgs::TFMessage>());
    pose_.publish(boost::make_shared<geometry_msgs::PoseStamped>());
    pose_with_covariance_.publish(boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>());
    detections_.publish(boost::make_shared<MarkerDetectionArray>());
    status_.publish(boost::make_shared<LocalizationStatus>());
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  TransformInput transforms_;
  std::vector<ros::Subscriber> images_;
  ros::Publisher transform_;
  ros::Publisher pose_;
  ros::Publisher pose_with_covariance_;
  ros::Publisher detections_;
  ros::Publisher status_;
  std::atomic<bool> is_done_ = false;
  std::thread thread_;
};

void setParameters(const std::string& camera_file, const std::string& map_file,
                   const std::vector<std::string>& topics) {
  ros::param::del(kNodelet);
  if (topics.size() == 1) {
    ros::param::set(kNodelet + "/camera_file", camera_file);
  } else {
    XmlRpc::XmlRpcValue cameras;
    for (int i = 0; i < static_cast<int>(topics.size()); ++i) {
      cameras[i]["name"] = "camera" + std::to_string(i);
      cameras[i]["camera_file"] = camera_file;
      cameras[i]["image"] = topics[static_cast<std::size_t>(i)];
    }
    ros::param::set(kNodelet + "/cameras", cameras);
  }
  ros::param::set(kNodelet + "/map_file", map_file);
  ros::param::set(kNodelet + "/odom_frame", "odom");
}

/// The processor time (s) of each frame that is measured, until the next is sent, of all threads
/// but this one, which sends, and the listener's.
std::vector<double> sendAll(int turn, Sender* sender, const Listener& listener) {
  std::vector<double> times;
  double before = 0.0;
  atPace([&](int number) {
    const double now = processorTime() - threadTime() - listener.spent();
    if (number > kWarmUp) times.push_back(now - before);
    before = now;
    sender->send(turn * kFrames + number);
  });
  return times;
}

/// Sends one turn to whatever listens to the images.
std::vector<double> measureListening(int turn, int cameras, Sender* sender, Answers* answers) {
  while (!sender->isHeard() && ros::ok()) ros::WallDuration(0.01).sleep();
  Listener listener(cameras);
  std::vector<double> times = sendAll(turn, sender, listener);
  ros::WallDuration(0.5).sleep();
  answers->add(listener.stop());
  return times;
}

std::vector<double> measureNodelet(int turn, int cameras, Sender* sender, Answers* answers) {
  nodelet::Loader loader(false);
  if (!loader.load(kNodelet, "omnitag/LocalizerNodelet", {}, {})) {
    throw InputError("the nodelet could not be loaded");
  }
  return measureListening(turn, cameras, sender, answers);
}

std::vector<double> measureIdleNode(int turn, const std::vector<std::string>& topics,
                                    Sender* sender) {
  const IdleNode node(topics);
  Answers answers;
  std::vector<double> times =
      measureListening(turn, static_cast<int>(topics.size()), sender, &answers);
  // Transforms may be missing for the first ones, or come after their images.
  if (answers.all < kFrames / 3) throw InputError("the idle node hears no transforms");
  return times;
}

/// The core alone, as the nodelet uses it and as newly made as it.
std::vector<double> measureCore(int turn, int cameras, const RecordedSequence& sequence) {
  Localizer localizer(
      std::vector<LocalizerCamera>(static_cast<std::size_t>(cameras), {sequence.camera}),
      sequence.map, {});
  std::vector<double> times;
  atPace([&](int number) {
    Frame frame = frameOf(sequence, turn * kFrames + number);
    // In another thread, as from a driver.
    frame.image = std::async(std::launch::async, [&frame] { return frame.image.clone(); }).get();
    frame.stamp = kFrameInterval * number;
    const double start = processorTime();
    for (int camera = 0; camera < cameras; ++camera) {
      frame.camera = static_cast<std::size_t>(camera);
      localizer.process(frame);
    }
    const double end = processorTime();
    if (number >= kWarmUp && number + 1 < kFrames) times.push_back(end - start);
  });
  return times;
}

/// s of processor time for each frame of one turn.
struct Turn {
  std::vector<double> core;
  std::vector<double> nodelet;
  /// A node that only receives and publishes.
  std::vector<double> idle_node;
  /// What the process itself takes, without any.
  std::vector<double> process;
};

std::vector<Turn> measure(const RecordedSequence& sequence, const std::vector<std::string>& topics,
                          Answers* answers) {
  const auto cameras = static_cast<int>(topics.size());
  Sender sender(sequence, topics);
  std::vector<Turn> turns;
  for (int turn = 0; turn < kTurns; ++turn) {
    Turn& times = turns.emplace_back();
    times.process = sendAll(turn, &sender, Listener(cameras));
    times.nodelet = measureNodelet(turn, cameras, &sender, answers);
    times.idle_node = measureIdleNode(turn, topics, &sender);
    times.core = measureCore(turn, cameras, sequence);
  }
  return turns;
}

/// Of the sample without its least and greatest parts, of this share each.
double trimmedMean(std::vector<double> sample, double share) {
  if (sample.empty()) return 0.0;
  std::sort(sample.begin(), sample.end());
  const auto cut = static_cast<std::ptrdiff_t>(share * static_cast<double>(sample.size()));
  const double sum = std::accumulate(sample.begin() + cut, sample.end() - cut, 0.0);
  return sum / static_cast<double>(sample.end() - sample.begin() - 2 * cut);
}

/// The mean of the turns, each of which took place in its own minute, and its standard error.
struct Mean {
  double value = 0.0;
  double error = 0.0;
};

Mean meanOf(const std::vector<double>& turns) {
  const auto count = static_cast<double>(turns.size());
  const double value = std::accumulate(turns.begin(), turns.end(), 0.0) / count;
  double squares = 0.0;
  for (const double turn : turns) squares += (turn - value) * (turn - value);
  return {value, std::sqrt(squares / (count * (count - 1.0)))};
}

void print(const std::vector<Turn>& turns, const Answers& answers, double trimmed,
           const char* frames) {
  std::vector<double> core;
  std::vector<double> nodelet;
  std::vector<double> nodelet_over_core;
  std::vector<double> idle_over_core;
  for (const Turn& turn : turns) {
    const double process = trimmedMean(turn.process, trimmed);
    core.push_back(trimmedMean(turn.core, trimmed));
    nodelet.push_back(trimmedMean(turn.nodelet, trimmed) - process);
    nodelet_over_core.push_back(100.0 * (nodelet.back() / core.back() - 1.0));
    idle_over_core.push_back(100.0 * (trimmedMean(turn.idle_node, trimmed) - process) /
                             core.back());
  }
  const Mean added = meanOf(nodelet_over_core);
  const Mean idle = meanOf(idle_over_core);
  std::printf(
      "%s: ms core alone %.2f, core within the nodelet %.2f, nodelet %.2f, which is %.0f %% of a "
      "core; nodelet over core %+.1f %% (standard error %.1f), of which a node that only receives "
      "and publishes takes %.1f %% (%.1f)\n",
      frames, 1e3 * meanOf(core).value, trimmedMean(answers.within, trimmed),
      1e3 * meanOf(nodelet).value, 100.0 * meanOf(nodelet).value / kFrameInterval, added.value,
      added.error, idle.value, idle.error);
}

int run(int argc, char** argv) {
  const bool are_two = argc > 1 && std::string(argv[1]) == "--two";
  if (are_two) {
    --argc;
    ++argv;
  }
  ros::init(argc, argv, "nodelet_benchmark", ros::init_options::NoSigintHandler);
  if (!ros::master::check()) throw InputError("expected a ROS master: start roscore");
  const std::string package = PACKAGE_DIR;
  const RecordedSequence sequence = sequenceFrom(argc, argv);
  const std::vector<std::string> topics = topicsOf(are_two ? 2 : 1);
  cv::setNumThreads(1);
  setParameters(argc > 1 ? argv[2] : package + "/config/cameras/paper.yaml",
                argc > 1 ? argv[3] : package + "/maps/paper.yaml", topics);
  Answers answers;
  const std::vector<Turn> turns = measure(sequence, topics, &answers);
  std::printf(
      "%d images of %d x %d pixels, of %zu cameras at %.0f a second: %d answered, %d with a pose, "
      "%llu dropped\n",
      static_cast<int>(topics.size()) * kTurns * kFrames, sequence.frames.front().image.cols,
      sequence.frames.front().image.rows, topics.size(), 1.0 / kFrameInterval, answers.all,
      answers.poses, answers.dropped);
  std::printf("ms from stamp to pose: median %.2f, 99th percentile %.2f\n",
              quantile(answers.latencies, 0.5), quantile(answers.latencies, 0.99));
  print(turns, answers, 0.25, "middle half of the frames");
  print(turns, answers, 0.0, "all frames");
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("nodelet_benchmark", [&] { return omnitag::run(argc, argv); });
}
