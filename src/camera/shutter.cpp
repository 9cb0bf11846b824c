#include "camera/shutter.h"

#include <algorithm>

#include "common/rotation.h"
#include "common/yaml_reader.h"

namespace omnitag {

double ShutterConfig::begin(int rows) const {
  return std::min(timeOf(0), timeOf(rows - 1)) - 0.5 * exposure_time;
}

double ShutterConfig::end(int rows) const {
  return std::max(timeOf(0), timeOf(rows - 1)) + 0.5 * exposure_time;
}

ShutterConfig readShutterConfig(const YamlReader& reader, const ShutterConfig& defaults) {
  constexpr double kLongest = 1.0;  // s
  ShutterConfig config = defaults;
  reader.read("image_time_offset", &config.image_time_offset, {-kLongest, kLongest});
  reader.read("row_readout_time", &config.row_readout_time, {-1e-3, 1e-3});
  reader.read("exposure_time", &config.exposure_time, {0.0, kLongest});
  return config;
}

Eigen::Isometry3d BaseMotion::after(double time) const {
  const Eigen::Vector3d turn = time * rotationPart(velocity);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = rotationOf(turn);
  // Along an arc, approximately: in the direction of its middle.
  motion.translation() = rotationOf(0.5 * turn) * (time * translationPart(velocity));
  return motion;
}

PoseVector velocityOf(const Eigen::Isometry3d& motion, double duration) {
  const Eigen::AngleAxisd rotation(motion.linear());
  const Eigen::Vector3d turn = rotation.angle() * rotation.axis();
  return poseVector(rotationOf(-0.5 * turn) * motion.translation(), turn) / duration;
}

}  // namespace omnitag
