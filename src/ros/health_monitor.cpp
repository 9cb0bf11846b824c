#include "ros/health_monitor.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>
#include <utility>

#include "marker/marker_selection.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

constexpr double kReportPeriod = 1.0;
/// s: a camera without an image for this long counts as gone.
constexpr double kImageTimeout = 3.0;
/// s after the start during which images need not have come.
constexpr double kStart = 0.9 * kReportPeriod;
/// s: for this long after markers gave a pose, whichever camera showed them, it counts as tracked.
constexpr double kTracked = 1.0;
/// s between two log lines about the same lasting problem.
constexpr double kLinePeriod = 10.0;

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// The texts of all cameras that have one, joined.
std::string joined(const std::map<std::string, std::string>& by_camera) {
  std::vector<std::string> parts;
  for (const auto& [camera, text] : by_camera) {
    if (text.empty()) continue;
    std::string& part = parts.emplace_back(camera);
    if (!camera.empty()) part += ": ";
    part += text;
  }
  return boost::algorithm::join(parts, "; ");
}

const char* modeName(const LocalizationStatus& status) {
  switch (status.mode) {
    case LocalizationStatus::TRACKING:
      return toString(Mode::kTracking);
    case LocalizationStatus::DEAD_RECKONING:
      return toString(Mode::kDeadReckoning);
    case LocalizationStatus::FOUND:
      return toString(Mode::kFound);
    default:
      return toString(Mode::kSearching);
  }
}

}  // namespace

HealthMonitor::HealthMonitor(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                             const ImageInput& input, MarkerMap map)
    : input_(input),
      name_(private_node.getNamespace()),
      map_(std::move(map)),
      last_report_(Clock::now()),
      arrivals_(input.sources()),
      updater_(node, private_node, name_) {
  updater_.setHardwareID("none");
  updater_.add("images", this, &HealthMonitor::reportImages);
  updater_.add("transforms", this, &HealthMonitor::reportTransforms);
  updater_.add("localization", this, &HealthMonitor::reportLocalization);
  updater_.add("marker map", this, &HealthMonitor::reportMap);
  timer_ = node.createWallTimer(ros::WallDuration(kReportPeriod),
                                [this](const ros::WallTimerEvent&) { updater_.force_update(); });
}

void HealthMonitor::mapChanged(const MarkerMap& map,
                               const std::vector<ProvisionalMarker>& provisional) {
  const std::lock_guard<std::mutex> lock(mutex_);
  map_ = map;
  mapped_ = static_cast<std::size_t>(
      std::count_if(provisional.begin(), provisional.end(),
                    [](const ProvisionalMarker& marker) { return marker.is_used; }));
  waiting_ = provisional.size() - mapped_;
}

void HealthMonitor::startedAnew() {
  const std::lock_guard<std::mutex> lock(mutex_);
  displacements_.clear();
}

void HealthMonitor::imageCame(std::size_t source) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_source_ = source;
  imageIsHere(arrivals_[source].refusal);
}

void HealthMonitor::imageIsHere(const std::string& refusal) {
  Arrival& arrival = arrivals_[last_source_];
  arrival.last = Clock::now();
  arrival.last_time = ros::Time::now();
  arrival.refusal = refusal;
}

void HealthMonitor::noteArrivals() {
  for (std::size_t source = 0; source < arrivals_.size(); ++source) {
    const std::uint64_t received = input_.received(source);
    if (std::exchange(arrivals_[source].received, received) == received) continue;
    arrivals_[source].last = Clock::now();
    arrivals_[source].last_time = ros::Time::now();
  }
}

// Also true for a bag that plays so slowly that no image is due.
bool HealthMonitor::isPaused(const Arrival& arrival) {
  return ros::Time::isSimTime() &&
         std::abs((ros::Time::now() - arrival.last_time).toSec()) < kImageTimeout;
}

bool HealthMonitor::areAllSilent() const {
  return std::all_of(arrivals_.begin(), arrivals_.end(), [](const Arrival& arrival) {
    return arrival.last && seconds(Clock::now() - *arrival.last) > kImageTimeout;
  });
}

void HealthMonitor::imageRefused(const std::string& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  imageIsHere("image on " + input_.topic(last_source_) + " refused: " + why);
  ++refused_images_;
  complain(&images_, problemOfImages());
}

void HealthMonitor::imageLate() {
  const std::lock_guard<std::mutex> lock(mutex_);
  imageIsHere();
  ++late_images_;
  complain(&late_, "images on " + input_.topic(last_source_) +
                       " left out: their stamps are not after those of the images before");
}

void HealthMonitor::transformMissing(const std::string& why, const std::string& camera) {
  const std::lock_guard<std::mutex> lock(mutex_);
  imageIsHere();
  ++images_without_transform_;
  update(&images_, problemOfImages(), "images are coming");
  missing_transforms_[camera] = "waiting for tf: " + why;
  complain(&transforms_, joined(missing_transforms_));
}

