#include "localization/look_around.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "view/view_warper.h"

namespace omnitag {
namespace {

constexpr double kWorkingDistance = 3.0;  // m

struct Setup {
  std::string name;
  std::shared_ptr<const CameraModel> (*camera)();
  Eigen::Isometry3d base_from_camera;
};

/// Names a setup for gtest.
void PrintTo(const Setup& setup, std::ostream* out) { *out << setup.name; }

std::vector<Setup> setups() {
  const auto tilted = [](const Eigen::Isometry3d& mounting, double tilt) {
    return mounting * Eigen::AngleAxisd(tilt, Eigen::Vector3d(0.6, -0.8, 0.0));
  };
  return {{"SphereDown", test::sphericalCamera, test::lookingDown()},
          {"SphereUp", test::sphericalCamera, test::lookingUp()},
          {"SphereDownTilted", test::sphericalCamera, tilted(test::lookingDown(), radians(6.0))},
          {"SphereUpTilted", test::sphericalCamera, tilted(test::lookingUp(), radians(-6.0))},
          {"HyperbolaDown", test::hyperbolicCamera, test::lookingDown()},
          {"HyperbolaUp", test::hyperbolicCamera, test::lookingUp()}};
}

class LookAroundTest : public testing::TestWithParam<Setup> {
 protected:
  std::vector<View> views(const MarkerMap& map, double max_range) const {
    return viewsAllAround(heightsOf(map), camera_, warper_.table(), max_range, config_);
  }

  /// For each view, whether it holds each corner of a marker.
  std::vector<std::vector<bool>> cornersIn(const std::vector<View>& views,
                                           const Corners<Eigen::Vector2d>& corners) const {
    std::vector<std::vector<bool>> held;
    for (const View& view : views) {
      held.emplace_back();
      for (const Eigen::Vector2d& corner : corners) {
        const auto position = warper_.viewFromPanorama(view, corner);
        held.back().push_back(position && position->x() >= 0.0 && position->y() >= 0.0 &&
                              position->x() <= view.size.width - 1 &&
                              position->y() <= view.size.height - 1);
      }
    }
    return held;
  }

  /// Whether a corner images so close to the edge of the field that the sides of a view, where
  /// horizontal lines bend outward, cannot hold it: their nearest points are not in the image.
  bool isAtTheEdge(const Corners<Eigen::Vector2d>& corners) const {
    const double bend = 1.0 - std::cos(0.5 * (config_.step + config_.overlap));
    const double limit = (1.0 - 0.5 * bend) * model_->maxRadius();
    return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
      return model_->imagePlane().idealFromPixel(corner)->norm() > limit;
    });
  }

  std::shared_ptr<const CameraModel> model_ = GetParam().camera();
  MountedCamera camera_{model_, GetParam().base_from_camera};
  ViewWarper warper_{model_, kWorkingDistance};
  LookAroundConfig config_;
};

