#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "adjustment/marker_mapper.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The marker map for RViz: `tags`, as they are printed (only their border if there are more than
/// 200) and grey on the back; `normals`, an arrowhead out of each face; `names`, the entry's id and
/// name. Markers that mapping has found have a frame and a name in green if they are used, in
/// orange if they are not known well enough yet. Throws InputError for a tag that the AprilTag
/// library does not have.
visualization_msgs::MarkerArray mapMarkers(const MarkerMap& map,
                                           const std::vector<ProvisionalMarker>& provisional,
                                           const std::string& map_frame);

/// The map as RViz shows it, redrawn if mapping has made a visible difference.
class MapDrawing {
 public:
  MapDrawing(const MarkerMap& map, const std::string& map_frame);

  /// Redraws if markers came or went, are used now, or are at least 1 cm from where they were last
  /// drawn, or if the map's own markers were refined. Returns whether it did.
  bool update(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional,
              bool is_refined = false);

  /// Draws another map and deletes what is left of the previous one.
  void replace(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional);

  const visualization_msgs::MarkerArray& markers() const { return markers_; }

 private:
  std::string map_frame_;
  visualization_msgs::MarkerArray markers_;
  /// What mapping had found when `markers_` was drawn.
  std::vector<ProvisionalMarker> drawn_;
};

}  // namespace omnitag
