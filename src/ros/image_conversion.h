#pragma once

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

namespace omnitag {

/// The image in 8 bit grey (CV_8UC1), with its header. Accepts 8 and 16 bit grey, colour, Bayer and
/// YUV 4:2:2 in the encodings of sensor_msgs/image_encodings.h, and keeps the upper 8 of 16 bits.
/// An image in 8 bit grey is not copied; the message is kept alive, and its rows keep any padding.
/// Throws InputError if the message's sizes contradict each other or the encoding cannot be shown
/// in grey.
cv_bridge::CvImageConstPtr grayImage(const sensor_msgs::ImageConstPtr& message);

/// The same for a file in one of OpenCV's formats (JPEG, PNG, ...), as image_transport's
/// `compressed` sends it. Throws InputError if it cannot be decoded.
cv_bridge::CvImageConstPtr grayImage(const sensor_msgs::CompressedImageConstPtr& message);

/// The same pixels, taken in another optical frame; the image itself if the frame is empty.
cv_bridge::CvImageConstPtr inFrame(const cv_bridge::CvImageConstPtr& image,
                                   const std::string& frame);

}  // namespace omnitag
