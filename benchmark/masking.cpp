#include "masking.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// The marker and its white border.
void paintOver(const PredictedMarker& marker, cv::Mat* image) {
  constexpr double kWithBorder = 1.5;
  constexpr int kGrey = 120;
  std::vector<cv::Point> outline;
  for (const Eigen::Vector2d& corner : marker.corners) {
    const Eigen::Vector2d point = marker.center + kWithBorder * (corner - marker.center);
    outline.emplace_back(cvRound(point.x()), cvRound(point.y()));
  }
  cv::fillConvexPoly(*image, outline, kGrey);
}

bool contains(const std::vector<std::size_t>& indices, std::size_t index) {
  return std::find(indices.begin(), indices.end(), index) != indices.end();
}

}  // namespace

FrameResult lookAtTruth(const RecordedSequence& sequence, std::size_t frame,
                        const LocalizerConfig& config) {
  Localizer localizer(sequence.camera, sequence.map, config);
  localizer.setPose(sequence.truth[frame]);
  return localizer.process(sequence.frames[frame]);
}

std::vector<std::size_t> readableMarkers(const FrameResult& seen) {
  std::vector<std::size_t> readable;
  for (std::size_t i = 0; i < seen.predicted.size(); ++i) {
    const bool is_read =
        std::any_of(seen.detections.begin(), seen.detections.end(), [&](const auto& detection) {
          return detection.accepted && detection.map_entry == seen.predicted[i].map_entry;
        });
    if (is_read) readable.push_back(i);
  }
  return readable;
}

cv::Mat withOnly(const std::vector<std::size_t>& chosen, const FrameResult& seen,
                 const cv::Mat& image) {
  cv::Mat masked = image.clone();
  for (std::size_t i = 0; i < seen.predicted.size(); ++i) {
    if (!contains(chosen, i)) paintOver(seen.predicted[i], &masked);
  }
  return masked;
}

}  // namespace omnitag
