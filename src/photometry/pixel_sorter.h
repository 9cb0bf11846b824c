#pragma once

#include <vector>

#include "drawing_plane.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/photometry/facet_grid.h"
#include "omnitag/photometry/marker_patch.h"

namespace omnitag {

/// Pixels that see a marker's drawing.
struct SortedPixels {
  /// What may see an edge; all where nothing is to be told apart.
  std::vector<PixelPosition> at_edges;
  /// Of those that see even black or even white, and so do all around, one of several.
  std::vector<PixelPosition> on_even_ground;
};

/// Looks at the pixels that `choice` says. `plane` and `facets` are the drawing's, from one pose.
SortedPixels sortPixels(const TagPattern& pattern, const MountedCamera& camera,
                        const DrawingPlane& plane, const FacetGrid& facets,
                        const MarkerPatch::Choice& choice);

}  // namespace omnitag
