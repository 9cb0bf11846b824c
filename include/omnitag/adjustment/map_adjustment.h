#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What of a marker's place is known beforehand and stays.
enum class Hold {
  kNothing,
  kOnFloor,  ///< x, y and the heading: the marker says where the map is
  kAll,
};

/// A recording as one least squares problem. Frames and markers are named by their indices.
struct Bundle {
  struct Frame {
    MountedCamera camera;
    Pose map_from_base;
    bool is_held = false;
  };
  struct Landmark {
    Marker marker;
    Hold hold = Hold::kNothing;
  };
  struct Observation {
    std::size_t frame = 0;
    std::size_t landmark = 0;
    CornerPixels pixels;
    /// W with W^T W = covariance^-1, per pixel: makes residuals of variance 1 that are independent.
    Eigen::Matrix<double, 8, 8> whitening;
  };
  /// The robot's motion as odometry has it, in base_link of the first frame, and the standard
  /// deviations of its x, y (m) and yaw (rad); where the robot is free, also of z, and of roll and
  /// pitch.
  struct Motion {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose from_from_to;
    Eigen::Vector3d deviations;
  };

  std::vector<Frame> frames;
  std::vector<Landmark> landmarks;
  std::vector<Observation> observations;
  std::vector<Motion> motions;
};

struct BundleConfig {
  /// Whether the sizes of the markers that are not held are estimated, too.
  bool estimates_sizes = false;
  /// Whether the robot's height, roll and pitch are estimated, too; as they are otherwise.
  bool is_free = false;
};

/// Moves the frames and the landmarks to where they explain all observations and motions best:
/// least squares (Ceres, Levenberg-Marquardt on sparse normal equations), each observation of a
/// marker weighed down where it is far off. Observations that the present
/// estimate hides are left out. False where the solver fails; what it has then is kept.
bool adjust(Bundle* bundle, const BundleConfig& config);

/// For each landmark the covariance of its MarkerIncrement at the estimate, zero for one that is
/// held, and, where they are estimated, the variance of its size. Nothing where the problem leaves
/// something undetermined.
struct BundleCovariances {
  std::vector<MarkerCovariance> landmarks;
  std::vector<double> sizes;
};
std::optional<BundleCovariances> covariances(const Bundle& bundle, const BundleConfig& config);

/// How far an observation is off.
struct ReadingMisfit {
  /// Pixels, RMS over its corners; infinity where the estimate hides one.
  double pixels = 0.0;
  /// Chi-square with 8 degrees of freedom, if the noise is as the observation says.
  double square = 0.0;
};
std::vector<ReadingMisfit> misfits(const Bundle& bundle);

}  // namespace omnitag
