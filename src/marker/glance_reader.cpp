#include "marker/glance_reader.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "common/parallel.h"
#include "common/symmetric_matrix.h"
#include "marker/corner_refinement.h"
#include "marker/marker_prediction.h"
#include "omnitag/common/angle.h"
#include "view/view_planner.h"

namespace omnitag {
namespace {

/// Least contrast between white and black of markers that stand out, in standard deviations of the
/// grey levels.
constexpr double kObvious = 2.0;

/// Pixels, the image's smaller side after the reduction for the first glance.
constexpr int kFirstSize = 500;

/// A part of the panorama, in which writing runs in the right direction.
struct Excerpt {
  cv::Mat image;
  /// The place of its first pixel in the panorama.
  cv::Point corner;
  bool is_mirrored = false;
  /// Standard deviation of its grey levels.
  double spread = 0.0;

  Eigen::Vector2d inPanorama(const Eigen::Vector2d& pixel) const {
    const double column = is_mirrored ? image.cols - 1.0 - pixel.x() : pixel.x();
    return {corner.x + column, corner.y + pixel.y()};
  }
};

/// Pixels, to about one, along an arc of the ideal image plane that begins at the azimuth `first`
/// and turns by `sweep` (rad).
std::vector<cv::Point> arc(const ImagePlane& plane, double radius, double first, double sweep) {
  constexpr double kPointsPerTurn = 128.0;
  const int steps = static_cast<int>(std::ceil(kPointsPerTurn * std::abs(sweep) / (2.0 * kPi)));
  std::vector<cv::Point> points;
  for (int i = 0; i <= steps; ++i) {
    const double azimuth = first + sweep * i / steps;
    const Eigen::Vector2d pixel =
        plane.pixelFromIdeal(radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
    points.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
  }
  return points;
}

/// The borders, to about a pixel, of an annulus or its sector, wider by a margin (pixels).
std::vector<std::vector<cv::Point>> outlinesOf(const Annulus& annulus, const Sector& sector,
                                               double margin, const CameraModel& camera) {
  const ImagePlane& plane = camera.imagePlane();
  const double inner = annulus.min_radius - margin / plane.scale();
  const double outer = std::min(annulus.max_radius, camera.maxRadius()) + margin / plane.scale();
  const double first = sector.azimuth - sector.half_width;
  const double sweep = 2.0 * sector.half_width;
  std::vector<std::vector<cv::Point>> outlines{arc(plane, outer, first, sweep)};
  if (sector.half_width < kPi) {
    const auto back = arc(plane, std::max(0.0, inner), first + sweep, -sweep);
    outlines.front().insert(outlines.front().end(), back.begin(), back.end());
  } else if (inner > 0.0) {
    outlines.push_back(arc(plane, inner, first, sweep));
  }
  return outlines;
}

/// The part of a panorama where a glance should look, filled elsewhere with a uniform grey, on
/// which the library spends no time. An empty image if the panorama shows nothing there.
Excerpt excerptOf(const cv::Mat& panorama, const CameraModel& camera, const GlanceAim& aim,
                  bool is_mirrored) {
  constexpr double kMargin = 8.0;  // pixels
  std::vector<std::vector<cv::Point>> outlines = outlinesOf(aim.where, aim.toward, kMargin, camera);
  const cv::Rect box = cv::boundingRect(outlines.front()) & cv::Rect({}, panorama.size());
  if (box.empty()) return {};
  Excerpt excerpt{panorama(box).clone(), box.tl(), is_mirrored};
  cv::Scalar grey;
  cv::Scalar spread;
  cv::meanStdDev(excerpt.image, grey, spread);
  excerpt.spread = spread[0];
  // Fills whatever is inside an odd number of outlines.
  outlines.push_back({box.tl(), {box.br().x, box.y}, box.br(), {box.x, box.br().y}});
  cv::fillPoly(excerpt.image, outlines, grey, cv::LINE_8, 0, -box.tl());
  if (is_mirrored) cv::flip(excerpt.image, excerpt.image, 1);
  return excerpt;
}

/// A view of a tag that has about these corners in the panorama.
View viewOf(const Corners<Eigen::Vector2d>& corners, const Eigen::Vector2d& center,
            const CameraModel& camera, const ViewWarper& warper, bool axis_up) {
  PredictedMarker marker;
  marker.corners = corners;
  marker.center = center;
  marker.range = warper.table().distance();
  constexpr double kMargin = 3.0;  // pixels
  marker.tangential_margin = marker.radial_margin = kMargin;
  return planView(viewTarget(marker, camera), warper.table(), camera.imagePlane().scale(), axis_up,
                  ViewPlannerConfig{});
}

/// The corners in a view where the edges between corners of the panorama meet. The straight edges
/// that a glance finds run through the middle of bent ones. The corners of a large marker are
/// therefore off by more than a refinement reaches, but its edges as a whole are not. Nothing if a
/// point is outside what the view can show.
std::optional<Corners<Eigen::Vector2d>> cornersInView(const Corners<Eigen::Vector2d>& corners,
                                                      const View& view, const ViewWarper& warper) {
  using Line = Eigen::Hyperplane<double, 2>;
  std::array<Line, 4> edges;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    constexpr int kPlaces = 9;
    Eigen::Matrix<double, 2, kPlaces> places;
    for (int i = 0; i < kPlaces; ++i) {
      const double along = (i + 0.5) / kPlaces;
      const auto place = warper.viewFromPanorama(
          view, (1.0 - along) * corners[k] + along * corners[(k + 1) % corners.size()]);
      if (!place) return std::nullopt;
      places.col(i) = *place;
    }
    const Eigen::Vector2d middle = places.rowwise().mean();
    const Eigen::Matrix<double, 2, kPlaces> off = places.colwise() - middle;
    const EigenPairs spread = eigenPairs(off * off.transpose());
    edges[k] = Line(spread.vectors.col(0), middle);
  }
  Corners<Eigen::Vector2d> in_view;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    in_view[k] = edges[(k + 3) % edges.size()].intersection(edges[k]);
  }
  return in_view;
}

/// Locates a tag, known to about a pixel of the panorama, by its edges in a view. Nothing if one of
/// its corners is outside what the view shows.
std::optional<TagDetection> findAgain(TagDetection tag, const View& view, const cv::Mat& view_image,
                                      const ViewWarper& warper) {
  const auto start = cornersInView(tag.corners, view, warper);
  if (!start) return std::nullopt;
  tag.corners = *start;
  // Edges of a large marker may have been bent by more than one refinement reaches.
  constexpr int kMaxRefinements = 4;
  constexpr double kSettled = 0.1;  // pixels
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Corners<Eigen::Vector2d> before = tag.corners;
    tag.corners = refineCorners(view_image, before, tag.modules_per_edge);
    double change = 0.0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      change = std::max(change, (tag.corners[k] - before[k]).norm());
    }
    if (change < kSettled) break;
  }
  tag.center = centerOf(tag.corners);
  return tag;
}

