#include "omnitag/ros/frame_assembler.h"

#include <tf2/exceptions.h>

#include <utility>

#include "omnitag/ros/conversions.h"

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

}  // namespace

FrameAssembler::FrameAssembler(std::string camera_origin, const ImageSize& image_size,
                               FrameNames frames)
    : camera_origin_(std::move(camera_origin)),
      image_size_(image_size),
      frames_(std::move(frames)) {}

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
  return transforms.canTransform(frames_.base, header.frame_id, header.stamp) &&
         (frames_.odom.empty() ||
          transforms.canTransform(frames_.odom, frames_.base, header.stamp));
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
    } catch (const TransformError& error) {
      assembled.odometry_problem = error.what();
    }
  }
  return assembled;
}

}  // namespace omnitag
