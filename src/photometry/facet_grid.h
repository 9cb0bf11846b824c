#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "camera/mounted_camera.h"
#include "common/grid_index.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a part of a marker's drawing images. Within the part this hardly changes from pixel to pixel
/// or from pose to pose.
struct Facet {
  bool is_visible = false;
  /// Its middle on the drawing, from the drawing's middle; the sides have length 1.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  /// Derivatives of the position on the drawing (modules) with respect to the pixel, and to a
  /// frame's unknowns at a fixed pixel.
  Eigen::Matrix2d by_pixel = Eigen::Matrix2d::Zero();
  FrameJacobian by_frame = FrameJacobian::Zero();
  /// The part of the drawing that a pixel sees: a parallelogram whose sides are the columns of
  /// `by_pixel`, extended by the lens's blur and swept by the motion during the exposure.
  TagPattern::Window window;
};

/// A box of pixels, bounds included; empty if `right` < `left` or `bottom` < `top`.
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = -1;
  int bottom = -1;
};

/// A marker's drawing as seen from a pose, cut into a square grid of facets.
class FacetGrid {
 public:
  FacetGrid(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
            const Pose& map_from_base, int facets_along);

  /// The facet at a position (modules); for a position off the drawing, the nearest one.
  const Facet& at(const Eigen::Vector2d& position) const {
    return facets_[gridIndex(indexAlong(position.x()), indexAlong(position.y()), facets_along_)];
  }

  /// All facets, row by row, and the index of one that at() returned.
  const std::vector<Facet>& facets() const { return facets_; }
  int numberOf(const Facet& facet) const { return static_cast<int>(&facet - facets_.data()); }

  /// The pixels that show the visible part of the drawing.
  const PixelBox& box() const { return box_; }

  /// Area of the visible facets in pixels.
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
