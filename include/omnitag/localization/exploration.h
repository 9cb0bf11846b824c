#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/view/contour_table.h"
#include "omnitag/view/view.h"

namespace omnitag {

/// Where to look for markers that the map does not have, frame by frame, at a bounded cost: with a
/// glance at the panorama itself, which reads most of them (GlanceReader); at what was read before,
/// where it should be in sight; and, in turn, at views of everything.
class Exploration {
 public:
  /// Markers that were read somewhere and are to be read again; `Marker::deviation` says how far
  /// one may be from its place.
  void seek(std::vector<Marker> markers) { sought_.markers = std::move(markers); }

  /// Whether the next frame is to be glanced at. That costs as much as one view of everything:
  /// where a frame may cost no more, every other is.
  bool wantsGlance(const LocalizerConfig& config);

  /// The views of the next frame, from a pose. `all` show everything, and `config.exploring_views`
  /// says how many of them a frame may cost, in pixels, over time, the glance included. Up to half
  /// of what the glance leaves goes to small views around sought markers that were not `read` yet;
  /// they take turns.
  std::vector<View> views(const std::vector<View>& all, const MountedCamera& camera,
                          const Pose& map_from_base, const ContourTable& table,
                          const std::vector<MarkerReading>& read, const LocalizerConfig& config);

 private:
  /// Views around sought markers that have about this many pixels together, at least one.
  std::vector<View> viewsOfSought(double max_pixels, const MountedCamera& camera,
                                  const Pose& map_from_base, const ContourTable& table,
                                  const std::vector<MarkerReading>& read,
                                  const LocalizerConfig& config);

  MarkerMap sought_;
  /// The sought marker, and the view of everything, whose turn is next.
  std::size_t next_sought_ = 0;
  std::size_t next_view_ = 0;
  bool has_glanced_ = false;
  /// Pixels that frames did not spend.
  double saved_pixels_ = 0.0;
};

}  // namespace omnitag
