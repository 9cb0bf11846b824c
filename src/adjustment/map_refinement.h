#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "adjustment/marker_projection.h"
#include "localization/motion_model.h"
#include "marker/tag_pattern.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

struct JointEstimate;
struct KeyFrame;

/// A marker as the map file has it, and where it is now known to hang.
struct RefinedMarker {
  Marker in_file;
  Marker refined;
};

/// Refines the places of a map's markers while the robot drives. Images show how markers hang
/// relative to each other; each updates one joint normal distribution (a Kalman filter) over the
/// MarkerIncrements of all markers, the camera's modes, and the constant part of the robot's
/// height and lean. The map's deviations are the prior: a marker moves only as far as they allow,
/// and one without deviations not at all.
///
/// Markers that are seen together share errors: the map as a whole is known only as well as its
/// markers are on average. The localizer takes their errors for independent. A refined marker's
/// deviations are therefore large enough to cover those of a pose from all markers that were seen
/// together with it, but never larger than the map's. Not thread-safe.
class MapRefinement {
 public:
  /// Throws InputError if the map names a family that there is not.
  MapRefinement(const CameraModels& cameras, const MarkerMap& map, const MotionModelConfig& motion);
  ~MapRefinement();
  MapRefinement(MapRefinement&& other) noexcept;
  MapRefinement& operator=(MapRefinement&& other) noexcept;

  /// Processes a frame. Uses it if the robot is at least 0.15 m from where it was in all frames
  /// used before: from the same place, pixels would repeat their errors. Returns whether map() has
  /// changed.
  bool add(const Frame& frame, const FrameResult& result);

  const MarkerMap& map() const { return map_; }

  /// The markers whose places in map() differ from the file's.
  std::vector<RefinedMarker> refined() const;

  /// Replaces the map. If it begins with the same markers, where they hung before or after they
  /// were refined, what is known of them is kept; otherwise nothing is.
  void setMap(const MarkerMap& map);

 private:
  /// A marker of the map: as the file has it, and what images have shown of it.
  struct Landmark {
    Marker in_file;
    /// Where its increment begins in the joint estimate; none if it has no deviations.
    std::optional<Eigen::Index> increment;
    /// Number of images used that show it.
    std::size_t sights = 0;
  };

  bool continues(const MarkerMap& map) const;
  void append(const Marker& marker);
  bool isUsable(const FrameResult& result) const;
  KeyFrame keyFrame(const Frame& frame, const FrameResult& result) const;
  void updateMap();
  Marker refinedMarker(const Landmark& landmark, double covering) const;
  MarkerCovariance blockOf(const Landmark& a, const Landmark& b) const;
  /// For each landmark, by how much its variance must be enlarged so that the markers of any image
  /// used, taken for independent, have at least the covariance that they have; 0 if none shows it.
  std::vector<double> coveringFactors() const;

  std::size_t camera_count_;
  MotionModelConfig motion_;
  MarkerMap map_;
  TagPatterns patterns_;
  std::vector<Landmark> landmarks_;
  /// Height, roll and pitch; the modes of each camera; the increments.
  std::unique_ptr<JointEstimate> joint_;
  /// Where the robot was in the images used.
  std::vector<Pose> places_;
  /// The landmarks with an increment that each of them shows.
  std::vector<std::vector<std::size_t>> views_;
};

}  // namespace omnitag