void HealthMonitor::transformsServed(const std::string& failure) {
  const std::lock_guard<std::mutex> lock(mutex_);
  update(&serving_, failure.empty() ? "" : "tf cannot be read or sent: " + failure,
         "tf can be read and sent");
}

void HealthMonitor::parentChecked(const std::string& conflict) {
  const std::lock_guard<std::mutex> lock(mutex_);
  update(&parent_, conflict, "tf has no other parent of what is sent", ros::console::levels::Error);
}

void HealthMonitor::noteStatus(const LocalizationStatus& status) {
  const bool has_pose = status.has_pose != 0;
  const bool is_tracked = has_pose && status.markers_used > 0;
  const bool is_recent = last_tracked_ && seconds(Clock::now() - *last_tracked_) < kTracked;
  if (is_tracked) last_tracked_ = Clock::now();
  // A camera that sees no marker is no problem while another does.
  const bool is_left_to_another = has_pose && !is_tracked && !status.camera.empty() && is_recent;
  if (!is_left_to_another) last_status_ = status;
}

void HealthMonitor::localized(const LocalizationStatus& status, const FrameResult& result,
                              const std::string& odometry_problem) {
  const std::lock_guard<std::mutex> lock(mutex_);
  imageIsHere();
  noteStatus(status);
  last_pose_ = result.map_from_base;
  update(&images_, problemOfImages(), "images are coming");
  missing_transforms_[status.camera] =
      odometry_problem.empty() ? "" : "no odometry, hence no map -> odom: " + odometry_problem;
  update(&transforms_, joined(missing_transforms_), "tf has all transforms");
  update(&localization_, result.map_from_base ? "" : "searching: " + result.remark,
         std::string("localized, ") + modeName(status));
  if (result.map_from_base && !result.remark.empty()) {
    ROS_WARN_STREAM(name_ << ": " << result.remark);
  }
  advice_of_[status.camera] = boost::algorithm::join(status.advice, "; ");
  update(&advice_, joined(advice_of_), "images, map and camera agree again");
  displacements_.add(result);
  update(&marker_map_, describe(result.displaced_groups, displacements_.persistent()),
         "all markers that are read hang where the map has them");
}

std::string HealthMonitor::describe(const std::vector<GroupDisplacement>& groups,
                                    const std::vector<DisplacedMarker>& displaced) const {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  std::set<std::size_t> told;
  for (const GroupDisplacement& group : groups) {
    text << (text.tellp() > 0 ? "; " : "") << "markers ";
    for (const std::size_t entry : group.entries) {
      text << (entry == group.entries.front() ? "" : ", ") << displayName(map_.markers[entry]);
    }
    text << " were moved as one, by (" << group.shift.x() << ", " << group.shift.y() << ", "
         << group.shift.z() << ") m and " << degrees(group.turn) << " deg";
    told.insert(group.entries.begin(), group.entries.end());
  }
  for (const DisplacedMarker& each : displaced) {
    if (told.count(each.map_entry) > 0) continue;
    text << (text.tellp() > 0 ? "; " : "") << "marker " << displayName(map_.markers[each.map_entry])
         << " is " << each.distance << " m from where the map has it";
  }
  return text.str();
}

std::string HealthMonitor::problemOfImages() const {
  const Clock::time_point now = Clock::now();
  std::vector<std::string> problems;
  for (std::size_t source = 0; source < arrivals_.size(); ++source) {
    const Arrival& arrival = arrivals_[source];
    const std::string topic =
        input_.topic(source) + " (" + std::to_string(input_.publishers(source)) + " publishers)";
    if (!arrival.last) {
      // Of several sources, one is always the first.
      if (seconds(now - start_) < kStart) continue;
      problems.push_back("waiting for the first image on " + topic);
    } else if (seconds(now - *arrival.last) > kImageTimeout && !isPaused(arrival)) {
      problems.push_back("waiting for images on " + topic + ", none for " +
                         std::to_string(std::lround(seconds(now - *arrival.last))) + " s");
    } else if (!arrival.refusal.empty()) {
      problems.push_back(arrival.refusal);
    }
  }
  return boost::algorithm::join(problems, "; ");
}

