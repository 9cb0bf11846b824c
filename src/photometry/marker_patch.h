#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "photometry/facet_grid.h"

namespace omnitag {

/// A pixel and the position on the drawing (modules) that it sees.
struct PixelPosition {
  int column = 0;
  int row = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// What a pixel of the panorama sees of a marker's drawing: the facet's window around
/// `position` (modules).
struct Footprint {
  int column = 0;
  int row = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// Owned by the patch.
  const Facet* facet = nullptr;
};

/// A pixel of a marker as measured and as the pattern predicts it.
struct MarkerPixel {
  int column = 0;
  int row = 0;
  double grey = 0.0;
  /// Share of white in the part of the pattern that the pixel sees.
  double white = 0.0;
  /// How much the share of white changes from pixel to pixel.
  double gradient = 0.0;
  /// On the tag's drawing, from its middle; the sides have length 1.
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// Derivative of `white` with respect to the position on the drawing, per module.
  Eigen::Vector2d white_by_position = Eigen::Vector2d::Zero();
  /// Index of its facet.
  int facet = 0;
};

/// Pixels of a marker and its facets.
struct MarkerPixels {
  std::vector<MarkerPixel> pixels;
  std::shared_ptr<const FacetGrid> grid;

  const std::vector<Facet>& facets() const { return grid->facets(); }

  /// The change of the position on the drawing (modules), for each facet.
  std::vector<Eigen::Vector2d> positionChanges(const FrameVector& change) const;
};

/// Changes of the position on the drawing (modules), one for each facet; none at all if empty.
using FacetChanges = std::vector<Eigen::Vector2d>;

/// One for each pixel of a patch; nothing if a pixel does not see the world.
using LinesOfSight = std::vector<std::optional<Ray>>;

/// The part of a panorama that shows a marker.
class MarkerPatch {
 public:
  /// Which of a marker's pixels are used, and how exactly.
  struct Choice {
    /// About this many at most, on an even grid.
    std::size_t max_considered = std::numeric_limits<std::size_t>::max();
    /// Of those, at most this many near edges of the pattern, which determine where it is, and this
    /// many surrounded by even black or white, which determine only the light.
    std::size_t max_at_edges = std::numeric_limits<std::size_t>::max();
    std::size_t max_on_even_ground = std::numeric_limits<std::size_t>::max();
    /// Pixels by which edges may still be displaced.
    double reach = 1.5;
    /// Tolerated error of positions, in pixels; larger is faster.
    double tolerance = 0.0015;
    /// Facets along either side of the drawing.
    int facets = 4;
  };

  /// `marker`, `pattern` and `camera` must outlive the patch. `map_from_base` must predict where
  /// the marker images to about a pixel.
  MarkerPatch(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
              const Pose& map_from_base, const Choice& choice);

  /// The footprints of the pixels that see only the drawing. Valid as long as the patch.
  std::vector<Footprint> footprints() const;

  const std::vector<Facet>& facets() const { return facets_->facets(); }

  /// The same pixels with their grey levels in the panorama (CV_8UC1), after these changes.
  MarkerPixels pixels(const cv::Mat& panorama, const FacetChanges& changes = {}) const;

  /// The lines of sight of the patch's pixels in base_link, for use at other poses.
  LinesOfSight linesOfSight() const;

  /// As pixels() above, at a pose near the constructor's, with this change of the camera's error in
  /// addition to these changes. `lines`: from linesOfSight().
  MarkerPixels pixels(const cv::Mat& panorama, const LinesOfSight& lines, const Pose& map_from_base,
                      const ImagingError& error_change, const FacetChanges& changes = {}) const;

 private:
  /// Keeps at most `at_most` of the pixels, evenly spread.
  void keep(const std::vector<PixelPosition>& pixels, std::size_t at_most);
  /// The facet at a position if the pixel there sees only the drawing; null otherwise.
  const Facet* facetWithinDrawing(const Eigen::Vector2d& position) const;
  MarkerPixel pixelAt(const cv::Mat& panorama, const PixelPosition& place,
                      const Facet& facet) const;
  /// The position after the changes.
  Eigen::Vector2d changed(const Eigen::Vector2d& position, const FacetChanges& changes) const;
  /// No pixels, with room for this many.
  MarkerPixels emptyPixels(std::size_t at_most) const;

  const Marker& marker_;
  const TagPattern& pattern_;
  const MountedCamera& camera_;
  std::shared_ptr<const FacetGrid> facets_;
  /// As seen from the constructor's pose.
  std::vector<PixelPosition> places_;
};

}  // namespace omnitag
