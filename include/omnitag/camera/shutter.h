#pragma once

#include <Eigen/Core>

#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"

namespace omnitag {

/// When the rows of an image are exposed. If all values are 0, all rows are exposed at the image's
/// stamp, for no time.
struct ShutterConfig {
  /// s, from the image's stamp to the middle of the exposure of row 0.
  double image_time_offset = 0.0;
  /// s from one row to the next; negative if the last row is read first.
  double row_readout_time = 0.0;
  /// s for which each row is exposed.
  double exposure_time = 0.0;

  /// s from the image's stamp: to the middle of a row's exposure; and, in an image with this many
  /// rows, to the beginning of the first exposure and to the end of the last one.
  double timeOf(double row) const { return image_time_offset + row * row_readout_time; }
  double begin(int rows) const;
  double end(int rows) const;

  bool isInstant() const {
    return image_time_offset == 0.0 && row_readout_time == 0.0 && exposure_time == 0.0;
  }
};

/// Reads the keys above; absent ones stay as in `defaults`. Other keys are ignored.
/// Throws InputError.
ShutterConfig readShutterConfig(const YamlReader& reader, const ShutterConfig& defaults = {});

/// How the base moves while an image is taken, and how well that is known.
struct BaseMotion {
  /// Per second, along and about the axes of base_link; in a PoseVector's order.
  PoseVector velocity = PoseVector::Zero();
  /// m/s and rad/s: standard deviations of the velocity along x and y and of the yaw rate, which
  /// the image itself may determine better.
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();

  /// The pose of base_link after this many seconds, in base_link at the stamp.
  Eigen::Isometry3d after(double time) const;
};

/// The velocity, as in BaseMotion, of a motion that takes this many seconds.
PoseVector velocityOf(const Eigen::Isometry3d& motion, double duration);

}  // namespace omnitag
