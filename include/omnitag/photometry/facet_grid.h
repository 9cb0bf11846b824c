#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/grid_index.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// How a part of a marker's drawing images: from pixel to pixel and from pose to pose that hardly
/// changes within.
struct Facet {
  bool is_visible = false;
  /// Derivatives of the position on the drawing (modules) by the pixel, and by what is unknown in a
  /// frame where the pixel stays.
  Eigen::Matrix2d by_pixel = Eigen::Matrix2d::Zero();
  FrameJacobian by_frame = FrameJacobian::Zero();
  /// What a pixel sees of the drawing: a parallelogram whose sides are the columns of `by_pixel`,
  /// made longer by the lens's blur and swept along by the motion during the exposure.
  TagPattern::Window window;
};

/// Pixels, the last ones included; none where the last ones are before the first.
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = -1;
  int bottom = -1;
};

/// A marker's drawing cut into as many facets along either side, as they image from a pose.
class FacetGrid {
 public:
  FacetGrid(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
            const Pose& map_from_base, int facets_along);

  /// The facet of a position (modules); of one off the drawing, one of those nearest.
  const Facet& at(const Eigen::Vector2d& position) const {
    return facets_[gridIndex(indexAlong(position.x()), indexAlong(position.y()), facets_along_)];
  }

  /// All of them, row by row, and the number of the one that at() gives.
  const std::vector<Facet>& facets() const { return facets_; }
  int numberOf(const Facet& facet) const { return static_cast<int>(&facet - facets_.data()); }

  /// Pixels of the image that show all that is visible of the drawing.
  const PixelBox& box() const { return box_; }

  /// How many pixels the visible facets cover.
  double area() const;

 private:
  int indexAlong(double coordinate) const {
    return std::clamp(static_cast<int>(coordinate * facets_per_module_), 0, facets_along_ - 1);
  }

  int facets_along_;
  double facets_per_module_;
  /// Row by row.
  std::vector<Facet> facets_;
  PixelBox box_;
};

}  // namespace omnitag
