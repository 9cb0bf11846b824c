#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "omnitag/camera/camera_model.h"
#include "omnitag/view/view.h"
#include "view/contour_table.h"

namespace omnitag {

/// m, default distance of the lines whose contours are tabulated. Contours of horizontal lines
/// hardly change beyond it. Nearer lines are only a little bent in a view, and positions go back to
/// the panorama through the same table.
inline constexpr double kWorkingDistance = 3.0;

/// Takes views out of the panorama and positions in them back to it, both through the same look-up
/// table: a position read in a view goes back to exactly where its pixels came from, whatever the
/// table's error. Views of a target near the axis use the exact projection instead.
class ViewWarper {
 public:
  /// `working_distance`: m, distance of the horizontal lines whose contours the table holds.
  ViewWarper(std::shared_ptr<const CameraModel> camera, double working_distance);

  /// The view's image (CV_8UC1), interpolated bilinearly; black where the panorama does not show
  /// the world. `panorama`: CV_8UC1, as large as the camera's image.
  cv::Mat warp(const cv::Mat& panorama, const View& view) const;

  /// The panorama's pixel that a position of the view was taken from; nothing if it does not show
  /// the world.
  std::optional<Eigen::Vector2d> panoramaFromView(const View& view,
                                                  const Eigen::Vector2d& position) const;

  /// The position in the view that a pixel of the panorama goes to, which may lie outside the view;
  /// nothing if the table does not reach that far.
  std::optional<Eigen::Vector2d> viewFromPanorama(const View& view,
                                                  const Eigen::Vector2d& pixel) const;

  const ContourTable& table() const { return table_; }

 private:
  cv::Mat warpByTable(const cv::Mat& panorama, const View& view) const;
  cv::Mat warpExactly(const cv::Mat& panorama, const View& view) const;

  std::shared_ptr<const CameraModel> camera_;
  ContourTable table_;
};

}  // namespace omnitag
