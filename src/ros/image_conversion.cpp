#include "ros/image_conversion.h"

#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

namespace encodings = sensor_msgs::image_encodings;

std::size_t bytesPerPixel(const std::string& encoding) {
  try {
    return static_cast<std::size_t>(encodings::numChannels(encoding)) *
           static_cast<std::size_t>(encodings::bitDepth(encoding)) / 8;
  } catch (const std::runtime_error&) {
    throw InputError("image encoding '" + encoding +
                     "' is unknown; expected one of sensor_msgs/image_encodings.h");
  }
}

void checkSizes(const sensor_msgs::Image& image) {
  const auto shape = [&image] {
    return std::to_string(image.width) + " x " + std::to_string(image.height) + " " +
           image.encoding + " image";
  };
  if (image.width == 0 || image.height == 0) {
    throw InputError(shape() + ": expected at least one pixel");
  }
  const std::size_t row = image.width * bytesPerPixel(image.encoding);
  if (image.step < row) {
    throw InputError(shape() + ": expected a step of at least " + std::to_string(row) +
                     " bytes per row, found " + std::to_string(image.step));
  }
  const std::size_t size = std::size_t{image.step} * image.height;
  if (image.data.size() != size) {
    throw InputError(shape() + ": expected " + std::to_string(size) + " bytes of data, found " +
                     std::to_string(image.data.size()));
  }
}

/// The upper 8 bits of a 16 bit grey image.
cv_bridge::CvImageConstPtr upperBytes(const sensor_msgs::Image& message) {
  // OpenCV has no view on constant data.
  auto* const data = const_cast<std::uint8_t*>(message.data.data());
  const cv::Mat bytes(static_cast<int>(message.height), static_cast<int>(message.width), CV_8UC2,
                      data, message.step);
  auto gray = boost::make_shared<cv_bridge::CvImage>(message.header, encodings::MONO8);
  cv::extractChannel(bytes, gray->image, message.is_bigendian != 0U ? 0 : 1);
  return gray;
}

}  // namespace

cv_bridge::CvImageConstPtr grayImage(const sensor_msgs::ImageConstPtr& message) {
  checkSizes(*message);
  const std::string& encoding = message->encoding;
  if (encoding == encodings::MONO16 || encoding == encodings::TYPE_16UC1) {
    return upperBytes(*message);
  }
  try {
    const bool is_gray = encoding == encodings::MONO8 || encoding == encodings::TYPE_8UC1;
    // cv_bridge does not swap the bytes of 16 bit colours.
    const bool is_swapped = message->is_bigendian != 0U && encodings::bitDepth(encoding) > 8;
    if (!is_swapped) {
      cv_bridge::CvImageConstPtr gray =
          is_gray ? cv_bridge::toCvShare(message) : cv_bridge::toCvShare(message, encodings::MONO8);
      if (gray->image.type() == CV_8UC1) return gray;
    }
  } catch (const std::exception&) {
    // Reported below.
  }
  throw InputError("image encoding '" + encoding +
                   "' cannot be shown in grey; expected a grey, colour, Bayer or YUV encoding");
}

cv_bridge::CvImageConstPtr grayImage(const sensor_msgs::CompressedImageConstPtr& message) {
  auto gray = boost::make_shared<cv_bridge::CvImage>(message->header, encodings::MONO8);
  try {
    if (!message->data.empty()) {
      gray->image =
          cv::imdecode(message->data, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    }
  } catch (const cv::Exception&) {
    gray->image.release();
  }
  if (gray->image.empty()) {
    throw InputError("compressed image ('" + message->format + "', " +
                     std::to_string(message->data.size()) + " bytes) cannot be decoded");
  }
  return gray;
}

cv_bridge::CvImageConstPtr inFrame(const cv_bridge::CvImageConstPtr& image,
                                   const std::string& frame) {
  if (frame.empty()) return image;
  auto renamed = boost::make_shared<cv_bridge::CvImage>(*image);
  renamed->header.frame_id = frame;
  return renamed;
}

}  // namespace omnitag
