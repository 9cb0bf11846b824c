#pragma once

#include <cv_bridge/cv_bridge.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/ros/parameters.h"

namespace omnitag {

/// tf has no transform at the stamp of an image, or not yet.
class TransformError : public InputError {
 public:
  using InputError::InputError;
};

/// A frame of the core together with the messages that it was made from.
struct AssembledFrame {
  std_msgs::Header header;
  /// Shares its pixels with `image`.
  Frame frame;
  cv_bridge::CvImageConstPtr image;
  /// Odometry in space; frame.odom_from_base is its share on the floor. None without odometry.
  std::optional<Eigen::Isometry3d> odom_from_base;
  /// Why there is no odometry although the robot should have it; empty otherwise.
  std::string odometry_problem;
};

/// Puts a frame together from an image and the transforms at its stamp, for the nodelet as for
/// localize_bag.
class FrameAssembler {
 public:
  /// Images must be as large as the camera file says.
  FrameAssembler(std::string camera_origin, const ImageSize& image_size, FrameNames frames,
                 const ShutterConfig& shutter = {});

  void setShutter(const ShutterConfig& shutter) { shutter_ = shutter; }

  /// Throws InputError for an image of another size or without a stamp or frame_id.
  void check(const cv_bridge::CvImage& image) const;

  /// Whether tf has all that `assemble` looks up for such an image: odometry until the last row is
  /// exposed.
  bool hasTransforms(const std_msgs::Header& header, const tf2::BufferCore& transforms) const;

  /// Throws what `check` throws, and TransformError where the camera's mounting is not known at the
  /// stamp. A frame without its odometry is still a frame. Where odometry ends before the last row
  /// is exposed, the base is taken to go on as it did before.
  AssembledFrame assemble(const cv_bridge::CvImageConstPtr& image,
                          const tf2::BufferCore& transforms) const;

 private:
  /// s after the stamp of an image.
  struct Interval {
    double begin;
    double end;
  };
  /// In which the rows are exposed, made long enough for odometry to tell a velocity.
  Interval exposedInterval() const;
  std::optional<PoseVector> velocity(const ros::Time& stamp,
                                     const tf2::BufferCore& transforms) const;

  std::string camera_origin_;
  ImageSize image_size_;
  FrameNames frames_;
  ShutterConfig shutter_;
};

}  // namespace omnitag
