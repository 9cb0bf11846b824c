#include "group_trial.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/stopwatch.h"
#include "marker/marker_prediction.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"
#include "room_route.h"
#include "wrong_pose.h"

namespace omnitag {
namespace {

/// Looks down on its mirror, ahead of the robot's middle and turned.
Eigen::Isometry3d mounting() {
  return Eigen::Translation3d(0.10, -0.05, 1.1) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
}

std::vector<std::size_t> markersInView(const Room& room, const MountedCamera& camera,
                                       const Pose& map_from_base) {
  VisibilityConfig well;
  well.max_incidence = radians(65.0);
  const Eigen::Vector3d eye = camera.mapFromCamera(map_from_base).translation();
  std::vector<std::size_t> entries;
  for (const PredictedMarker& marker :
       predictMarkers(room.markers, camera, {map_from_base}, well)) {
    const Corners<Eigen::Vector3d> corners = room.markers.markers[marker.map_entry].corners();
    const bool is_hidden =
        std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& corner) {
          return isHidden(eye.head<2>(), corner.head<2>(), room.walls);
        });
    if (!is_hidden) entries.push_back(marker.map_entry);
  }
  return entries;
}

void setOdometry(const std::vector<Pose>& odometry, std::vector<TrialFrame>* frames) {
  for (std::size_t i = 0; i < frames->size(); ++i) (*frames)[i].odometry = odometry[i];
}

JudgedFrame judge(FrameResult result, const Pose& truth) {
  JudgedFrame judged;
  judged.truth = truth;
  judged.has_pose = result.map_from_base.has_value();
  if (judged.has_pose) {
    const PoseEstimate& estimate = *result.map_from_base;
    const Eigen::Vector2d error(estimate.pose.x - truth.x, estimate.pose.y - truth.y);
    const Eigen::Matrix2d covariance = estimate.covariance.topLeftCorner<2, 2>();
    judged.distance = error.norm();
    judged.deviations = std::sqrt(error.dot(covariance.inverse() * error));
    judged.is_wrong = isWrong(estimate, error);
  }
  judged.result = std::move(result);
  return judged;
}

}  // namespace

const char* toString(Case what) {
  switch (what) {
    case Case::kMoved:
      return "moved";
    case Case::kUnmoved:
      return "unmoved";
    case Case::kCarriedOff:
      return "carried off";
  }
  return "";
}

Trials::Trials(std::shared_ptr<const CameraModel> camera)
    : model_(std::move(camera)), camera_(model_, mounting()), renderer_(camera_) {}

double Trials::imageTime() const { return image_seconds_ / std::max(images_, 1); }

Trial Trials::make(unsigned room, unsigned seed) {
  std::seed_seq sequence{seed, room};
  std::mt19937 generator(sequence);
  Trial trial;
  trial.room = randomRoom(&generator);
  trial.group = randomGroup(trial.room.markers, room % 2 == 1, &generator);
  const std::vector<Pose> route = randomRoute(trial.room, kFrames, &generator);
  const std::vector<Pose> before(route.begin(), route.begin() + kCarriedAt);
  const std::vector<Pose> after =
      routeAfterCarrying(before.back(), trial.room, kFrames - kCarriedAt, &generator);
  const std::vector<Pose> odometry = odometryOf({route}, &generator);
  const std::vector<Pose> odometry_carried = odometryOf({before, after}, &generator);

  trial.drive = shoot(trial.room, route, &generator);
  trial.carried_off.assign(trial.drive.begin(), trial.drive.begin() + kCarriedAt);
  for (TrialFrame& frame : shoot(trial.room, after, &generator)) {
    trial.carried_off.push_back(std::move(frame));
  }
  setOdometry(odometry, &trial.drive);
  setOdometry(odometry_carried, &trial.carried_off);
  return trial;
}

std::vector<TrialFrame> Trials::shoot(const Room& room, const std::vector<Pose>& route,
                                      std::mt19937* generator) {
  constexpr double kNoise = 2.0;  // grey levels
  const TagPatterns patterns(room.markers);
  std::vector<TrialFrame> frames;
  for (const Pose& pose : route) {
    Stopwatch stopwatch;
    TrialFrame frame;
    frame.truth = pose;
    frame.image = withGreyNoise(renderer_.render(room.markers, patterns, room.walls, pose), kNoise,
                                (*generator)());
    image_seconds_ += stopwatch.lap();
    ++images_;
    frame.in_view = markersInView(room, camera_, pose);
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<JudgedFrame> Trials::follow(const Trial& trial, Case what, bool has_odometry) const {
  const bool is_moved = what == Case::kMoved;
  const bool is_carried = what == Case::kCarriedOff;
  const std::vector<TrialFrame>& frames = is_carried ? trial.carried_off : trial.drive;
  const MarkerMap map = is_moved ? displaced(trial.room.markers, trial.group) : trial.room.markers;
  Localizer localizer(model_, map, {});
  localizer.setPose(frames.front().truth);

  bool has_been_in_view = false;
  std::vector<JudgedFrame> judged;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Frame frame;
    frame.stamp = 1.0 + kRouteInterval * static_cast<double>(i);
    frame.image = frames[i].image;
    frame.base_from_camera = camera_.baseFromCamera();
    if (has_odometry) frame.odom_from_base = frames[i].odometry;
    JudgedFrame one = judge(localizer.process(frame), frames[i].truth);
    for (const std::size_t entry : frames[i].in_view) {
      const bool is_off = is_moved && trial.group.entries.count(entry) > 0;
      ++(is_off ? one.moved_in_view : one.right_in_view);
    }
    if (is_carried && i == kCarriedAt) has_been_in_view = false;
    has_been_in_view = has_been_in_view || one.right_in_view > 0;
    one.has_been_in_view = has_been_in_view;
    judged.push_back(std::move(one));
  }
  return judged;
}

}  // namespace omnitag
