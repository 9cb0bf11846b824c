#include "unwrapped_panorama.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kMinRange = 0.8;
constexpr double kOverlap = radians(20.0);

/// m along the optical axis: the part of the cylinder on which markers can be.
struct Band {
  double low;
  double high;
};

Band bandOf(const MountedCamera& camera, const MarkerMap& map, double distance) {
  constexpr double kWithBorder = 1.25;
  const double camera_height = camera.baseFromCamera().translation().z();
  const double sign = camera.axisUp() ? 1.0 : -1.0;
  Band band{1e9, -1e9};
  for (const Marker& marker : map.markers) {
    for (const Eigen::Vector3d& corner : marker.corners()) {
      const double above = (marker.center() + kWithBorder * (corner - marker.center())).z();
      for (const double range : {kMinRange, 20.0}) {
        const double height = sign * (above - camera_height) * distance / range;
        band.low = std::min(band.low, height);
        band.high = std::max(band.high, height);
      }
    }
  }
  return band;
}

/// The band without what the camera does not see.
Band withinField(const CameraModel& camera, const Band& band, double distance) {
  constexpr int kSteps = 1000;
  Band seen{1e9, -1e9};
  for (int i = 0; i <= kSteps; ++i) {
    const double height = band.low + (band.high - band.low) * i / kSteps;
    if (!camera.imageFromPoint(distance, height)) continue;
    seen.low = std::min(seen.low, height);
    seen.high = std::max(seen.high, height);
  }
  if (seen.low >= seen.high) throw InputError("the camera does not see the markers' heights");
  return seen;
}

}  // namespace

UnwrappedPanorama::UnwrappedPanorama(const MountedCamera& camera, const MarkerMap& map,
                                     double distance, RowSpacing spacing)
    : image_plane_(camera.model().imagePlane()) {
  const CameraModel& model = camera.model();
  const Band band = withinField(model, bandOf(camera, map, distance), distance);
  const auto imageAt = [&](double height) { return *model.imageFromPoint(distance, height); };
  constexpr int kSteps = 1000;
  double max_radius = 0.0;
  double densest = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const RadialImage image = imageAt(band.low + (band.high - band.low) * i / kSteps);
    max_radius = std::max(max_radius, image.radius);
    densest = std::max(densest, std::abs(image.radius_by_height));
  }
  azimuth_step_ = 1.0 / (max_radius * image_plane_.scale());
  const double row_height = spacing == RowSpacing::kSquare ? azimuth_step_ * distance
                                                           : 1.0 / (densest * image_plane_.scale());
  const int rows = static_cast<int>(std::ceil((band.high - band.low) / row_height));
  const int columns = static_cast<int>(std::ceil((2.0 * kPi + kOverlap) / azimuth_step_));

  // Seen from the axis, azimuth runs to the right where the axis points down. Columns count from
  // there; where it points up they run against it.
  if (camera.axisUp()) azimuth_step_ = -azimuth_step_;
  radii_.resize(rows);
  for (int row = 0; row < rows; ++row) {
    const double from_top = (row + 0.5) * (band.high - band.low) / rows;
    radii_[row] = imageAt(camera.axisUp() ? band.high - from_top : band.low + from_top).radius;
  }
  cv::Mat positions(rows, columns, CV_32FC2);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2f pixel =
          panoramaPixel({static_cast<double>(column), static_cast<double>(row)}).cast<float>();
      positions.at<cv::Vec2f>(row, column) = {pixel.x(), pixel.y()};
    }
  }
  cv::convertMaps(positions, cv::noArray(), whole_, fraction_, CV_16SC2);
}

void UnwrappedPanorama::unwrap(const cv::Mat& panorama, int interpolation,
                               cv::Mat* cylinder) const {
  cv::remap(panorama, *cylinder, whole_, fraction_, interpolation);
}

double UnwrappedPanorama::radiusAt(double row) const {
  const double last = static_cast<double>(radii_.size()) - 1.0;
  const double inside = std::clamp(row, 0.0, last);
  const auto above = static_cast<Eigen::Index>(std::min(std::floor(inside), last - 1.0));
  const double share = inside - static_cast<double>(above);
  return (1.0 - share) * radii_[above] + share * radii_[above + 1];
}

Eigen::Vector2d UnwrappedPanorama::panoramaPixel(const Eigen::Vector2d& pixel) const {
  const double azimuth = azimuth_step_ * pixel.x();
  return image_plane_.pixelFromIdeal(radiusAt(pixel.y()) *
                                     Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
}

}  // namespace omnitag
