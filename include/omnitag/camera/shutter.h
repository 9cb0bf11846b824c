#pragma once

#include <Eigen/Core>

#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"

namespace omnitag {

/// When the rows of an image are exposed. All 0: all of them at its stamp, for no time.
struct ShutterConfig {
  /// s, from the image's stamp to the middle of the exposure of row 0.
  double image_time_offset = 0.0;
  /// s from a row to the next; negative where the last row is read first.
  double row_readout_time = 0.0;
  /// s for which each row is exposed.
  double exposure_time = 0.0;

  /// s, from the image's stamp to the middle of a row's exposure, and to the beginning of the first
  /// and the end of the last exposure of an image with this many rows.
  double timeOf(double row) const { return image_time_offset + row * row_readout_time; }
  double begin(int rows) const;
  double end(int rows) const;

  bool isInstant() const {
    return image_time_offset == 0.0 && row_readout_time == 0.0 && exposure_time == 0.0;
  }
};

/// Reads the keys above; absent ones keep their defaults. Other keys are not looked at. Throws
/// InputError.
ShutterConfig readShutterConfig(const YamlReader& reader);

/// How the base moves while an image is taken, and how well that is known.
struct BaseMotion {
  /// Per second, along and about the axes of base_link; in a PoseVector's order.
  PoseVector velocity = PoseVector::Zero();
  /// m/s and rad/s: standard deviations of what the image itself may tell better, the velocity
  /// along x and y and the rate of yaw.
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();

  /// base_link at the stamp, from where it is this many seconds later.
  Eigen::Isometry3d after(double time) const;
};

/// The velocity, as in BaseMotion, that makes a motion in this many seconds.
PoseVector velocityOf(const Eigen::Isometry3d& motion, double duration);

}  // namespace omnitag
