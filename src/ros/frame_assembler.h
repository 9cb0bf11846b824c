#pragma once

#include <cv_bridge/cv_bridge.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "ros/parameters.h"

namespace omnitag {

/// tf has no transform at the stamp of an image, perhaps not yet.
class TransformError : public InputError {
 public:
  using InputError::InputError;
};

/// A frame of the core together with the messages that it is made from.
struct AssembledFrame {
  std_msgs::Header header;
  /// Shares its pixels with `image`.
  Frame frame;
  cv_bridge::CvImageConstPtr image;
  /// Odometry; frame.odom_from_base is the same as a Pose. None without odometry.
  std::optional<Eigen::Isometry3d> odom_from_base;
  /// Why odometry is missing although the robot should have it; empty otherwise.
  std::string odometry_problem;
};

/// Assembles a frame from an image and the transforms at its stamp, for the nodelet and for the
/// tools that read bags.
class FrameAssembler {
 public:
  /// Images must have `image_size`. `camera_origin` names the camera in errors.
  FrameAssembler(std::string camera_origin, const ImageSize& image_size, FrameNames frames,
                 const ShutterConfig& shutter = {});

  void setShutter(const ShutterConfig& shutter) { shutter_ = shutter; }

  /// Throws InputError for an image of another size or without a stamp or frame_id.
  void check(const cv_bridge::CvImage& image) const;

  /// Whether tf has everything that assemble() looks up for such an image: odometry until the last
  /// row is exposed.
  bool hasTransforms(const std_msgs::Header& header, const tf2::BufferCore& transforms) const;

  /// Throws what check() throws, and TransformError if the mounting is not known at the stamp.
  /// Missing odometry is not an error. If odometry ends before the last row is exposed, the base is
  /// assumed to move on as before.
  AssembledFrame assemble(const cv_bridge::CvImageConstPtr& image,
                          const tf2::BufferCore& transforms) const;

 private:
  /// s after the stamp of an image.
  struct Interval {
    double begin;
    double end;
  };
  /// When the rows are exposed, extended if needed to determine a velocity from odometry.
  Interval exposedInterval() const;
  std::optional<PoseVector> velocity(const ros::Time& stamp,
                                     const tf2::BufferCore& transforms) const;

  std::string camera_origin_;
  ImageSize image_size_;
  FrameNames frames_;
  ShutterConfig shutter_;
};

}  // namespace omnitag
