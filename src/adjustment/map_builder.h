#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/built_map.h"
#include "localization/frame_readings.h"
#include "marker/map_constraint.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a map is built from a recording, and how well a marker must be known to be included.
struct MapBuilderConfig {
  /// m: size of the markers that the seed does not have. Without a seed it defines the scale of
  /// the map.
  double size = 0.0;
  /// Whether the sizes of those markers are estimated, starting from `size`.
  bool estimates_sizes = false;
  /// Pixels of the panorama, standard deviation of a decoded corner along each axis.
  double corner_noise = 0.1;
  /// Standard deviation of the blur of lens and sensor, in pixels.
  double blur = 0.0;
  /// Pixels, RMS over a marker's corners: up to this, a pose explains the marker while the map
  /// grows and places are not exact yet.
  double max_residual = 3.0;
  /// Whether to look for markers that were moved, have another size, or hang twice: with a wrong
  /// camera, all would seem to.
  bool looks_for_contradictions = true;
  /// Least number of images in which a marker must be read, and least angle between the directions
  /// from which it must be seen (rad).
  int min_sightings = 3;
  double min_parallax = radians(10.0);
  /// Largest standard deviations of a marker's place, in the worst direction, in m and rad.
  double max_position_deviation = 0.03;
  double max_orientation_deviation = radians(2.0);
  /// Least distance between the farthest of the robot's places, in m.
  double min_motion = 0.5;
  /// Least sector that the markers must span, as seen from the robot, in most images, in rad.
  double min_sector = radians(60.0);
  /// How poses are found without a prediction, and the errors of odometry.
  RelocalizationConfig relocalization;
  MotionModelConfig motion;
  /// Measurements between markers. Those of markers that were not seen have no effect.
  std::vector<MapConstraint> constraints;
};

/// The recording does not determine a map: `what()` says why, and what to do.
class DegenerateRecording : public InputError {
 public:
  using InputError::InputError;
};

/// The panorama (CV_8UC1) of a frame, by its index; requested in the order of frames.
using PanoramaSource = std::function<cv::Mat(std::size_t)>;

/// Called as the building goes on: with the name of the step when it begins and, while it counts
/// something, how much of how much is done.
using BuildProgress =
    std::function<void(const std::string& step, std::size_t done, std::size_t total)>;

/// Builds a map from the readings of a recording by bundle adjustment over all poses and markers,
/// with odometry if the images have it.
///
/// The seed's markers define the map's frame; each stays as near to its place as its deviations
/// say. Without a seed, the marker that was read first (the largest, if there were several in one
/// image) defines the frame: its origin is on the floor below the marker's centre, z up, x along
/// the heading of the marker's outward normal or, for one that lies, along the marker's own x axis.
///
/// If the robot is free (`motion.pose_model`), all six degrees of freedom of its poses are
/// estimated, and there must be a seed, which defines which way is up.
///
/// Throws DegenerateRecording if the recording does not determine a map: too little motion, markers
/// on one side only, a single marker, an id at two places, nothing new.
///
/// With `panoramas`, the corners are located in the end by all of their markers' pixels, which
/// makes the map several times more exact.
BuiltMap buildMap(const std::shared_ptr<const CameraModel>& camera,
                  const std::vector<FrameReadings>& frames, const MarkerMap& seed,
                  const MapBuilderConfig& config, const PanoramaSource& panoramas = nullptr,
                  const BuildProgress& progress = {});

}  // namespace omnitag
