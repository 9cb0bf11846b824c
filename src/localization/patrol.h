#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/exploration.h"
#include "localization/frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// Looks for what a pose does not predict: markers that hang elsewhere than the map says, and
/// markers that the map does not have. It reads a view now and then, so that everything is seen
/// within AttentionConfig::period while the time per frame stays even; more while exploring
/// (Exploration).
class Patrol {
 public:
  void seek(std::vector<Marker> markers) { exploration_.seek(std::move(markers)); }

  /// Adds what is read away from its projection from the frame's pose. Reads nothing more if
  /// `result->explored` already holds what was read all around.
  void look(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
            const Pose& map_from_base, FrameResult* result);

 private:
  /// A view that showed a marker of the map elsewhere, and the stamp (s) until which it takes every
  /// second turn.
  struct OddView {
    std::size_t index;
    double until;
  };

  void explore(const TrackingTools& tools, const MountedCamera& camera, const Pose& map_from_base,
               FrameResult* result);
  /// Reads the view whose turn it is, if the saved pixels suffice.
  std::vector<MarkerReading> readNextView(const TrackingTools& tools, const MountedCamera& camera,
                                          FrameResult* result);
  std::size_t nextOf(std::size_t count, double stamp);

  Exploration exploration_;
  /// Stamp of the last frame, and the share of a period's pixels that may now be read: accrued
  /// since then or saved before.
  std::optional<double> last_stamp_;
  double credit_ = 0.0;
  /// The view whose turn is next, and how many turns there have been.
  std::size_t next_view_ = 0;
  std::size_t looks_ = 0;
  std::vector<OddView> odd_views_;
  std::size_t last_view_ = 0;
};

}  // namespace omnitag
