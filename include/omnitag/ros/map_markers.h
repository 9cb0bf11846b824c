#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "omnitag/adjustment/marker_mapper.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The marker map for RViz: `tags`, as they are printed (in a map of more than 200 with their
/// border alone) and grey on their back; `normals`, an arrowhead out of each face; `names`, the
/// entry's id and name. Markers that mapping has found are framed and named in green where they are
/// used, in orange where they are not known well enough yet. Throws InputError for a tag that the
/// AprilTag library does not have.
visualization_msgs::MarkerArray mapMarkers(const MarkerMap& map,
                                           const std::vector<ProvisionalMarker>& provisional,
                                           const std::string& map_frame);

/// The map as RViz shows it, redrawn where mapping has made a visible difference.
class MapDrawing {
 public:
  MapDrawing(const MarkerMap& map, const std::string& map_frame);

  /// Whether it was redrawn: where markers came or went, are used now, or are 1 cm from where
  /// they were last drawn.
  bool update(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional);

  /// Draws another map; what the one before showed goes.
  void replace(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional);

  const visualization_msgs::MarkerArray& markers() const { return markers_; }

 private:
  std::string map_frame_;
  visualization_msgs::MarkerArray markers_;
  /// What `markers_` shows of mapping.
  std::vector<ProvisionalMarker> drawn_;
};

}  // namespace omnitag
