#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

namespace omnitag::test {

/// An extended Kalman filter of a robot on a floor, from the textbook and independent of the
/// package's own code: (x, y, yaw) in the map, moved by odometry's increments in the robot's own
/// axes, corrected by poses that are assumed independent.
class PlanarFilter {
 public:
  PlanarFilter(const Eigen::Vector3d& state, const Eigen::Matrix3d& covariance)
      : state_(state), covariance_(covariance) {}

  void predict(const Eigen::Vector3d& motion, const Eigen::Vector3d& deviations) {
    const double c = std::cos(state_.z());
    const double s = std::sin(state_.z());
    Eigen::Matrix3d by_state = Eigen::Matrix3d::Identity();
    by_state(0, 2) = -s * motion.x() - c * motion.y();
    by_state(1, 2) = c * motion.x() - s * motion.y();
    Eigen::Matrix3d by_motion;
    by_motion << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    state_ += by_motion * motion;
    const Eigen::Matrix3d noise = deviations.cwiseAbs2().asDiagonal();
    covariance_ =
        by_state * covariance_ * by_state.transpose() + by_motion * noise * by_motion.transpose();
  }

  void correct(const Eigen::Vector3d& pose, const Eigen::Matrix3d& covariance) {
    const Eigen::Matrix3d innovation = covariance_ + covariance;
    const Eigen::Matrix3d gain = innovation.ldlt().solve(covariance_).transpose();
    state_ += gain * apart(pose, state_);
    const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - gain;
    covariance_ = rest * covariance_ * rest.transpose() + gain * covariance * gain.transpose();
  }

  /// Normalised estimation error squared.
  double nees(const Eigen::Vector3d& truth) const {
    const Eigen::Vector3d error = apart(truth, state_);
    return error.dot(covariance_.ldlt().solve(error));
  }

 private:
  static Eigen::Vector3d apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    Eigen::Vector3d difference = a - b;
    difference.z() = std::remainder(difference.z(), 2.0 * std::acos(-1.0));
    return difference;
  }

  Eigen::Vector3d state_;
  Eigen::Matrix3d covariance_;
};

}  // namespace omnitag::test
