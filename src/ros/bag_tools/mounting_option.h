#pragma once

#include <Eigen/Geometry>
#include <string>

namespace omnitag {

/// A mounting as an option: X,Y,Z,ROLL,PITCH,YAW in metres and radians, with tf's angles, or
/// X,Y,Z,QX,QY,QZ,QW, the camera's optical frame in the robot's (base_from_camera). Throws
/// InputError that names the option.
Eigen::Isometry3d parseMounting(const std::string& option, const std::string& text);

/// The text of a mounting for that option, to a micrometre and a microradian.
std::string mountingText(const Eigen::Isometry3d& base_from_camera);

/// The mounting as tf2_ros's static_transform_publisher takes it: x y z yaw pitch roll.
std::string publisherArguments(const Eigen::Isometry3d& base_from_camera);

}  // namespace omnitag
