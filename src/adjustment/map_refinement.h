#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "adjustment/joint_estimate.h"
#include "adjustment/key_frame.h"
#include "adjustment/marker_projection.h"
#include "localization/motion_model.h"
#include "marker/tag_pattern.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker as the map has it, and where it is now known to hang.
struct RefinedMarker {
  Marker given;
  Marker refined;
};

/// Refines the places of a map's markers while the robot drives. Images show how markers hang
/// relative to each other; each updates one joint normal distribution (a Kalman filter) over the
/// MarkerIncrements of the markers seen so far, the camera's modes, and the constant part of the
/// robot's height and lean. The map's deviations are the prior: a marker moves only as far as they
/// allow, and one without deviations not at all. The cost of an image grows with the square of the
/// number of markers seen.
///
/// Markers that are seen together share errors: the map as a whole is known only as well as its
/// markers are on average. The localizer takes their errors for independent. A refined marker's
/// deviations are therefore enlarged to cover a pose from the markers of any image used, but never
/// beyond the map's. Not thread-safe.
class MapRefinement {
 public:
  /// Throws InputError if the map names a family that there is not.
  MapRefinement(std::size_t camera_count, const MarkerMap& map, const MotionModelConfig& motion);

  /// Processes a frame. Uses it if the camera's robot is at least 0.15 m from where it was in all
  /// of the camera's frames used before: from the same place, pixels would repeat their errors.
  /// Returns whether map() has changed.
  bool add(const Frame& frame, const FrameResult& result);

  const MarkerMap& map() const { return map_; }

  /// The markers that images have shown and that have deviations.
  std::vector<RefinedMarker> refined() const;

  /// Replaces the map. If it begins with the same markers, as the map had them before or as they
  /// were when they were refined, what is known of them is kept; otherwise nothing is.
  void setMap(const MarkerMap& map);

 private:
  struct Landmark {
    /// As the map first had it, which is the prior, and as it has it now.
    Marker prior;
    Marker given;
    /// Where its increment from the prior begins in the joint estimate, once an image has shown it.
    std::optional<Eigen::Index> increment;
    /// Number of images used that show it.
    std::size_t sights = 0;
  };
  /// Where the robot was in an image used.
  struct Place {
    std::size_t camera = 0;
    Eigen::Vector3d position;
  };

  bool continues(const MarkerMap& map) const;
  bool isUsable(const Frame& frame, const FrameResult& result) const;
  /// Of the map's own markers, whose detections are in their places.
  std::vector<const MarkerDetection*> usableDetections(const FrameResult& result) const;
  std::vector<KeyFrame::Sight> sightsIn(const Frame& frame, const FrameResult& result);
  void updateMap();
  Marker refinedMarker(const Landmark& landmark, double covering) const;
  MarkerCovariance blockOf(const Landmark& a, const Landmark& b) const;
  /// For each landmark, by how much its covariance must be enlarged so that the markers of any
  /// image used, taken for independent, have at least the covariance that they have.
  std::vector<double> coveringFactors() const;

  std::size_t camera_count_;
  MotionModelConfig motion_;
  MarkerMap map_;
  TagPatterns patterns_;
  std::vector<Landmark> landmarks_;
  /// Height, roll and pitch; the modes of each camera; the increments.
  JointEstimate joint_;
  std::vector<Place> places_;
  /// The landmarks with an increment that each image used shows.
  std::vector<std::vector<std::size_t>> views_;
};

}  // namespace omnitag
