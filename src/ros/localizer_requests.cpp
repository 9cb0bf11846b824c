// What people can request of a running localizer: to take a pose from outside, or to save maps.

#include <tf2/exceptions.h>

#include <optional>
#include <utility>

#include "adjustment/mapped_entries.h"
#include "common/file_replacement.h"
#include "omnitag/common/error.h"
#include "ros/conversions.h"
#include "ros/localizer_server.h"

namespace omnitag {
namespace {

/// A covariance of (x, y, yaw) in the axes of the map.
Eigen::Matrix3d rotated(const Eigen::Matrix3d& covariance,
                        const Eigen::Isometry3d& map_from_frame) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() =
      Eigen::Rotation2Dd(Pose::fromIsometry(map_from_frame).yaw).toRotationMatrix();
  return rotation * covariance * rotation.transpose();
}

}  // namespace

void LocalizerServer::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message) {
  try {
    takePose(message);
  } catch (const InputError& error) {
    ROS_ERROR_STREAM(name_ << ": initialpose refused: " << error.what());
  }
}

void LocalizerServer::takePose(const geometry_msgs::PoseWithCovarianceStamped& message) {
  const Eigen::Isometry3d map_from_frame = mapFrom(message.header.frame_id);
  const Pose pose = Pose::fromIsometry(map_from_frame * fromMessage(message.pose.pose));
  const std::optional<Eigen::Matrix3d> covariance = planarCovariance(message.pose);
  const ros::Time stamp = message.header.stamp;
  request([this, pose, covariance, map_from_frame, stamp](ImageLocalizer* it) {
    const std::optional<Pose> odometry = odometryAt(stamp);
    it->beforeNextImage([=](Localizer* localizer) {
      if (covariance) {
        localizer->setPose(floorEstimate(pose, rotated(*covariance, map_from_frame)), odometry);
      } else {
        localizer->setPose(pose, odometry);
      }
    });
  });
  ROS_INFO_STREAM(name_ << ": initial pose x " << pose.x << " m, y " << pose.y << " m, yaw "
                        << pose.yaw << " rad, from the next image on");
}

Eigen::Isometry3d LocalizerServer::mapFrom(const std::string& frame) const {
  const std::string& map_frame = localizer_.frames().map;
  if (frame == map_frame) return Eigen::Isometry3d::Identity();
  if (frame.empty()) throw InputError("header.frame_id is empty; expected '" + map_frame + "'");
  try {
    return fromMessage(
        transforms_.buffer().lookupTransform(map_frame, frame, ros::Time()).transform);
  } catch (const tf2::TransformException& error) {
    throw InputError("no transform from '" + frame + "' to '" + map_frame + "': " + error.what());
  }
}

std::optional<Pose> LocalizerServer::odometryAt(const ros::Time& stamp) const {
  const FrameNames& frames = localizer_.frames();
  if (frames.odom.empty()) return std::nullopt;
  const tf2::BufferCore& buffer = transforms_.buffer();
  const bool is_known = buffer.canTransform(frames.odom, frames.base, stamp);
  try {
    return Pose::fromIsometry(
        fromMessage(buffer.lookupTransform(frames.odom, frames.base, is_known ? stamp : ros::Time())
                        .transform));
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

void LocalizerServer::forgetPose() {
  request([](ImageLocalizer* it) {
    it->beforeNextImage([](Localizer* localizer) { localizer->forgetPose(); });
  });
  ROS_INFO_STREAM(name_ << ": pose forgotten, searching from the next image on");
}

void LocalizerServer::takeSavedPose() {
  if (parameters_.initial_pose) return;
  const std::optional<SavedPose> saved = pose_keeper_.lastPose(localizer_.frames().map);
  if (!saved) return;
  const MotionModelConfig& motion = parameters_.localizer.motion;
  const PoseEstimate pose = afterAPause(saved->map_from_base, motion.initial_position_deviation,
                                        motion.initial_heading_deviation);
  localizer_.beforeNextImage([pose](Localizer* localizer) { localizer->setPose(pose); });
}

void LocalizerServer::onSaveMap(std_srvs::Trigger::Response* response) {
  try {
    response->message = saveMap();
    response->success = 1;
  } catch (const std::exception& error) {
    response->message = error.what();
  }
  ROS_INFO_STREAM(name_ << ": save_map: " << response->message);
}

std::string LocalizerServer::saveMap() {
  const std::string path = settings_.mapFile();
  const bool learns = parameters_.mapping || parameters_.refine_map;
  if (!learns && settings_.unsavedChanges() == 0) {
    throw InputError("mapping and refine_map are off and nothing was changed: the map is as " +
                     path + " has it");
  }
  if (settings_.unsavedChanges() == 0) return saveLearnt(path);
  const std::string saved = settings_.editMap([](MapEditor* map) { return map->save(); });
  return learns ? saved + "; " + saveLearnt(path) : saved;
}

std::string LocalizerServer::saveLearnt(const std::string& path) {
  std::vector<ProvisionalMarker> provisional;
  std::vector<RefinedMarker> refined;
  {
    const std::lock_guard<std::mutex> lock(map_mutex_);
    provisional = provisional_;
    refined = refined_;
  }
  const std::vector<MapEntry> entries = usedEntries(provisional);
  const LearntMap learnt = withLearnt(readTextFile(path), refined, entries, path);
  if (learnt.isChanged()) {
    replaceFile(path, learnt.text);
    // The saved markers become the map's own and no longer belong to mapping.
    settings_.editMap([](MapEditor* map) { return map->reload(); });
  }
  std::string done;
  if (learnt.refined > 0) done = std::to_string(learnt.refined) + " refined in " + path;
  if (learnt.added > 0) {
    done += (done.empty() ? "" : ", ") + std::to_string(learnt.added) + " markers added to " + path;
  }
  done = done.empty() ? path + " has all already" : done + ", the old file is beside it with a ~";
  return done + "; " + std::to_string(provisional.size() - entries.size()) +
         " more are not known well enough yet";
}

void LocalizerServer::request(Request request) {
  const std::lock_guard<std::mutex> lock(request_mutex_);
  requests_.push_back(std::move(request));
}

}  // namespace omnitag
