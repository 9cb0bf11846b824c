#include "group_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

bool isWrong(const JudgedFrame& frame) { return frame.is_wrong && frame.has_been_in_view; }

const char* nameOf(bool has_odometry) {
  return has_odometry ? "with odometry" : "without odometry";
}

bool isMoved(const Trial& trial, Case what, std::size_t entry) {
  return what == Case::kMoved && trial.group.entries.count(entry) > 0;
}

void showPlace(const Pose& pose) {
  std::printf(" %7.3f %7.3f %7.2f", pose.x, pose.y, degrees(pose.yaw));
}

void showDetection(const Trial& trial, Case what, const MarkerDetection& detection) {
  const std::vector<std::size_t> entries =
      entriesOf(trial.room.markers, detection.family, detection.id);
  const bool is_moved = !entries.empty() && isMoved(trial, what, entries.front());
  std::printf("      id %3d  %-7s %-8s %6.2f deviations %6.2f pixels %5.2f m  %s\n", detection.id,
              entries.empty() ? "unknown"
              : is_moved      ? "moved"
                              : "unmoved",
              detection.accepted ? "accepted" : "rejected", detection.deviations,
              detection.residual, detection.range, detection.reason.c_str());
}

void showInView(const Trial& trial, Case what, const TrialFrame& frame) {
  std::printf("  in view");
  for (const std::size_t entry : frame.in_view) {
    std::printf(" %d%s", trial.room.markers.markers[entry].id,
                isMoved(trial, what, entry) ? "m" : "");
  }
}

void showFrame(const Trial& trial, Case what, std::size_t number, const JudgedFrame& frame) {
  std::printf("%4zu ", number);
  showPlace(frame.truth);
  std::printf("  ");
  if (frame.has_pose) {
    const PoseEstimate& estimate = *frame.result.map_from_base;
    showPlace(estimate.pose);
    std::printf("  error %8.2f mm %7.2f deviations (%.2f %.2f mm)", 1e3 * frame.distance,
                frame.deviations, 1e3 * std::sqrt(estimate.covariance(0, 0)),
                1e3 * std::sqrt(estimate.covariance(1, 1)));
  } else {
    std::printf("  no pose");
  }
  std::printf("  %s%s", toString(frame.result.mode),
              isWrong(frame)   ? "  WRONG"
              : frame.is_wrong ? "  wrong before"
                               : "");
  const auto& frames = what == Case::kCarriedOff ? trial.carried_off : trial.drive;
  showInView(trial, what, frames[number]);
  std::printf("  %s\n", frame.result.remark.c_str());
  for (const MarkerDetection& detection : frame.result.detections) {
    showDetection(trial, what, detection);
  }
}

}  // namespace

std::size_t firstFrame(Case what) { return what == Case::kCarriedOff ? kCarriedAt : 0; }

bool hasWrong(Case what, const std::vector<JudgedFrame>& drive) {
  return std::any_of(drive.begin() + static_cast<std::ptrdiff_t>(firstFrame(what)), drive.end(),
                     isWrong);
}

void showWrong(unsigned room, const Trial& trial, Case what, bool has_odometry,
               const std::vector<JudgedFrame>& drive) {
  if (!hasWrong(what, drive)) return;
  std::printf("room %u, %s, %s: ", room, toString(what), nameOf(has_odometry));
  if (what == Case::kMoved) {
    std::printf("%zu by %.0f mm and %.1f degrees of ", trial.group.entries.size(),
                1e3 * trial.group.shift, degrees(trial.group.turn));
  }
  std::printf("%zu markers:", trial.room.markers.markers.size());
  for (std::size_t i = firstFrame(what); i < drive.size(); ++i) {
    if (!isWrong(drive[i])) continue;
    std::printf(" %zu (%.0f mm, %.1f, %d:%d%s)", i, 1e3 * drive[i].distance, drive[i].deviations,
                drive[i].right_in_view, drive[i].moved_in_view,
                drive[i].result.mode == Mode::kDeadReckoning ? ", reckoned" : "");
  }
  std::printf("\n");
  std::fflush(stdout);
}

void showRoom(const Trial& trial) {
  const Room& room = trial.room;
  const MarkerMap map = displaced(room.markers, trial.group);
  std::printf("%.2f x %.2f m, the group moved by %.0f mm and %.1f degrees\n", room.size.x(),
              room.size.y(), 1e3 * trial.group.shift, degrees(trial.group.turn));
  for (const Wall& wall : room.walls) {
    std::printf("wall from %.2f %.2f to %.2f %.2f\n", wall.from.x(), wall.from.y(), wall.to.x(),
                wall.to.y());
  }
  for (std::size_t i = 0; i < room.markers.markers.size(); ++i) {
    const Marker& marker = room.markers.markers[i];
    const Eigen::Vector3d center = marker.center();
    std::printf("id %3d  %.2f m at %6.3f %6.3f %6.3f facing %6.1f", marker.id, marker.size,
                center.x(), center.y(), center.z(),
                degrees(std::atan2(marker.normal().y(), marker.normal().x())));
    const Eigen::Vector3d mapped = map.markers[i].center();
    if (isMoved(trial, Case::kMoved, i)) {
      std::printf("  mapped at %6.3f %6.3f", mapped.x(), mapped.y());
    }
    std::printf("\n");
  }
}

void showDrive(const Trial& trial, Case what, bool has_odometry,
               const std::vector<JudgedFrame>& drive) {
  std::printf("\n%s, %s: truth (m, m, degrees), estimate\n", toString(what), nameOf(has_odometry));
  for (std::size_t i = 0; i < drive.size(); ++i) showFrame(trial, what, i, drive[i]);
}

}  // namespace omnitag
