#include "ros/pose_keeper.h"

#include <filesystem>
#include <utility>

#include "common/file_replacement.h"
#include "common/format.h"
#include "omnitag/common/error.h"
#include "ros/log_line.h"

namespace omnitag {
namespace {

std::string describe(const Pose& pose) {
  return format("x %.3f m, y %.3f m, yaw %.3f rad", pose.x, pose.y, pose.yaw);
}

}  // namespace

PoseKeeper::PoseKeeper(const ros::NodeHandle& node, std::string name, std::string path,
                       double period)
    : node_(node), name_(std::move(name)), path_(std::move(path)), period_(period) {
  if (period_ <= 0.0) return;
  timer_ = node_.createWallTimer(ros::WallDuration(period_),
                                 [this](const ros::WallTimerEvent& /*event*/) { save(); });
}

PoseKeeper::~PoseKeeper() {
  timer_.stop();
  save();
}

std::optional<SavedPose> PoseKeeper::lastPose(const std::string& map_frame) const {
  if (period_ <= 0.0) return std::nullopt;
  std::error_code error;
  if (!std::filesystem::exists(path_, error)) {
    inform(name_ + ": pose_file: " + path_ + " is not there yet: searching");
    return std::nullopt;
  }
  try {
    SavedPose saved = loadSavedPose(path_);
    if (saved.map_frame != map_frame) {
      throw InputError(path_ + ": frame_id: expected " + map_frame + ", found " + saved.map_frame);
    }
    inform(name_ + ": pose_file: the robot was last at " + describe(saved.map_from_base.pose) +
           ", and may be there still");
    return saved;
  } catch (const std::exception& problem) {
    complain(name_ + ": pose_file: " + problem.what() + ": searching");
  }
  return std::nullopt;
}

void PoseKeeper::keep(const SavedPose& pose) {
  if (period_ <= 0.0) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  unsaved_ = pose;
}

void PoseKeeper::save() {
  std::optional<SavedPose> pose;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    pose = std::exchange(unsaved_, std::nullopt);
  }
  if (!pose) return;
  try {
    replaceFile(path_, textOf(*pose), Backup::kNone);
  } catch (const std::exception& problem) {
    constexpr double kLinePeriod = 60.0;  // s
    ROS_ERROR_STREAM_THROTTLE(kLinePeriod, name_ << ": pose_file: " << problem.what());
  }
}

}  // namespace omnitag
