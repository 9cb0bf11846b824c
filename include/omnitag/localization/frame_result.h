#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/image_blur.h"
#include "omnitag/camera/imaging_error.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/image_exposure.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reading.h"
#include "omnitag/marker/predicted_marker.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/disagreement.h"
#include "omnitag/view/view.h"

namespace omnitag {

class MountedCamera;

/// How a frame's pose came about.
enum class Mode {
  kSearching,      ///< no pose
  kTracking,       ///< prediction and markers
  kDeadReckoning,  ///< prediction alone
  kFound,  ///< found by search in this frame, elsewhere than predicted or without prediction
};

/// "searching", "tracking", "dead_reckoning" or "found".
const char* toString(Mode mode);

/// One image and what is known of the robot at its stamp.
struct Frame {
  /// s, on a timeline that runs forward.
  double stamp = 0.0;
  /// CV_8UC1, as large as the camera file says.
  cv::Mat image;
  /// The camera's mounting, optical frame to robot.
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  /// Odometry at the stamp, if the robot has any.
  std::optional<Pose> odom_from_base;
  /// The base's motion by odometry while the image is taken: per second, a PoseVector along and
  /// about its own axes.
  std::optional<PoseVector> velocity = std::nullopt;
  /// Whether to include a view of every predicted marker for people to look at, even of markers
  /// that are recognized without one.
  bool wants_views = false;
  /// Whether to include the pose from this image alone (FrameResult::measured).
  bool wants_measured = false;
  /// Which of the localizer's cameras took the image.
  std::size_t camera = 0;
};

/// A marker that was read or recognized in a frame, accepted or not.
struct MarkerDetection {
  std::string family;
  int id = 0;
  /// The associated map entry; none if no entry fits.
  std::optional<std::size_t> map_entry;
  bool accepted = false;
  /// Why it was rejected; empty for an accepted one.
  std::string reason;
  /// Pixels of the panoramic image.
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// Unit vector along its centre's line of sight in the camera's optical frame; NaN if there is no
  /// line of sight.
  Eigen::Vector3d sight = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// rad, the direction of that line of sight about z of base_link, counter-clockwise from x.
  double bearing = 0.0;
  /// m, horizontal distance from the camera to the map entry, at the frame's pose; NaN if either
  /// is missing.
  double range = 0.0;
  /// Pixels of the panoramic image, RMS over its corners at the frame's pose; NaN without a pose.
  double residual = 0.0;
  /// The same in standard deviations (Misfit).
  double deviations = 0.0;
  /// Number of corrected bits, and by how many grey levels modules are on the right side of the
  /// threshold between black and white, on average; -1 and NaN for a marker that was recognized by
  /// its pattern, not decoded.
  int hamming = -1;
  double margin = std::numeric_limits<double>::quiet_NaN();
};

/// A marker that was read elsewhere than at its place in the map.
struct DisplacedMarker {
  std::size_t map_entry = 0;
  /// m: from its place in the map to where it seems to hang, at the same height.
  double distance = 0.0;
};

/// Markers that seem to have been moved as one.
struct GroupDisplacement {
  std::vector<std::size_t> entries;
  /// m: how far their middle moved in the map.
  Eigen::Vector3d shift;
  /// rad, about the map's z.
  double turn = 0.0;
};

/// A pose that the robot may have, with its probability.
struct WeightedPose {
  PoseEstimate map_from_base;
  double probability = 1.0;
};

/// Wall-clock seconds that the steps of a frame took.
struct Timings {
  double predict = 0.0;
  double recognize = 0.0;
  double warp = 0.0;
  double decode = 0.0;
  double solve = 0.0;
  double total = 0.0;
};

/// The result of a frame.
struct FrameResult {
  double stamp = 0.0;
  Mode mode = Mode::kSearching;
  /// base_link in the map, with the estimated height and lean; none in Mode::kSearching.
  std::optional<PoseEstimate> map_from_base;
  /// The same from this image's markers alone, without the prediction, for filters
  /// (measuredPose()); none if no marker was accepted or it was not asked for.
  std::optional<PoseEstimate> measured;
  /// Whether the robot moves on a floor: its height and lean are then not published.
  bool is_on_floor = true;
  /// The camera as it took the image, and its estimated imaging error.
  std::shared_ptr<const MountedCamera> camera;
  ImagingError imaging_error = ImagingError::Zero();
  /// The blur assumed for the image, and, if the pose was aligned with its pixels, what they say
  /// about it.
  ImageBlur blur;
  std::optional<BlurEquations> blur_equations;
  /// Between the markers that the pose was aligned with.
  Disagreement disagreement;
  /// How many times larger than expected the squared residuals are, at least 1.
  double excess = 1.0;
  ImageExposure exposure = ImageExposure::kGood;
  /// s: how much later images seem to be than their stamps, if that is certain.
  std::optional<double> image_lag;
  /// In words, what is odd about the frame: for example, why it has no pose, or that the robot was
  /// found far from where it should have been. Empty otherwise.
  std::string remark;
  /// In words, what recent images show is wrong with the robot's files and settings, and what to do
  /// about it (Advisor).
  std::vector<std::string> advice;
  /// What the frame was expected to show.
  std::vector<PredictedMarker> predicted;
  /// Map entries that were looked for at their projections and not found.
  std::vector<std::size_t> missed;
  /// Map entries that hang elsewhere than the map says, if the expected pose is right; and whether
  /// this is undecided, because they may be in their places and the expected pose wrong.
  std::vector<std::size_t> elsewhere;
  bool is_open = false;
  /// The views that were looked at, and their images (CV_8UC1, one per view).
  std::vector<View> views;
  std::vector<cv::Mat> view_images;
  std::vector<MarkerDetection> detections;
  std::vector<DisplacedMarker> displaced;
  /// Groups of two or more markers that were moved as one, if no other hypothesis is left.
  std::vector<GroupDisplacement> displaced_groups;
  /// The poses of the hypotheses that have one, the likeliest first. If their probabilities sum to
  /// less than 1, the rest is the probability that none of them is right.
  std::vector<WeightedPose> hypotheses;
  /// All readings while exploring (LocalizerConfig::exploring_views), whether the map has the
  /// marker or not. A marker that was read in both a glance and a view appears twice; the view of a
  /// reading from a glance is not in `views`.
  std::vector<MarkerReading> explored;
  Timings timings;

  /// The pose to publish: on a floor, the pose in its plane (z = roll = pitch = 0), with the
  /// covariance of all six numbers. There must be a pose.
  PoseEstimate publishedPose() const;
  /// The same for `measured`.
  std::optional<PoseEstimate> publishedMeasurement() const;

  /// How many detections the pose is based on.
  int acceptedMarkers() const;
};

}  // namespace omnitag