TEST_P(LookAroundTest, EveryMarkerThatCanBeSeenIsWholeInAView) {
  constexpr double kMaxRange = 12.0;
  const Eigen::Vector2d viewpoint = camera_.baseFromCamera().translation().head<2>();
  int seen = 0;
  for (const std::vector<double>& heights :
       {std::vector<double>{1.2}, {0.6, 1.0}, {0.9, 1.7, 2.4}}) {
    MarkerMap map{"map", {}};
    for (const double height : heights) {
      map.markers.push_back(test::wallMarker(0, {100.0, 0.0, height}, 0.0));
      map.markers.back().size = 0.3;
    }
    const std::vector<View> views = this->views(map, kMaxRange);
    ASSERT_FALSE(views.empty());
    for (const double height : heights) {
      for (const double range : {1.0, 1.5, 2.5, 5.0, 11.5}) {
        for (int i = 0; i < 40; ++i) {
          const double azimuth = 2.0 * kPi * i / 40;
          const Eigen::Vector2d place =
              viewpoint + range * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
          Marker marker = test::wallMarker(0, {place.x(), place.y(), height}, azimuth + kPi);
          marker.size = 0.3;
          const auto reading = test::exactReading(marker, camera_, {});
          if (!reading || isAtTheEdge(reading->corners)) continue;
          ++seen;
          const auto held = cornersIn(views, reading->corners);
          EXPECT_TRUE(std::any_of(held.begin(), held.end(),
                                  [](const std::vector<bool>& corners) {
                                    return std::count(corners.begin(), corners.end(), true) == 4;
                                  }))
              << "height " << height << ", range " << range << ", azimuth " << azimuth;
        }
      }
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_P(LookAroundTest, EveryMarkerThatCanBeSeenIsWithinTheAnnulus) {
  constexpr double kMaxRange = 12.0;
  const Eigen::Vector2d viewpoint = camera_.baseFromCamera().translation().head<2>();
  const double width = model_->maxRadius() - model_->minRadius();
  int seen = 0;
  for (const double size : {0.3, 0.08}) {
    for (const double height : {0.6, 1.2, 1.9}) {
      Marker marker = test::wallMarker(0, {100.0, 0.0, height}, 0.0);
      marker.size = size;
      const auto annulus =
          annulusOfMarkers(heightsOf({"map", {marker}}), camera_, kMaxRange, config_);
      if (annulus && size == 0.3) {
        EXPECT_LT(annulus->max_radius - annulus->min_radius, 0.8 * width);
      }
      // Smaller ones look as wide from nearer by.
      for (const double range : {1.0, 1.5, 2.5, 5.0, 11.5}) {
        for (int i = 0; i < 40; ++i) {
          const double azimuth = 2.0 * kPi * i / 40;
          const Eigen::Vector2d place =
              viewpoint +
              range * size / 0.3 * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
          marker = test::wallMarker(0, {place.x(), place.y(), height}, azimuth + kPi);
          marker.size = size;
          const auto reading = test::exactReading(marker, camera_, {});
          if (!reading) continue;
          ++seen;
          ASSERT_TRUE(annulus);
          for (const Eigen::Vector2d& corner : reading->corners) {
            const double radius = model_->imagePlane().idealFromPixel(corner)->norm();
            EXPECT_GE(radius, annulus->min_radius) << "range " << range << ", azimuth " << azimuth;
            EXPECT_LE(radius, annulus->max_radius) << "range " << range << ", azimuth " << azimuth;
          }
        }
      }
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_P(LookAroundTest, EverythingHoldsMarkersAtAnyHeightWithoutAMap) {
  const Eigen::Vector2d viewpoint = camera_.baseFromCamera().translation().head<2>();
  const std::vector<View> views = viewsOfEverything(camera_, warper_.table(), config_);
  int seen = 0;
  for (const double height : {0.2, 1.2, 2.6}) {
    for (const double range : {1.5, 2.5, 5.0, 11.5}) {
      for (int i = 0; i < 40; ++i) {
        const double azimuth = 2.0 * kPi * i / 40;
        const Eigen::Vector2d place =
            viewpoint + range * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
        Marker marker = test::wallMarker(0, {place.x(), place.y(), height}, azimuth + kPi);
        marker.size = 0.3;
        const auto reading = test::exactReading(marker, camera_, {});
        if (!reading || isAtTheEdge(reading->corners)) continue;
        ++seen;
        const auto held = cornersIn(views, reading->corners);
        EXPECT_TRUE(std::any_of(held.begin(), held.end(),
                                [](const std::vector<bool>& corners) {
                                  return std::count(corners.begin(), corners.end(), true) == 4;
                                }))
            << "height " << height << ", range " << range << ", azimuth " << azimuth;
      }
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_P(LookAroundTest, ViewsStepAndOverlapAsConfigured) {
  for (const auto& [step, overlap] :
       std::vector<std::pair<double, double>>{{45.0, 20.0}, {30.0, 0.0}, {50.0, 10.0}}) {
    config_.step = radians(step);
    config_.overlap = radians(overlap);
    const std::vector<View> views = this->views({"map", test::roomMarkers()}, 12.0);
    ASSERT_EQ(views.size(), static_cast<std::size_t>(std::ceil(360.0 / step)));
    for (std::size_t i = 0; i < views.size(); ++i) {
      const View& view = views[i];
      const View& next = views[(i + 1) % views.size()];
      const double turn = normalizeAngle(next.azimuth - view.azimuth);
      EXPECT_NEAR(std::abs(turn), 2.0 * kPi / static_cast<double>(views.size()), 1e-9);
      EXPECT_LE(std::abs(turn), config_.step + 1e-9);
      const double half_width = std::abs(view.azimuthOffset(-0.5));
      EXPECT_GE(2.0 * half_width - std::abs(turn), config_.overlap - 1e-6);
      EXPECT_LE(view.size.width, config_.max_size);
      EXPECT_LE(view.size.height, config_.max_size);
      EXPECT_EQ(view.axis_up, camera_.axisUp());
    }
  }
}

/// Expects whole lying markers at a height (m), however near, if the camera sees them.
void expectNearMarkersAreWhole(const std::shared_ptr<const CameraModel>& model, double height,
                               bool face_up) {
  const MountedCamera camera(model, test::lookingUp());
  const ViewWarper warper(model, kWorkingDistance);
  const Eigen::Vector2d viewpoint = camera.baseFromCamera().translation().head<2>();
  const MarkerMap map{"map", {test::lyingMarker(0, {50.0, 0.0, height}, face_up, 0.0, 0.4)}};
  const std::vector<View> expected =
      viewsAllAround(heightsOf(map), camera, warper.table(), 12.0, {});
  const std::vector<View> everything = viewsOfEverything(camera, warper.table(), {});
  const auto isWholeIn = [&](const std::vector<View>& views, const MarkerReading& reading) {
    return std::any_of(views.begin(), views.end(), [&](const View& view) {
      return std::all_of(
          reading.corners.begin(), reading.corners.end(), [&](const Eigen::Vector2d& corner) {
            const auto position = warper.viewFromPanorama(view, corner);
            return position && position->x() >= 0.0 && position->y() >= 0.0 &&
                   position->x() <= view.size.width - 1 && position->y() <= view.size.height - 1;
          });
    });
  };
  int seen = 0;
  for (const double range : {0.0, 0.3, 0.7, 1.1, 1.5, 2.0, 3.0, 5.0}) {
    for (int i = 0; i < 24; ++i) {
      const double azimuth = 2.0 * kPi * i / 24;
      const Eigen::Vector2d place =
          viewpoint + range * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
      const Marker marker =
          test::lyingMarker(0, {place.x(), place.y(), height}, face_up, 1.7 * azimuth, 0.4);
      const auto reading = test::exactReading(marker, camera, {});
      if (!reading) continue;
      ++seen;
      EXPECT_TRUE(isWholeIn(expected, *reading)) << "range " << range << ", azimuth " << azimuth;
      EXPECT_TRUE(isWholeIn(everything, *reading)) << "range " << range << ", azimuth " << azimuth;
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(LookAroundFisheye, HoldsEveryMarkerUnderTheCeilingHoweverNear) {
  expectNearMarkersAreWhole(test::equidistantCamera(), 2.8, false);
}

TEST(LookAroundMirror, HoldsTheMarkersOnTheFloorThatTheHousingLeavesInSight) {
  expectNearMarkersAreWhole(parseCamera(R"(
model: catadioptric
image: {width: 500, height: 500}
uncertainty: none
lens: {fx: 1234, fy: 1234, cx: 249.5, cy: 249.5, housing_radius: 0.03}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0395}
)",
                                        "camera that sees its housing"),
                            0.0, true);
}

TEST(LookAroundAhead, HoldsMarkersOnWallsNearTheAxis) {
  // The optical axis points ahead, a little down.
  Eigen::Matrix3d base_from_optical;
  base_from_optical << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  Eigen::Isometry3d mounting = Eigen::Isometry3d::Identity();
  mounting.linear() = Eigen::AngleAxisd(radians(5.0), Eigen::Vector3d::UnitY()) * base_from_optical;
  mounting.translation() << 0.1, 0.0, 0.6;
  const std::string narrow = R"(
model: unified
image: {width: 1280, height: 720}
uncertainty: none
lens: {fx: 1146, fy: 1144, cx: 599, cy: 353}
xi: 0.0
distortion: [0, 0, 0, 0]
)";
  for (const auto& model : {test::equidistantCamera(), parseCamera(narrow, "narrow")}) {
    const MountedCamera camera(model, mounting);
    const ViewWarper warper(model, kWorkingDistance);
    int seen = 0;
    for (const double azimuth : {-0.3, -0.1, 0.0, 0.05, 0.2}) {
      for (const double height : {0.4, 0.6, 0.9}) {
        const MarkerMap map{
            "map",
            {test::wallMarker(0, {3.0 * std::cos(azimuth), 3.0 * std::sin(azimuth), height},
                              azimuth + kPi)}};
        const auto reading = test::exactReading(map.markers[0], camera, {});
        if (!reading) continue;
        ++seen;
        const std::vector<View> views =
            viewsAllAround(heightsOf(map), camera, warper.table(), 12.0, {});
        const bool is_held = std::any_of(views.begin(), views.end(), [&](const View& view) {
          return std::all_of(reading->corners.begin(), reading->corners.end(),
                             [&](const Eigen::Vector2d& corner) {
                               const auto position = warper.viewFromPanorama(view, corner);
                               return position && position->minCoeff() >= 0.0 &&
                                      position->x() <= view.size.width - 1 &&
                                      position->y() <= view.size.height - 1;
                             });
        });
        EXPECT_TRUE(is_held) << azimuth << ", " << height;
      }
    }
    EXPECT_GT(seen, 5);
  }
}

TEST_P(LookAroundTest, WithoutAMarkerOrWhereNoneCanBeSeenThereIsNothingToLookAt) {
  EXPECT_TRUE(views({"map", {}}, 12.0).empty());
  EXPECT_FALSE(annulusOfMarkers({}, camera_, 12.0, config_));
  // On the camera's axis, behind the mirror.
  const double height = camera_.axisUp() ? 500.0 : -500.0;
  const MarkerMap hidden{"map", {test::wallMarker(0, {0.0, 0.0, height}, 0.0)}};
  EXPECT_TRUE(views(hidden, 1.0).empty());
  EXPECT_FALSE(annulusOfMarkers(heightsOf(hidden), camera_, 1.0, config_));
}

INSTANTIATE_TEST_SUITE_P(Cameras, LookAroundTest, testing::ValuesIn(setups()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace omnitag
