#include "ros/adjustment_tools/map_drawing.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/drawing.h"
#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// B, G, R.
const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kGrid(232, 232, 232);
const cv::Scalar kText(110, 110, 110);
const cv::Scalar kWay(120, 180, 120);
const cv::Scalar kSeed(30, 30, 30);
const cv::Scalar kNew(190, 90, 20);
const cv::Scalar kEllipse(230, 190, 150);

/// A sheet of paper over a part of the floor.
class Sheet {
 public:
  Sheet(const Eigen::Vector2d& low, const Eigen::Vector2d& high) : low_(low), high_(high) {
    constexpr double kLongerSide = 1100.0;  // pixels
    scale_ = kLongerSide / (high - low).maxCoeff();
    const Eigen::Vector2d size = scale_ * (high - low);
    image_ =
        cv::Mat(static_cast<int>(size.y()) + 1, static_cast<int>(size.x()) + 1, CV_8UC3, kPaper);
  }

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& color,
            int width) {
    cv::line(image_, fixedPoint(position(a)), fixedPoint(position(b)), color, width, cv::LINE_AA,
             kFractionalBits);
  }

  void text(const Eigen::Vector2d& middle, const std::string& words, const cv::Scalar& color) {
    constexpr double kSize = 0.45;
    const cv::Size size = sizeOfText(words, kSize);
    const cv::Point at = position(middle);
    writeText(words, {at.x - size.width / 2, at.y + size.height / 2}, color, kSize, &image_);
  }

  /// `covariance` in m^2.
  void ellipse(const Eigen::Vector2d& middle, const Eigen::Matrix2d& covariance,
               const cv::Scalar& color) {
    const EigenPairs eigen = eigenPairs(covariance);
    const Eigen::Vector2d radii = scale_ * eigen.values.cwiseMax(0.0).cwiseSqrt();
    const Eigen::Vector2d axis = eigen.vectors.col(1);
    cv::ellipse(image_,
                {cv::Point2f(position(middle)),
                 cv::Size2f(static_cast<float>(2.0 * radii(1)), static_cast<float>(2.0 * radii(0))),
                 static_cast<float>(degrees(std::atan2(-axis.y(), axis.x())))},
                color, cv::FILLED, cv::LINE_AA);
  }

  void grid() {
    const Eigen::Vector2i first = low_.array().ceil().matrix().cast<int>();
    const Eigen::Vector2i last = high_.array().floor().matrix().cast<int>();
    for (int x = first.x(); x <= last.x(); ++x) {
      line({x, low_.y()}, {x, high_.y()}, kGrid, 1);
      text({x, low_.y() + 0.15}, std::to_string(x), kText);
    }
    for (int y = first.y(); y <= last.y(); ++y) {
      line({low_.x(), y}, {high_.x(), y}, kGrid, 1);
      text({low_.x() + 0.15, y}, std::to_string(y), kText);
    }
  }

  const cv::Mat& image() const { return image_; }

 private:
  cv::Point2d position(const Eigen::Vector2d& point) const {
    return {scale_ * (point.x() - low_.x()), scale_ * (high_.y() - point.y())};
  }

  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  double scale_ = 1.0;
  cv::Mat image_;
};

void drawMarker(const BuiltMarker& built, Sheet* sheet) {
  const Marker& marker = built.marker;
  const cv::Scalar& color = built.is_exact ? kSeed : kNew;
  const Corners<Eigen::Vector3d> corners = marker.corners();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    sheet->line(corners[k].head<2>(), corners[(k + 1) % corners.size()].head<2>(), color, 2);
  }
  const Eigen::Vector2d center = marker.center().head<2>();
  const Eigen::Vector2d normal = marker.normal().head<2>();
  sheet->line(center, center + 0.2 * normal, color, 1);
  sheet->text(center - 0.22 * normal, std::to_string(marker.id), color);
}

}  // namespace

void drawMap(const BuiltMap& map, const std::string& path) {
  constexpr double kMargin = 0.7;  // m
  Eigen::Vector2d low = map.trajectory.empty()
                            ? Eigen::Vector2d(0.0, 0.0)
                            : Eigen::Vector2d(map.trajectory[0].x, map.trajectory[0].y);
  Eigen::Vector2d high = low;
  const auto include = [&](const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  for (const BuiltMarker& marker : map.markers) include(marker.marker.center().head<2>());
  for (const Pose& pose : map.trajectory) include({pose.x, pose.y});
  const Eigen::Vector2d margin(kMargin, kMargin);
  Sheet sheet(low - margin, high + margin);
  sheet.grid();
  constexpr double kDeviations = 100.0;
  for (const BuiltMarker& marker : map.markers) {
    sheet.ellipse(marker.marker.center().head<2>(),
                  kDeviations * kDeviations * marker.covariance.topLeftCorner<2, 2>(), kEllipse);
  }
  for (std::size_t i = 1; i < map.trajectory.size(); ++i) {
    const Pose& from = map.trajectory[i - 1];
    const Pose& to = map.trajectory[i];
    sheet.line({from.x, from.y}, {to.x, to.y}, kWay, 2);
  }
  for (const BuiltMarker& marker : map.markers) drawMarker(marker, &sheet);
  sheet.text({0.5 * (low.x() + high.x()), high.y() + 0.55},
             "black: exactly known; blue: found, with 100 standard deviations; green: the robot's "
             "way; metres",
             kText);
  bool is_written = false;
  try {
    is_written = cv::imwrite(path, sheet.image());
  } catch (const cv::Exception&) {
    is_written = false;
  }
  if (!is_written) throw InputError("--drawing: " + path + " cannot be written");
}

}  // namespace omnitag
