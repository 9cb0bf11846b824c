#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map.h"
#include "view/view_warper.h"

namespace omnitag {

/// The topic of a camera's debug images: `debug_image`, below the camera's name if it has one.
std::string debugImageTopic(const std::string& camera_name);

/// Paints what the localizer saw in an image (the paper's Fig. 11): the panorama in the middle with
/// lines to the predicted markers, and around it the views in their directions, each with the ids
/// that were looked for and whether they were read. Green: read and used; orange: rejected; yellow:
/// predicted; grey: not read.
class DebugImagePainter {
 public:
  DebugImagePainter(std::shared_ptr<const CameraModel> camera, MarkerMap map);

  void setMap(const MarkerMap& map) { map_ = map; }

  /// `panorama`: CV_8UC1, the image of `result`. The painting is CV_8UC3 (BGR), always of the same
  /// size.
  cv::Mat paint(const cv::Mat& panorama, const FrameResult& result) const;

 private:
  /// A map entry in a view: predicted, read and used, or both.
  struct Sighting {
    std::size_t map_entry;
    const PredictedMarker* predicted;
    const MarkerDetection* detected;
  };

  std::vector<Sighting> sightingsIn(const View& view, const FrameResult& result) const;
  std::vector<const MarkerDetection*> rejectedIn(const View& view, const FrameResult& result) const;
  bool isIn(const View& view, const Eigen::Vector2d& panorama_pixel) const;
  std::vector<cv::Point2d> outline(const View& view) const;
  std::vector<cv::Point2d> inView(const View& view, const Corners<Eigen::Vector2d>& corners) const;
  cv::Point2d onCanvas(const Eigen::Vector2d& panorama_pixel) const;

  void paintPanorama(const cv::Mat& panorama, const FrameResult& result, cv::Mat* canvas) const;
  void paintView(const FrameResult& result, std::size_t view, const cv::Rect& cell,
                 cv::Mat* canvas) const;
  static void paintTitle(const FrameResult& result, cv::Mat* canvas);

  std::shared_ptr<const CameraModel> camera_;
  MarkerMap map_;
  ViewWarper warper_;
  /// Pixels of the canvas per pixel of the panorama, and where the panorama begins on the canvas.
  double scale_;
  cv::Point2d origin_;
};

}  // namespace omnitag
