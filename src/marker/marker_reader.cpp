#include "marker/marker_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/parallel.h"

namespace omnitag {
namespace {

/// Whether a view cuts a tag, or nearly does: its edges are then not where they seem to be.
bool isCut(const TagDetection& tag, const cv::Size& size) {
  constexpr double kHalfAModule = 0.06;  // in lengths of an edge
  const double margin = kHalfAModule * meanEdge(tag.corners);
  return std::any_of(tag.corners.begin(), tag.corners.end(), [&](const Eigen::Vector2d& corner) {
    return corner.minCoeff() < margin || corner.x() > size.width - 1 - margin ||
           corner.y() > size.height - 1 - margin;
  });
}

}  // namespace

double meanEdge(const Corners<Eigen::Vector2d>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += (corners[(i + 1) % corners.size()] - corners[i]).norm();
  }
  return sum / static_cast<double>(corners.size());
}

MarkerReader::MarkerReader(std::shared_ptr<const CameraModel> camera, double working_distance,
                           const TagDetectorConfig& config, const MarkerFamilies& families,
                           int threads)
    : warper_(std::move(camera), working_distance) {
  detectors_.emplace_back(config, families);
  for (int thread = 1; thread < threads; ++thread) detectors_.emplace_back(config, detector());
}

std::vector<MarkerReading> MarkerReader::read(const cv::Mat& view_image, const View& view) const {
  return read(view_image, view, detector());
}

std::vector<MarkerReading> MarkerReader::read(const std::vector<cv::Mat>& view_images,
                                              const std::vector<View>& views) const {
  std::vector<std::vector<MarkerReading>> of_views(views.size());
  const auto threads = static_cast<int>(detectors_.size());
  forEachIndexByWorker(views.size(), threads, 1, [&](std::size_t worker, std::size_t i) {
    of_views[i] = read(view_images[i], views[i], detectors_[worker]);
  });
  std::vector<MarkerReading> readings;
  for (std::size_t i = 0; i < of_views.size(); ++i) {
    for (MarkerReading& reading : of_views[i]) {
      reading.view = i;
      readings.push_back(std::move(reading));
    }
  }
  return readings;
}

std::vector<MarkerReading> MarkerReader::read(const cv::Mat& view_image, const View& view,
                                              const TagDetector& detector) const {
  std::vector<MarkerReading> readings;
  for (const TagDetection& tag : detector.detect(view_image)) {
    if (isCut(tag, view.size)) continue;
    std::optional<MarkerReading> reading = inPanorama(tag, view, warper_);
    if (reading) readings.push_back(std::move(*reading));
  }
  return readings;
}

std::optional<MarkerReading> inPanorama(const TagDetection& tag, const View& view,
                                        const ViewWarper& warper) {
  MarkerReading reading;
  reading.family = tag.family;
  reading.id = tag.id;
  reading.hamming = tag.hamming;
  reading.margin = tag.decision_margin;
  for (std::size_t k = 0; k < tag.corners.size(); ++k) {
    const auto corner = warper.panoramaFromView(view, tag.corners[k]);
    if (!corner) return std::nullopt;
    reading.corners[k] = *corner;
  }
  const auto center = warper.panoramaFromView(view, tag.center);
  if (!center) return std::nullopt;
  reading.center = *center;
  return reading;
}

bool areOfOneMarker(const MarkerReading& a, const MarkerReading& b) {
  constexpr double kShareOfEdge = 0.25;
  return a.id == b.id && a.family == b.family &&
         (a.center - b.center).norm() < kShareOfEdge * meanEdge(a.corners);
}

std::vector<MarkerReading> withoutRepetitions(const std::vector<MarkerReading>& readings,
                                              const std::vector<View>& views,
                                              const ViewWarper& warper) {
  const auto offMiddle = [&](const MarkerReading& reading) {
    const View& view = views[reading.view];
    const auto position = warper.viewFromPanorama(view, reading.center);
    return position ? std::abs(position->x() - 0.5 * view.size.width)
                    : std::numeric_limits<double>::infinity();
  };
  std::vector<MarkerReading> kept;
  for (const MarkerReading& reading : readings) {
    const auto twin = std::find_if(kept.begin(), kept.end(), [&](const MarkerReading& other) {
      return areOfOneMarker(other, reading);
    });
    if (twin == kept.end()) {
      kept.push_back(reading);
    } else if (offMiddle(reading) < offMiddle(*twin)) {
      *twin = reading;
    }
  }
  return kept;
}

}  // namespace omnitag
