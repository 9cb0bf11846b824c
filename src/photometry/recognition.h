#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "camera/mounted_camera.h"
#include "marker/marker_prediction.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/photometry/recognition_config.h"

namespace omnitag {

/// A marker that was found where it was predicted.
struct Recognition {
  /// Pixels of the panorama. All have the same displacement from the prediction if little
  /// displacement was expected.
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  /// Whether the corners were displaced individually.
  bool is_stretched = false;
  /// Correlation of the panorama with the expected data modules, and the least correlation that
  /// rules out another pattern at any noise.
  double correlation = 0.0;
  double threshold = 1.0;
  /// Whether it is the marker: either the correlation is sufficient, or the panorama is
  /// sufficiently likelier to show it than another pattern, each at the noise that it leaves.
  bool is_accepted = false;
};

/// Largest distance from its predicted place, in pixels, at which a marker is recognized.
double largestMargin(const PredictedMarker& predicted, const TagPattern& pattern,
                     const MountedCamera& camera, const RecognitionConfig& config);

/// Tests, without decoding, whether a marker is where it is predicted: its pattern is projected
/// there, moved to where it fits the panorama (CV_8UC1) best, and compared in the modules that
/// distinguish the tags of its family. Needs far fewer pixels than decoding.
///
/// The threshold takes into account how many of these modules the pixels resolve, and how many
/// places were tried. Nothing if the prediction is too vague, or if too little of the marker is in
/// the image or its contrast is too low.
std::optional<Recognition> recognize(const cv::Mat& panorama, const Marker& marker,
                                     const TagPattern& pattern, const MountedCamera& camera,
                                     const Pose& map_from_base, const PredictedMarker& predicted,
                                     const RecognitionConfig& config);

}  // namespace omnitag
