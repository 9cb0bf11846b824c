#pragma once

#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "photometry/drawing_plane.h"
#include "photometry/facet_grid.h"
#include "photometry/marker_patch.h"

namespace omnitag {

/// Pixels that see a marker's drawing.
struct SortedPixels {
  /// Pixels that may see an edge; all pixels if the choice limits neither kind.
  std::vector<PixelPosition> at_edges;
  /// One of several pixels that see even black or white and are surrounded by it.
  std::vector<PixelPosition> on_even_ground;
};

/// Considers the pixels that `choice` allows. `plane` and `facets` are the drawing's, from the
/// same pose.
SortedPixels sortPixels(const TagPattern& pattern, const MountedCamera& camera,
                        const DrawingPlane& plane, const FacetGrid& facets,
                        const MarkerPatch::Choice& choice);

}  // namespace omnitag
