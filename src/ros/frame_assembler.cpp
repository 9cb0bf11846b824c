#include "ros/frame_assembler.h"

#include <tf2/exceptions.h>

#include <algorithm>
#include <utility>

#include "ros/conversions.h"

namespace omnitag {
namespace {

std::string describe(const ImageSize& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " pixels";
}

Eigen::Isometry3d lookUp(const tf2::BufferCore& transforms, const std::string& target,
                         const std::string& source, const ros::Time& stamp) {
  try {
    return fromMessage(transforms.lookupTransform(target, source, stamp).transform);
  } catch (const tf2::TransformException& error) {
    throw TransformError("no transform from '" + source + "' to '" + target +
                         "' at the image's stamp: " + error.what());
  }
}

/// Nothing if ros::Time cannot hold it.
std::optional<ros::Time> later(const ros::Time& stamp, double seconds) {
  const double time = stamp.toSec() + seconds;
  if (!(time > 0.0 && time < kTimesEnd)) return std::nullopt;
  return stamp + ros::Duration(seconds);
}

}  // namespace

FrameAssembler::FrameAssembler(std::string camera_origin, const ImageSize& image_size,
                               FrameNames frames, const ShutterConfig& shutter)
    : camera_origin_(std::move(camera_origin)),
      image_size_(image_size),
      frames_(std::move(frames)),
      shutter_(shutter) {}

void FrameAssembler::check(const cv_bridge::CvImage& image) const {
  if (image.header.stamp.isZero()) throw InputError("the image's header.stamp is zero");
  if (image.header.frame_id.empty()) {
    throw InputError("the image's header.frame_id is empty; expected the camera's optical frame");
  }
  const ImageSize size{image.image.cols, image.image.rows};
  if (size.width != image_size_.width || size.height != image_size_.height) {
    throw InputError("the image has " + describe(size) + ", expected " + describe(image_size_) +
                     " as " + camera_origin_ + " says");
  }
}

bool FrameAssembler::hasTransforms(const std_msgs::Header& header,
                                   const tf2::BufferCore& transforms) const {
  if (!transforms.canTransform(frames_.base, header.frame_id, header.stamp)) return false;
  const auto hasOdometry = [&](double after) {
    const std::optional<ros::Time> stamp = later(header.stamp, after);
    return stamp && transforms.canTransform(frames_.odom, frames_.base, *stamp);
  };
  return frames_.odom.empty() ||
         (hasOdometry(0.0) && (shutter_.isInstant() || hasOdometry(exposedInterval().end)));
}

FrameAssembler::Interval FrameAssembler::exposedInterval() const {
  // Odometry comes at 20 to 100 Hz: over a shorter time, it would only show its noise.
  constexpr double kShortest = 0.02;
  const double begin = shutter_.begin(image_size_.height);
  const double end = shutter_.end(image_size_.height);
  const double margin = std::max(0.0, 0.5 * (kShortest - (end - begin)));
  return {begin - margin, end + margin};
}

std::optional<PoseVector> FrameAssembler::velocity(const ros::Time& stamp,
                                                   const tf2::BufferCore& transforms) const {
  const Interval exposed = exposedInterval();
  const double duration = exposed.end - exposed.begin;
  const auto within = [&](const Interval& interval) -> std::optional<PoseVector> {
    const std::optional<ros::Time> begin = later(stamp, interval.begin);
    const std::optional<ros::Time> end = later(stamp, interval.end);
    if (!begin || !end) return std::nullopt;
    const auto before = findTransform(transforms, frames_.odom, frames_.base, *begin);
    const auto after = findTransform(transforms, frames_.odom, frames_.base, *end);
    if (!before || !after) return std::nullopt;
    return velocityOf(before->inverse() * *after, duration);
  };
  const std::optional<PoseVector> velocity = within(exposed);
  return velocity ? velocity : within({-duration, 0.0});
}

AssembledFrame FrameAssembler::assemble(const cv_bridge::CvImageConstPtr& image,
                                        const tf2::BufferCore& transforms) const {
  check(*image);
  AssembledFrame assembled;
  assembled.header = image->header;
  assembled.image = image;
  assembled.frame.stamp = image->header.stamp.toSec();
  assembled.frame.image = image->image;
  assembled.frame.base_from_camera =
      lookUp(transforms, frames_.base, image->header.frame_id, image->header.stamp);
  if (!frames_.odom.empty()) {
    try {
      assembled.odom_from_base =
          lookUp(transforms, frames_.odom, frames_.base, image->header.stamp);
      assembled.frame.odom_from_base = Pose::fromIsometry(*assembled.odom_from_base);
      assembled.frame.velocity = velocity(image->header.stamp, transforms);
    } catch (const TransformError& error) {
      assembled.odometry_problem = error.what();
    }
  }
  return assembled;
}

}  // namespace omnitag