void keepLargest(std::size_t count, std::vector<TagDetection>* tags) {
  if (tags->size() <= count) return;
  const auto end = tags->begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(tags->begin(), end, tags->end(),
                   [](const TagDetection& a, const TagDetection& b) {
                     return meanEdge(a.corners) > meanEdge(b.corners);
                   });
  tags->erase(end, tags->end());
}

}  // namespace

bool isMirrored(const CameraModel& camera) {
  const auto ray = camera.rayFromRadius(0.5 * (camera.minRadius() + camera.maxRadius()));
  if (!ray) return false;
  constexpr double kDistance = 3.0;  // m
  const Eigen::Vector2d point = ray->origin + kDistance * ray->direction;
  const Eigen::Vector3d outward = Eigen::Vector3d(ray->direction.x(), 0.0, ray->direction.y());
  // To the right and down for the viewer of an ordinary image.
  const Eigen::Vector3d right = outward.unitOrthogonal();
  const Eigen::Vector3d down = outward.cross(right);
  Eigen::Matrix<double, 2, 3> pixel_by_point;
  if (!camera.pixelBeyondImage({point.x(), 0.0, point.y()}, &pixel_by_point)) return false;
  Eigen::Matrix2d pixel_by_offset;
  pixel_by_offset << pixel_by_point * right, pixel_by_point * down;
  return pixel_by_offset.determinant() < 0.0;
}

GlanceReader::GlanceReader(std::shared_ptr<const CameraModel> camera,
                           const TagDetectorConfig& config, const TagDetector& detector,
                           int threads)
    : camera_(std::move(camera)), is_mirrored_(isMirrored(*camera_)), threads_(threads) {
  const ImageSize& size = camera_->imageSize();
  double coarser = std::numeric_limits<double>::infinity();
  for (int reduction = std::max(1, std::min(size.width, size.height) / kFirstSize); reduction >= 1;
       reduction /= 2) {
    TagDetectorConfig reduced = config;
    // The library accepts 1, 1.5 and whole numbers.
    if (reduction > 1) {
      reduced.quad_decimate = std::min(8.0, std::round(config.quad_decimate * reduction));
    }
    // Beyond the library's largest reduction, a second detector would be the same.
    if (reduced.quad_decimate < coarser) detectors_.emplace_back(reduced, detector);
    coarser = reduced.quad_decimate;
  }
}

Glance GlanceReader::read(const cv::Mat& panorama, std::size_t glance, const ViewWarper& warper,
                          bool axis_up, const GlanceAim& aim) const {
  const Excerpt excerpt = excerptOf(panorama, *camera_, aim, is_mirrored_);
  const bool is_for_the_obvious = aim.starts_with_the_obvious && glance == 0;
  const int min_contrast = is_for_the_obvious ? cvRound(kObvious * excerpt.spread) : 0;
  std::vector<TagDetection> tags = detectors_[glance].detect(excerpt.image, min_contrast);
  keepLargest(aim.at_most, &tags);
  struct Look {
    View view;
    cv::Mat image;
    std::optional<MarkerReading> reading;
  };
  std::vector<Look> looks(tags.size());
  forEachIndex(tags.size(), threads_, 1, [&](std::size_t i) {
    TagDetection tag = tags[i];
    for (Eigen::Vector2d& corner : tag.corners) corner = excerpt.inPanorama(corner);
    Look& look = looks[i];
    look.view = viewOf(tag.corners, excerpt.inPanorama(tag.center), *camera_, warper, axis_up);
    look.image = warper.warp(panorama, look.view);
    const auto again = findAgain(std::move(tag), look.view, look.image, warper);
    if (again) look.reading = inPanorama(*again, look.view, warper);
    look.view.targets.clear();
  });
  Glance seen;
  for (Look& look : looks) {
    if (!look.reading) continue;
    look.reading->view = seen.views.size();
    seen.views.push_back(std::move(look.view));
    seen.view_images.push_back(std::move(look.image));
    seen.readings.push_back(std::move(*look.reading));
  }
  return seen;
}

}  // namespace omnitag
