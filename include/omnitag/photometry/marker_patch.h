#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/photometry/facet_grid.h"

namespace omnitag {

/// A pixel and the position on the drawing (modules) that it sees.
struct PixelPosition {
  int column = 0;
  int row = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// What a pixel of the panorama sees of a marker's drawing: what the facet's window shows about
/// `position` (modules).
struct Footprint {
  int column = 0;
  int row = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// The patch's.
  const Facet* facet = nullptr;
};

/// A pixel of a marker as it is and as the pattern would have it.
struct MarkerPixel {
  int column = 0;
  int row = 0;
  double grey = 0.0;
  /// Share of white in what the pixel sees of the pattern.
  double white = 0.0;
  /// How much the share of white changes from pixel to pixel.
  double gradient = 0.0;
  /// On the drawing of the tag, whose sides have length 1, from its middle.
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// Derivative of `white` by the position on the drawing, per module.
  Eigen::Vector2d white_by_position = Eigen::Vector2d::Zero();
  /// Its facet's number.
  int facet = 0;
};

/// Pixels of a marker and its facets.
struct MarkerPixels {
  std::vector<MarkerPixel> pixels;
  std::shared_ptr<const FacetGrid> grid;

  const std::vector<Facet>& facets() const { return grid->facets(); }

  /// For each facet, by how much the position on the drawing (modules) changes.
  std::vector<Eigen::Vector2d> positionChanges(const FrameVector& change) const;
};

/// One for each pixel of a patch; nothing where a pixel shows no world.
using LinesOfSight = std::vector<std::optional<Ray>>;

/// The part of a panorama that shows a marker.
class MarkerPatch {
 public:
  /// Which of a marker's pixels are looked at, and how closely.
  struct Choice {
    /// About this many at most, on an even grid.
    std::size_t max_considered = std::numeric_limits<std::size_t>::max();
    /// Of those, at most this many near edges of the pattern, which tell where it is, and this many
    /// with nothing but even black or even white around them, which only tell the light.
    std::size_t max_at_edges = std::numeric_limits<std::size_t>::max();
    std::size_t max_on_even_ground = std::numeric_limits<std::size_t>::max();
    /// Pixels by which edges may still turn out to be elsewhere.
    double reach = 1.5;
    /// Pixels by which positions may be off; many are faster.
    double tolerance = 0.0015;
    /// Facets along either side of the drawing.
    int facets = 4;
  };

  /// `marker`, `pattern` and `camera` must outlive the patch. `map_from_base` says, to about a
  /// pixel, where the marker images.
  MarkerPatch(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
              const Pose& map_from_base, const Choice& choice);

  /// What the pixels see that see nothing but the drawing. Valid as long as the patch.
  std::vector<Footprint> footprints() const;

  /// The same pixels with their grey levels in the panorama (CV_8UC1).
  MarkerPixels pixels(const cv::Mat& panorama) const;

  /// The lines of sight of the patch's pixels in base_link, to follow them to other poses.
  LinesOfSight linesOfSight() const;

  /// As pixels() above, at a pose near the one of the constructor, where the camera's error is that
  /// much more. `lines` are the patch's.
  MarkerPixels pixels(const cv::Mat& panorama, const LinesOfSight& lines, const Pose& map_from_base,
                      const ImagingError& error_change) const;

 private:
  /// Keeps at most this many of the pixels, evenly spread.
  void keep(const std::vector<PixelPosition>& pixels, std::size_t at_most);
  /// The facet of a position about which a pixel sees nothing but the drawing; null elsewhere.
  const Facet* facetWithinDrawing(const Eigen::Vector2d& position) const;
  MarkerPixel pixelAt(const cv::Mat& panorama, const PixelPosition& place,
                      const Facet& facet) const;
  /// Room for this many pixels, none yet.
  MarkerPixels emptyPixels(std::size_t at_most) const;

  const Marker& marker_;
  const TagPattern& pattern_;
  const MountedCamera& camera_;
  std::shared_ptr<const FacetGrid> facets_;
  /// From the pose of the constructor.
  std::vector<PixelPosition> places_;
};

}  // namespace omnitag
