#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/map_constraint.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a map is built from a recording, and when a marker is known well enough to be in it.
struct MapBuilderConfig {
  /// Of the markers that the seed does not have. Without a seed this is the scale of the map.
  double size = 0.0;
  /// Whether the sizes of those markers are estimated, `size` being a first guess.
  bool estimates_sizes = false;
  /// Pixels of the panorama, standard deviation of a decoded corner along each axis.
  double corner_noise = 0.1;
  /// Pixels: what lens and sensor blur, as in PhotometricConfig.
  double blur = 0.0;
  /// Pixels, RMS over a marker's corners up to which a pose explains it while the map grows: places
  /// are not exact yet.
  double max_residual = 3.0;
  /// Whether markers that were moved, are of another size, or hang twice are looked for: with a
  /// camera that is wrong all seem to be.
  bool looks_for_contradictions = true;
  /// Images in which a marker is read, at least, and the angle between the directions it is seen
  /// from (rad).
  int min_sightings = 3;
  double min_parallax = radians(10.0);
  /// m and rad: standard deviations of a marker's place, in the direction in which they are
  /// largest.
  double max_position_deviation = 0.03;
  double max_orientation_deviation = radians(2.0);
  /// m: the robot's places must be this far apart at least.
  double min_motion = 0.5;
  /// rad: the sector, as seen from the robot, that the markers of most images must exceed.
  double min_sector = radians(60.0);
  /// How poses are found without a prediction, and what odometry errs by.
  RelocalizationConfig relocalization;
  MotionModelConfig motion;
  /// What was measured between markers. Those of markers that nobody saw say nothing.
  std::vector<MapConstraint> constraints;
};

/// A recording that no map can be built from: `what()` says why, and what to do.
class DegenerateRecording : public InputError {
 public:
  using InputError::InputError;
};

/// A marker of the map that was built.
struct BuiltMarker {
  Marker marker;
  /// Whether the seed has it, and then whether it says exactly where: its place was not touched.
  bool is_seed = false;
  bool is_exact = false;
  /// Of a MarkerIncrement, in m^2, m rad and rad^2; of the size (m^2), 0 where it is not estimated.
  /// Relative to the markers whose place is exactly known; where there are none, within the map:
  /// once that has been laid on the truth.
  MarkerCovariance covariance = MarkerCovariance::Zero();
  double size_variance = 0.0;
  /// Images in which it was read and agrees, and pixels, RMS over their corners.
  std::size_t sightings = 0;
  double residual = 0.0;
};

/// One image's reading of a marker that the map explains badly.
struct WorstReading {
  double stamp = 0.0;
  std::string marker;
  /// Pixels, RMS over its corners.
  double residual = 0.0;
};

struct BuiltMap {
  /// The seed's markers in their order, then the new ones by id.
  std::vector<BuiltMarker> markers;
  /// What a user should know, a line each: markers that moved or are left out, and why.
  std::vector<std::string> remarks;
  /// Largest residuals first; ten at most.
  std::vector<WorstReading> worst;
  /// The robot's poses, for those images that have one.
  std::vector<double> stamps;
  std::vector<Pose> trajectory;
  std::size_t images = 0;
  /// Without a seed, the marker that the map's frame stands on, by its index.
  std::optional<std::size_t> reference;

  MarkerMap map(const std::string& frame_id) const;
};

/// The panorama (CV_8UC1) of a frame, by its index; asked for in the order of frames.
using PanoramaSource = std::function<cv::Mat(std::size_t)>;

/// Builds a map from what was read in the images of a recording, by bundle adjustment over all
/// poses and markers, with odometry where the images have it.
///
/// The seed's markers are the map's frame; each stays as near to where it is as its deviations say.
/// Without a seed that frame stands
/// on the marker that was read first (of several in one image the largest): its origin is on the
/// floor below the marker's centre, z up, x along the heading of the marker's outward normal or,
/// for one that lies, along the marker's own x axis.
///
/// Where the robot is free (`motion.pose_model`) all six numbers of its poses are estimated, and a
/// seed must say which way is up.
///
/// Throws DegenerateRecording where the recording does not tell a map: too little motion, markers
/// on one side only, a single marker, an id at two places, nothing new.
///
/// With `panoramas` the corners that were read are, in the end, placed by all of their markers'
/// pixels, which makes the map several times more exact.
BuiltMap buildMap(const std::shared_ptr<const CameraModel>& camera,
                  const std::vector<FrameReadings>& frames, const MarkerMap& seed,
                  const MapBuilderConfig& config, const PanoramaSource& panoramas = nullptr);

}  // namespace omnitag
