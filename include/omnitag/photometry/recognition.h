#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_prediction.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// How markers are recognized where they are predicted.
struct RecognitionConfig {
  /// Lengths of a module, as wide as the lens's blur makes it: a marker that may be farther from
  /// its predicted place is looked for with the decoder.
  double max_margin = 9.0;
  /// How often, at most, something else may be taken for the marker that is predicted there.
  double false_accept_rate = 1e-5;
  /// Grey levels between black and white, the least that counts.
  double min_contrast = 8.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
RecognitionConfig readRecognitionConfig(const YamlReader& reader);

/// A marker that was found where it was predicted.
struct Recognition {
  /// Pixels of the panorama. All of them are displaced alike where little displacement was to be
  /// expected.
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  /// Whether they were displaced each for itself.
  bool is_stretched = false;
  /// Correlation of what its data modules should look like with the panorama, and what it has to
  /// be at least to be no other pattern, whatever the noise.
  double correlation = 0.0;
  double threshold = 1.0;
  /// Whether it is the marker: by that, or since the panorama is that much likelier to show it than
  /// another pattern, at the noise that either leaves.
  bool is_accepted = false;
};

/// The correlation that a random pattern, which varies in `dimensions` independent ways, reaches
/// with a given one in no more than `rate` of all cases: the share that the cap of half-angle
/// acos(t) has of the sphere in n dimensions is at most (1 - t^2)^((n - 1) / 2) / 2.
double correlationThreshold(double dimensions, double rate);

/// Pixels that a marker may be from its predicted place, at most, to be recognized.
double largestMargin(const PredictedMarker& predicted, const TagPattern& pattern,
                     const MountedCamera& camera, const RecognitionConfig& config);

/// Whether a marker is where it is predicted, without decoding: its pattern is laid where it should
/// image, moved until it fits the panorama best (CV_8UC1), and compared in the modules that tell
/// the tags of its family apart. Needs far fewer pixels than decoding does.
///
/// The threshold takes into account how many of these modules the pixels can tell apart, and how
/// many places were tried. Nothing where the prediction is too vague, or too little of the marker
/// is in the image or too pale.
std::optional<Recognition> recognize(const cv::Mat& panorama, const Marker& marker,
                                     const TagPattern& pattern, const MountedCamera& camera,
                                     const Pose& map_from_base, const PredictedMarker& predicted,
                                     const RecognitionConfig& config);

}  // namespace omnitag
