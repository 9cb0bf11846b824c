#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <omnitag/LocalizationStatus.h>
#include <ros/ros.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/marker_mapper.h"
#include "localization/displacement.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"
#include "ros/image_input.h"

namespace omnitag {

/// Reports what the localizer is waiting for and how well it works: once a second in /diagnostics,
/// and in the log, which repeats a lasting problem from time to time.
///
/// Uses the wall clock, so that it also reports before the first /clock. Safe to use from
/// several threads.
class HealthMonitor {
 public:
  /// `input` must outlive the monitor.
  HealthMonitor(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                const ImageInput& input, MarkerMap map);

  /// The map was replaced, or mapping has added markers at its end or moved markers that it had
  /// added.
  void mapChanged(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional);

  /// The localizer has started afresh or has another map: forgets what earlier images showed of
  /// displaced markers.
  void startedAnew();

  /// A message came from this source of the input; a later call says what became of it.
  void imageCame(std::size_t source);
  /// The message was not an image of this camera.
  void imageRefused(const std::string& why);
  /// The image was not newer than the previous one.
  void imageLate();
  /// The camera's image was lost because its mounting was not known.
  void transformMissing(const std::string& why, const std::string& camera);
  /// tf was read and sent. `failure`: why it could not be; empty if it could.
  void transformsServed(const std::string& failure);
  /// `conflict`: why no transform is sent, from ParentWatch; empty if all is well.
  void parentChecked(const std::string& conflict);
  /// The image was localized. `odometry_problem`: empty if odometry is there or not asked for.
  void localized(const LocalizationStatus& status, const FrameResult& result,
                 const std::string& odometry_problem);

 private:
  using Clock = std::chrono::steady_clock;
  using Report = diagnostic_updater::DiagnosticStatusWrapper;

  /// Something that can go wrong. `problem` is empty while all is well; `last_line`: when the log
  /// last mentioned a problem.
  struct Subject {
    std::string problem;
    std::optional<Clock::time_point> last_line;
  };

  /// What is known of a source's images.
  struct Arrival {
    std::uint64_t received = 0;
    std::optional<Clock::time_point> last;
    /// The same by ROS's clock.
    ros::Time last_time;
    /// Why the last one was refused; empty if it was not.
    std::string refusal;
  };
  /// Notes when an image of the last source came and when it was processed: a simulated clock may
  /// reach its stamp only in between.
  void imageIsHere(const std::string& refusal = "");
  /// Also counts images that gave way to newer ones before they were processed.
  void noteArrivals();
  /// What is wrong with or missing from the images of all sources; empty if nothing is.
  std::string problemOfImages() const;
  /// Whether ROS's clock has hardly moved since a source's last image, as when a bag is paused.
  static bool isPaused(const Arrival& arrival);
  /// Whether all sources have been silent for some time.
  bool areAllSilent() const;
  void noteStatus(const LocalizationStatus& status);
  void reportImages(Report& report);
  void reportTransforms(Report& report);
  void reportLocalization(Report& report);
  void reportMap(Report& report);
  /// Which markers hang elsewhere, in words: as groups that were moved as one, or alone.
  std::string describe(const std::vector<GroupDisplacement>& groups,
                       const std::vector<DisplacedMarker>& displaced) const;
  /// Complains about a problem; an empty `problem` settles the subject.
  void update(Subject* subject, const std::string& problem, const std::string& all_is_well,
              ros::console::Level level = ros::console::levels::Warn);
  void complain(Subject* subject, const std::string& problem,
                ros::console::Level level = ros::console::levels::Warn);
  void settle(Subject* subject, const std::string& all_is_well);

  const ImageInput& input_;
  const std::string name_;
  const Clock::time_point start_ = Clock::now();

  std::mutex mutex_;
  MarkerMap map_;
  /// Markers that mapping has found: used ones, and those not used yet.
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
  /// By source.
  std::vector<Arrival> arrivals_;
  std::size_t last_source_ = 0;
  /// By camera: which transforms its images lack, and advice.
  std::map<std::string, std::string> missing_transforms_;
  std::map<std::string, std::string> advice_of_;
  std::uint64_t refused_images_ = 0;
  std::uint64_t late_images_ = 0;
  std::uint64_t late_at_last_report_ = 0;
  std::uint64_t images_without_transform_ = 0;
  std::optional<LocalizationStatus> last_status_;
  /// When markers last gave a pose.
  std::optional<Clock::time_point> last_tracked_;
  std::optional<PoseEstimate> last_pose_;

  // Last, so that no report runs while the members it reads are being destroyed.
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace omnitag
