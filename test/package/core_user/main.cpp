// Localizes a robot in an image that shows nothing: core_user CAMERA MAP SETTINGS.

#include <cstdio>
#include <opencv2/core/mat.hpp>

#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"

int main(int, char** argv) {
  const auto camera = omnitag::loadCamera(argv[1]);
  omnitag::Localizer localizer(camera, omnitag::loadMarkerMap(argv[2]),
                               omnitag::loadLocalizerConfig(argv[3]));
  omnitag::Frame frame;
  frame.image = cv::Mat::zeros(camera->imageSize().height, camera->imageSize().width, CV_8UC1);
  const omnitag::FrameResult result = localizer.process(frame);
  const auto ray = camera->rayFromPixel({100.0, 200.0});
  const auto pixel = camera->pixelFromPoint(ray->origin + 2.0 * ray->direction);
  std::printf("%s %.3f %.3f\n", omnitag::toString(result.mode), pixel->x(), pixel->y());
}
