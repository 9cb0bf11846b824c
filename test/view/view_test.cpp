#include "omnitag/view/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "../support/sample_cameras.h"
#include "view/view_planner.h"
#include "view/view_warper.h"

namespace omnitag {
namespace {

constexpr double kWorkingDistance = 3.0;

View viewToward(double azimuth, bool axis_up) {
  View view;
  view.azimuth = azimuth;
  view.distance = kWorkingDistance;
  view.middle_height = 0.1;
  view.focal_length = 200.0;
  view.axis_up = axis_up;
  view.size = {121, 81};
  return view;
}

/// A point of the view's rectangle in the optical frame: `right` and `up` are those of a person who
/// stands at the axis and looks at the rectangle.
Eigen::Vector3d pointOn(const View& view, double right, double up) {
  const Eigen::Vector3d upward(0.0, 0.0, view.axis_up ? 1.0 : -1.0);
  const Eigen::Vector3d forward(std::cos(view.azimuth), std::sin(view.azimuth), 0.0);
  const Eigen::Vector3d rightward = forward.cross(upward);
  return view.distance * forward + Eigen::Vector3d(0, 0, view.middle_height) + right * rightward +
         up * upward;
}

class ViewTest : public testing::TestWithParam<bool> {};

TEST_P(ViewTest, ShowsARectangleOfTheWorldUprightAndUnmirrored) {
  const auto camera = test::sphericalCamera();
  const ViewWarper warper(camera, kWorkingDistance);
  for (const double azimuth : {-3.1, -1.0, 0.3, 2.2}) {
    const View view = viewToward(azimuth, GetParam());
    for (const double right : {-0.6, -0.2, 0.0, 0.5}) {
      for (const double up : {-0.4, 0.0, 0.3}) {
        const auto pixel = camera->pixelFromPoint(pointOn(view, right, up));
        ASSERT_TRUE(pixel);
        const auto position = warper.viewFromPanorama(view, *pixel);
        ASSERT_TRUE(position);
        // The rectangle images as through a pinhole: that is what the look-up table is for.
        const double pixels_per_metre = view.focal_length / view.distance;
        EXPECT_NEAR(position->x(), 60.0 + right * pixels_per_metre, 0.02);
        EXPECT_NEAR(position->y(), 40.0 - up * pixels_per_metre, 0.02);
      }
    }
  }
}

TEST_P(ViewTest, PositionsGoBackToWherePixelsCameFrom) {
  const auto camera = test::hyperbolicCamera();
  const ViewWarper warper(camera, kWorkingDistance);
  const ImageSize& size = camera->imageSize();
  // Bilinear interpolation reproduces a plane of grey levels exactly, so every pixel of the view
  // tells where it was taken from, up to rounding to whole levels.
  const double slope_u = 0.11;
  const double slope_v = 0.13;
  cv::Mat panorama(size.height, size.width, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      panorama.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(slope_u * u + slope_v * v);
    }
  }
  const View view = viewToward(0.7, GetParam());
  const cv::Mat image = warper.warp(panorama, view);
  ASSERT_EQ(image.size(), view.size);
  int compared = 0;
  for (int j = 0; j < view.size.height; ++j) {
    for (int i = 0; i < view.size.width; ++i) {
      const auto pixel = warper.panoramaFromView(view, {i, j});
      if (!pixel) continue;
      const double expected = slope_u * pixel->x() + slope_v * pixel->y();
      EXPECT_NEAR(image.at<std::uint8_t>(j, i), expected, 1.01);
      ++compared;
    }
  }
  EXPECT_GT(compared, view.size.area() / 2);
}

TEST_P(ViewTest, BackAndForth) {
  const auto camera = test::sphericalCamera();
  const ViewWarper warper(camera, kWorkingDistance);
  const View view = viewToward(-2.5, GetParam());
  for (double column = 0.0; column < view.size.width; column += 7.3) {
    for (double row = 0.0; row < view.size.height; row += 6.1) {
      const auto pixel = warper.panoramaFromView(view, {column, row});
      ASSERT_TRUE(pixel);
      const auto position = warper.viewFromPanorama(view, *pixel);
      ASSERT_TRUE(position);
      EXPECT_NEAR(position->x(), column, 1e-3);
      EXPECT_NEAR(position->y(), row, 0.03);
    }
  }
}

TEST_P(ViewTest, FacesWhatIsNearTheAxisUnmirroredAndExactly) {
  for (const double off_axis : {0.0, 0.2, 0.6}) {
    const auto camera = test::equidistantCamera();
    const ViewWarper warper(camera, kWorkingDistance);
    const Eigen::Vector3d forward(std::sin(off_axis) * std::cos(0.8),
                                  std::sin(off_axis) * std::sin(0.8), std::cos(off_axis));
    ViewTarget target;
    target.distance = 2.0;
    target.cone = ViewCone{forward, 0.3, 210.0};
    const View view = planView(target, warper.table(), 1.0, GetParam(), {});
    const Eigen::Vector2d middle(0.5 * (view.size.width - 1), 0.5 * (view.size.height - 1));
    EXPECT_LT((view.pointAt(middle) - 2.0 * forward).norm(), 1e-12);
    const Eigen::Vector3d rightward =
        view.pointAt(middle + Eigen::Vector2d(1.0, 0.0)) - view.pointAt(middle);
    const Eigen::Vector3d downward =
        view.pointAt(middle + Eigen::Vector2d(0.0, 1.0)) - view.pointAt(middle);
    // As seen from the camera, the viewing direction is right x down.
    EXPECT_GT(rightward.cross(downward).normalized().dot(forward), 1.0 - 1e-12);
    EXPECT_NEAR(rightward.norm(), 2.0 / view.focal_length, 1e-12);
    EXPECT_NEAR(downward.norm(), 2.0 / view.focal_length, 1e-12);
    EXPECT_NEAR(rightward.dot(downward), 0.0, 1e-12);
    for (double column = -3.0; column < view.size.width + 3.0; column += 9.1) {
      for (double row = -3.0; row < view.size.height + 3.0; row += 7.7) {
        const auto pixel = warper.panoramaFromView(view, {column, row});
        ASSERT_TRUE(pixel);
        const auto position = warper.viewFromPanorama(view, *pixel);
        ASSERT_TRUE(position);
        EXPECT_LT((*position - Eigen::Vector2d(column, row)).norm(), 1e-6);
      }
    }
  }
}

TEST_P(ViewTest, FacingViewsShowWhatTheirPositionsSay) {
  const auto camera = test::ocamCamera();
  const ViewWarper warper(camera, kWorkingDistance);
  cv::Mat panorama(700, 700, CV_8UC1);
  for (int v = 0; v < 700; ++v) {
    for (int u = 0; u < 700; ++u) {
      panorama.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(0.11 * u + 0.13 * v);
    }
  }
  ViewTarget target;
  target.distance = 1.5;
  target.cone = ViewCone{Eigen::Vector3d(0.1, -0.2, 1.0).normalized(), 0.4, 220.0};
  const View view = planView(target, warper.table(), 1.0, GetParam(), {});
  const cv::Mat image = warper.warp(panorama, view);
  ASSERT_EQ(image.size(), view.size);
  for (int j = 0; j < view.size.height; j += 3) {
    for (int i = 0; i < view.size.width; i += 3) {
      const auto pixel = warper.panoramaFromView(view, {i, j});
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(image.at<std::uint8_t>(j, i), 0.11 * pixel->x() + 0.13 * pixel->y(), 1.01);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Axis, ViewTest, testing::Bool(),
                         [](const auto& test) { return test.param ? "Up" : "Down"; });

TEST(ViewWarperTest, IsBlackWhereThePanoramaShowsNoWorld) {
  const auto camera = test::sphericalCamera();
  const ViewWarper warper(camera, kWorkingDistance);
  View view = viewToward(0.0, false);
  view.middle_height = 40.0;  // far below the rim's ray
  const cv::Mat image = warper.warp(cv::Mat(500, 500, CV_8UC1, cv::Scalar(200)), view);
  EXPECT_EQ(cv::countNonZero(image), 0);
  EXPECT_FALSE(warper.panoramaFromView(view, {10, 10}));
}

class ViewPlannerTest : public testing::Test {
 protected:
  ViewTarget target(double azimuth, double half_width, double from, double to) const {
    return {azimuth, half_width, from / scale_, to / scale_, 3.0};
  }

  /// Whether a view shows the whole of a target.
  bool covers(const View& view, const ViewTarget& target) const {
    for (const double side : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      for (const double radius : {target.min_radius, target.max_radius}) {
        const double azimuth = target.azimuth + side * target.half_width;
        const Eigen::Vector2d pixel = camera_->imagePlane().pixelFromIdeal(
            radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
        const auto position = warper_.viewFromPanorama(view, pixel);
        constexpr double kEdge = 1.0;
        if (!position || position->x() < -kEdge || position->y() < -kEdge ||
            position->x() > view.size.width - 1 + kEdge ||
            position->y() > view.size.height - 1 + kEdge) {
          return false;
        }
      }
    }
    return true;
  }

  std::vector<View> plan(const std::vector<ViewTarget>& targets) const {
    return planViews(targets, warper_.table(), scale_, false, config_);
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  ViewWarper warper_{camera_, kWorkingDistance};
  double scale_ = camera_->imagePlane().scale();
  ViewPlannerConfig config_;
};

TEST_F(ViewPlannerTest, EveryTargetIsCoveredByTheViewThatNamesIt) {
  std::vector<ViewTarget> targets;
  for (int i = 0; i < 24; ++i) {
    const double radius = 100.0 + 2.5 * i;
    targets.push_back(target(normalizeAngle(0.7 * i), 0.05 + 0.01 * (i % 5), radius, radius + 25));
  }
  std::vector<int> seen(targets.size(), 0);
  for (const View& view : plan(targets)) {
    for (const std::size_t index : view.targets) {
      ++seen[index];
      EXPECT_TRUE(covers(view, targets[index])) << index;
    }
  }
  for (const int count : seen) EXPECT_EQ(count, 1);
}

TEST_F(ViewPlannerTest, MergesWhatOverlapsEvenAcrossTheSeamOfTheAzimuth) {
  const std::vector<View> views =
      plan({target(kPi - 0.03, 0.12, 140, 170), target(-kPi + 0.03, 0.12, 140, 170)});
  ASSERT_EQ(views.size(), 1U);
  EXPECT_NEAR(std::abs(views[0].azimuth), kPi, 1e-9);
}

TEST_F(ViewPlannerTest, LeavesApartWhatIsApart) {
  EXPECT_EQ(plan({target(0.0, 0.1, 140, 170), target(1.5, 0.1, 140, 170)}).size(), 2U);
  EXPECT_EQ(plan({target(0.0, 0.1, 100, 110), target(0.0, 0.1, 180, 190)}).size(), 2U);
}

TEST_F(ViewPlannerTest, ResolvesWhatThePanoramaHolds) {
  const View view = plan({target(0.0, 0.1, 140, 160)}).front();
  EXPECT_NEAR(view.focal_length, config_.oversampling * 160, 1e-6);
  EXPECT_NEAR(view.size.width, 2.0 * std::tan(0.1) * view.focal_length, 1.0);
}

TEST_F(ViewPlannerTest, LargeTargetsAreMadeCoarserAndCutAtTheTablesEnd) {
  const View view = plan({target(0.5, 2.0, 90, 190)}).front();
  EXPECT_LE(view.size.width, config_.max_size);
  EXPECT_LE(view.size.height, config_.max_size);
}

TEST_F(ViewPlannerTest, NothingToLookAt) { EXPECT_TRUE(plan({}).empty()); }

}  // namespace
}  // namespace omnitag
