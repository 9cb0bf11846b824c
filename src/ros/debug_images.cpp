#include "ros/debug_images.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>

namespace omnitag {
namespace {

bool isWatched(const image_transport::Publisher& publisher) {
  return publisher.getNumSubscribers() > 0;
}

void publishTo(image_transport::Publisher* publisher, const std_msgs::Header& header,
               const cv::Mat& painting) {
  publisher->publish(
      cv_bridge::CvImage(header, sensor_msgs::image_encodings::BGR8, painting).toImageMsg());
}

/// All paintings in one, in about as many rows as columns, with black for empty ones. All have the
/// size of `last`.
cv::Mat inRows(const std::vector<cv::Mat>& paintings, const cv::Mat& last) {
  const auto count = static_cast<int>(paintings.size());
  const int columns = cvCeil(std::sqrt(count));
  const int rows = (count + columns - 1) / columns;
  cv::Mat joint = cv::Mat::zeros(rows * last.rows, columns * last.cols, last.type());
  for (int i = 0; i < count; ++i) {
    const cv::Mat& painting = paintings[static_cast<std::size_t>(i)];
    if (painting.empty()) continue;
    const cv::Point corner(i % columns * last.cols, i / columns * last.rows);
    painting.copyTo(joint(cv::Rect(corner, painting.size())));
  }
  return joint;
}

}  // namespace

DebugImages::DebugImages(const std::vector<CameraParameters>& cameras,
                         const ImageLocalizer& localizer,
                         image_transport::ImageTransport* transport)
    : paintings_(cameras.size()) {
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    cameras_.push_back({DebugImagePainter(localizer.cameras()[i], localizer.map()),
                        transport->advertise(debugImageTopic(cameras[i].name), 1)});
    if (!cameras[i].name.empty() && !joint_publisher_) {
      joint_publisher_ = transport->advertise(debugImageTopic(""), 1);
    }
  }
}

void DebugImages::setMap(const MarkerMap& map) {
  for (Camera& camera : cameras_) camera.painter.setMap(map);
}

bool DebugImages::areWanted(std::size_t camera) const {
  return isWatched(cameras_[camera].publisher) ||
         (joint_publisher_ && isWatched(*joint_publisher_));
}

void DebugImages::publish(const LocalizedImage& localized, std::size_t camera) {
  if (!areWanted(camera)) return;
  const std_msgs::Header& header = localized.input.header;
  const cv::Mat painting =
      cameras_[camera].painter.paint(localized.input.frame.image, localized.result);
  if (isWatched(cameras_[camera].publisher)) {
    publishTo(&cameras_[camera].publisher, header, painting);
  }
  if (!joint_publisher_ || !isWatched(*joint_publisher_)) return;
  paintings_[camera] = painting;
  publishTo(&*joint_publisher_, header, inRows(paintings_, painting));
}

}  // namespace omnitag