void HealthMonitor::reportImages(Report& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Clock::time_point now = Clock::now();
  const std::uint64_t received = input_.received();
  const double rate = static_cast<double>(received - received_at_last_report_) /
                      std::max(seconds(now - last_report_), 1e-3);
  last_report_ = now;
  received_at_last_report_ = received;

  noteArrivals();
  if (const std::string problem = problemOfImages(); !problem.empty()) complain(&images_, problem);
  const std::uint64_t late = late_images_ - std::exchange(late_at_last_report_, late_images_);
  if (images_.problem.empty() && areAllSilent()) {
    report.summary(Report::WARN,
                   "no images, but simulated time has hardly moved since the last one, as while a "
                   "bag is paused");
  } else if (images_.problem.empty() && late > 0) {
    report.summary(Report::WARN, late_.problem);
  } else if (images_.problem.empty()) {
    report.summary(Report::OK, "images are coming");
  } else {
    report.summary(Report::ERROR, images_.problem);
  }
  for (std::size_t source = 0; source < input_.sources(); ++source) {
    report.add("topic", input_.topic(source));
    report.add("publishers", input_.publishers(source));
  }
  report.add("images per second", rate);
  report.add("received", received);
  report.add("dropped, since newer ones came", input_.dropped());
  report.add("dropped, older than the one before", late_images_);
  report.add("dropped, without transform", images_without_transform_);
  report.add("refused", refused_images_);
}

void HealthMonitor::reportTransforms(Report& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!parent_.problem.empty()) {
    report.summary(Report::ERROR, parent_.problem);
  } else if (!serving_.problem.empty()) {
    report.summary(Report::ERROR, serving_.problem);
  } else if (!transforms_.problem.empty()) {
    report.summary(Report::ERROR, transforms_.problem);
  } else if (!last_status_) {
    report.summary(Report::OK, "looked up when an image comes");
  } else {
    report.summary(Report::OK, "tf has all transforms");
  }
}

void HealthMonitor::reportLocalization(Report& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!last_status_) {
    report.summary(Report::WARN, "waiting for the first image");
    return;
  }
  if (!localization_.problem.empty()) {
    report.summary(Report::WARN, localization_.problem);
  } else if (last_status_->mode == LocalizationStatus::DEAD_RECKONING) {
    report.summary(Report::WARN, modeName(*last_status_));
  } else if (!advice_.problem.empty()) {
    report.summary(Report::WARN, advice_.problem);
  } else {
    report.summary(Report::OK, modeName(*last_status_));
  }
  report.add("mode", modeName(*last_status_));
  report.add("markers predicted", last_status_->markers_predicted);
  report.add("markers detected", last_status_->markers_detected);
  report.add("markers used", last_status_->markers_used);
  report.addf("milliseconds per image", "%.1f", 1e3 * last_status_->total_time);
  report.addf("age of the image", "%.3f s", last_status_->image_age);
  report.addf("residuals, compared with what is expected", "%.2f", last_status_->residual_ratio);
  report.addf("blur", "%.2f pixels", last_status_->blur);
  report.addf("turn during the exposure", "%.2f deg", degrees(last_status_->blur_turn));
  report.add("exposure", last_status_->exposure.empty() ? "good" : last_status_->exposure);
  if (last_pose_) {
    report.addf("position", "%.3f m, %.3f m", last_pose_->pose.x, last_pose_->pose.y);
    report.addf("lean (roll, pitch)", "%.2f deg, %.2f deg", degrees(last_pose_->pose.roll),
                degrees(last_pose_->pose.pitch));
    report.addf("height", "%.3f m", last_pose_->pose.z);
    report.addf("yaw", "%.2f deg", degrees(last_pose_->pose.yaw));
    report.addf("standard deviation of the position", "%.2g m", positionDeviation(*last_pose_));
    report.addf("standard deviation of the yaw", "%.2g deg",
                degrees(std::sqrt(last_pose_->covariance(2, 2))));
  }
}

void HealthMonitor::reportMap(Report& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (marker_map_.problem.empty()) {
    report.summary(Report::OK, "no marker is known to hang elsewhere");
  } else {
    report.summary(Report::WARN, marker_map_.problem);
  }
  report.add("markers", map_.markers.size());
  report.add("of these mapped and not saved", mapped_);
  report.add("provisional, not known well enough", waiting_);
}

void HealthMonitor::update(Subject* subject, const std::string& problem,
                           const std::string& all_is_well, ros::console::Level level) {
  if (problem.empty()) {
    settle(subject, all_is_well);
  } else {
    complain(subject, problem, level);
  }
}

void HealthMonitor::complain(Subject* subject, const std::string& problem,
                             ros::console::Level level) {
  const Clock::time_point now = Clock::now();
  subject->problem = problem;
  if (subject->last_line && seconds(now - *subject->last_line) < kLinePeriod) return;
  subject->last_line = now;
  ROS_LOG_STREAM(level, ROSCONSOLE_DEFAULT_NAME, name_ << ": " << problem);
}

void HealthMonitor::settle(Subject* subject, const std::string& all_is_well) {
  if (subject->problem.empty()) return;
  subject->problem.clear();
  // A problem that comes and goes with every image would fill the log.
  if (seconds(Clock::now() - *subject->last_line) < kReportPeriod) return;
  subject->last_line.reset();
  ROS_INFO_STREAM(name_ << ": " << all_is_well);
}

}  // namespace omnitag
