#pragma once

#include <image_transport/image_transport.h>

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "ros/debug_image.h"
#include "ros/image_localizer.h"
#include "ros/parameters.h"

namespace omnitag {

/// Publishes, on `debug_image`, what the localizer saw in the image of each camera. Cameras with
/// names have topics of their own (debugImageTopic), and `debug_image` shows the last image of
/// each, in rows. Paints only what somebody looks at.
class DebugImages {
 public:
  DebugImages(const std::vector<CameraParameters>& cameras, const ImageLocalizer& localizer,
              image_transport::ImageTransport* transport);

  void setMap(const MarkerMap& map);

  bool areWanted(std::size_t camera) const;

  /// Publishes to those who look at the camera's images.
  void publish(const LocalizedImage& localized, std::size_t camera);

 private:
  struct Camera {
    DebugImagePainter painter;
    image_transport::Publisher publisher;
  };
  std::vector<Camera> cameras_;
  /// For all cameras with names; and the last painting of each, empty if there was none.
  std::optional<image_transport::Publisher> joint_publisher_;
  std::vector<cv::Mat> paintings_;
};

}  // namespace omnitag
