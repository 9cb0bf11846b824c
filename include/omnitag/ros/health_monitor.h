#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <omnitag/LocalizationStatus.h>
#include <ros/ros.h>

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/adjustment/marker_mapper.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/displacement.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/ros/image_input.h"

namespace omnitag {

/// Says what the localizer is waiting for and how well it does: once a second in /diagnostics, and
/// in the log, where a lasting problem gets a line from time to time instead of silence.
///
/// Goes by the wall clock, so that it speaks before the first /clock too. Safe to use from several
/// threads.
class HealthMonitor {
 public:
  /// `input` must outlive the monitor.
  HealthMonitor(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                const ImageInput& input, MarkerMap map);

  /// Mapping has added markers behind those that the map had, or moved some of its own.
  void mapChanged(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional);

  /// The localizer has started afresh: forgets what earlier images told of the map.
  void startedAnew();

  /// The message was no image of this camera.
  void imageRefused(const std::string& why);
  /// The image was not newer than the one before it.
  void imageLate();
  /// The image was lost for want of the camera's mounting.
  void transformMissing(const std::string& why);
  /// tf was read and sent; `failure`: why it could not be, empty where it could.
  void transformsServed(const std::string& failure);
  /// `conflict`: why no transform is sent, from ParentWatch; empty: all is well.
  void parentChecked(const std::string& conflict);
  /// The image was localized; `odometry_problem` is empty where odometry is there or not asked for.
  void localized(const LocalizationStatus& status, const FrameResult& result,
                 const std::string& odometry_problem);

 private:
  using Clock = std::chrono::steady_clock;
  using Report = diagnostic_updater::DiagnosticStatusWrapper;

  /// Something that can be wrong, and when the log last said so; no time while all is well.
  struct Subject {
    std::string problem;
    std::optional<Clock::time_point> last_line;
  };

  void imageCame();
  /// Whether by ROS's clock no image is missing: a bag is paused.
  bool isPaused() const;
  void reportImages(Report& report);
  void reportTransforms(Report& report);
  void reportLocalization(Report& report);
  void reportMap(Report& report);
  /// In words, which markers hang elsewhere: as groups that were moved as one, and alone.
  std::string describe(const std::vector<GroupDisplacement>& groups,
                       const std::vector<DisplacedMarker>& displaced) const;
  /// Complains of a problem; an empty one is none.
  void update(Subject* subject, const std::string& problem, const std::string& all_is_well,
              ros::console::Level level = ros::console::levels::Warn);
  void complain(Subject* subject, const std::string& problem,
                ros::console::Level level = ros::console::levels::Warn);
  void settle(Subject* subject, const std::string& all_is_well);

  const ImageInput& input_;
  std::string name_;

  std::mutex mutex_;
  MarkerMap map_;
  /// Markers that mapping has found: those that are used, and those that are not yet.
  std::size_t mapped_ = 0;
  std::size_t waiting_ = 0;
  Subject images_;
  Subject transforms_;
  Subject serving_;
  Subject parent_;
  Subject late_;
  Subject localization_;
  Subject advice_;
  Subject marker_map_;
  DisplacementLog displacements_;
  Clock::time_point last_report_;
  std::uint64_t received_at_last_report_ = 0;
  std::optional<Clock::time_point> last_image_;
  /// The same by ROS's clock.
  ros::Time last_image_time_;
  std::uint64_t refused_images_ = 0;
  std::uint64_t late_images_ = 0;
  std::uint64_t late_at_last_report_ = 0;
  std::uint64_t images_without_transform_ = 0;
  std::optional<LocalizationStatus> last_status_;
  std::optional<PoseEstimate> last_pose_;

  // Last, so that no report is asked for while what it tells of is being destroyed.
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace omnitag
