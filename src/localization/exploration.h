#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/marker_reader.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/view/view.h"
#include "view/contour_table.h"

namespace omnitag {

/// Where to look for markers that the map does not have, at a bounded cost per frame: in a glance
/// at the panorama, which reads most of them (GlanceReader); where markers were read before and
/// should be in view; and, in turn, in views of everything.
class Exploration {
 public:
  /// Sets the markers that were read somewhere and should be read again; `Marker::deviation` is how
  /// far each may be from its place.
  void seek(std::vector<Marker> markers) { sought_.markers = std::move(markers); }

  /// Whether to glance at the next frame. A glance costs as much as one view of everything: if that
  /// is all a frame may cost, only every second frame gets one.
  bool wantsGlance(const LocalizerConfig& config);

  /// The views of the next frame, taken at a pose. `all` show everything; `config.exploring_views`
  /// is how many of them a frame may cost on average, in pixels and including the glance. Up to
  /// half of what the glance leaves goes to small views around sought markers that are not in
  /// `read` yet; they take turns.
  std::vector<View> views(const std::vector<View>& all, const MountedCamera& camera,
                          const Pose& map_from_base, const ContourTable& table,
                          const std::vector<MarkerReading>& read, const LocalizerConfig& config);

 private:
  /// Views around sought markers, with about this many pixels together; at least one.
  std::vector<View> viewsOfSought(double max_pixels, const MountedCamera& camera,
                                  const Pose& map_from_base, const ContourTable& table,
                                  const std::vector<MarkerReading>& read,
                                  const LocalizerConfig& config);

  MarkerMap sought_;
  /// Whose turn is next: among the sought markers, and among the views of everything.
  std::size_t next_sought_ = 0;
  std::size_t next_view_ = 0;
  bool has_glanced_ = false;
  /// Pixels that earlier frames did not spend.
  double saved_pixels_ = 0.0;
};

}  // namespace omnitag
