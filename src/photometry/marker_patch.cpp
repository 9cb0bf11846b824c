#include "photometry/marker_patch.h"

#include <algorithm>
#include <cstdint>

#include "photometry/drawing_plane.h"
#include "photometry/pixel_sorter.h"

namespace omnitag {

std::vector<Eigen::Vector2d> MarkerPixels::positionChanges(const FrameVector& change) const {
  std::vector<Eigen::Vector2d> changes;
  changes.reserve(facets().size());
  for (const Facet& facet : facets()) changes.emplace_back(facet.by_frame * change);
  return changes;
}

MarkerPatch::MarkerPatch(const Marker& marker, const TagPattern& pattern,
                         const MountedCamera& camera, const Pose& map_from_base,
                         const Choice& choice)
    : marker_(marker),
      pattern_(pattern),
      camera_(camera),
      facets_(std::make_shared<FacetGrid>(marker, pattern, camera, map_from_base, choice.facets)) {
  const DrawingPlane plane(marker, pattern, map_from_base);
  const SortedPixels sorted = sortPixels(pattern, camera, plane, *facets_, choice);
  places_.reserve(std::min(sorted.at_edges.size(), choice.max_at_edges) +
                  std::min(sorted.on_even_ground.size(), choice.max_on_even_ground));
  keep(sorted.at_edges, choice.max_at_edges);
  keep(sorted.on_even_ground, choice.max_on_even_ground);
}

void MarkerPatch::keep(const std::vector<PixelPosition>& pixels, std::size_t at_most) {
  if (at_most == 0) return;
  const std::size_t every =
      std::max<std::size_t>(1, pixels.size() / at_most + (pixels.size() % at_most != 0 ? 1 : 0));
  for (std::size_t i = 0; i < pixels.size(); i += every) places_.push_back(pixels[i]);
}

inline const Facet* MarkerPatch::facetWithinDrawing(const Eigen::Vector2d& position) const {
  const Facet& facet = facets_->at(position);
  const Eigen::Vector2d& core = facet.window.core();
  const double width = pattern_.width();
  const bool is_within = facet.is_visible && (position - core).minCoeff() >= 0.0 &&
                         (position + core).maxCoeff() <= width;
  return is_within ? &facet : nullptr;
}

inline MarkerPixel MarkerPatch::pixelAt(const cv::Mat& panorama, const PixelPosition& place,
                                        const Facet& facet) const {
  const TagPattern::White white = pattern_.averageOver(place.position, facet.window);
  MarkerPixel pixel;
  pixel.column = place.column;
  pixel.row = place.row;
  pixel.grey = panorama.ptr<std::uint8_t>(place.row)[place.column];
  pixel.white = white.share;
  pixel.gradient = (white.by_position.transpose() * facet.by_pixel).norm();
  pixel.position = place.position / pattern_.width() - Eigen::Vector2d(0.5, 0.5);
  pixel.white_by_position = white.by_position;
  pixel.facet = facets_->numberOf(facet);
  return pixel;
}

MarkerPixels MarkerPatch::emptyPixels(std::size_t at_most) const {
  MarkerPixels pixels;
  pixels.pixels.reserve(at_most);
  pixels.grid = facets_;
  return pixels;
}

std::vector<Footprint> MarkerPatch::footprints() const {
  std::vector<Footprint> footprints;
  footprints.reserve(places_.size());
  for (const PixelPosition& place : places_) {
    const Facet* const facet = facetWithinDrawing(place.position);
    if (facet != nullptr) footprints.push_back({place.column, place.row, place.position, facet});
  }
  return footprints;
}

inline Eigen::Vector2d MarkerPatch::changed(const Eigen::Vector2d& position,
                                            const FacetChanges& changes) const {
  if (changes.empty()) return position;
  return position + changes[static_cast<std::size_t>(facets_->numberOf(facets_->at(position)))];
}

MarkerPixels MarkerPatch::pixels(const cv::Mat& panorama, const FacetChanges& changes) const {
  MarkerPixels pixels = emptyPixels(places_.size());
  for (const PixelPosition& place : places_) {
    const Eigen::Vector2d position = changed(place.position, changes);
    const Facet* const facet = facetWithinDrawing(position);
    if (facet == nullptr) continue;
    pixels.pixels.push_back(pixelAt(panorama, {place.column, place.row, position}, *facet));
  }
  return pixels;
}

LinesOfSight MarkerPatch::linesOfSight() const {
  LinesOfSight lines;
  lines.reserve(places_.size());
  for (const PixelPosition& place : places_) {
    lines.push_back(camera_.tabulatedRayInBase({place.column, place.row}));
  }
  return lines;
}

MarkerPixels MarkerPatch::pixels(const cv::Mat& panorama, const LinesOfSight& lines,
                                 const Pose& map_from_base, const ImagingError& error_change,
                                 const FacetChanges& changes) const {
  const DrawingPlane plane(marker_, pattern_, map_from_base);
  const bool has_error = !error_change.isZero(0.0);
  MarkerPixels pixels = emptyPixels(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    auto position = lines[i] ? plane.meet(*lines[i]) : std::nullopt;
    if (position && has_error) {
      *position += facets_->at(*position).by_frame.rightCols<kImagingUnknowns>() * error_change;
    }
    if (position) position = changed(*position, changes);
    const Facet* const facet = position ? facetWithinDrawing(*position) : nullptr;
    if (facet == nullptr) continue;
    pixels.pixels.push_back(
        pixelAt(panorama, {places_[i].column, places_[i].row, *position}, *facet));
  }
  return pixels;
}

}  // namespace omnitag
