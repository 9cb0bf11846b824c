#include "marker/marker_prediction.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

/// A marker that faces the map's origin from a distance and a direction.
Marker facingOrigin(double distance, double direction, double height = 1.3) {
  Marker marker;
  marker.family = "tag36h11";
  marker.size = 0.8;
  marker.map_from_marker =
      Eigen::Translation3d(distance * std::cos(direction), distance * std::sin(direction), height) *
      uprightOrientation(direction + kPi, 0.0);
  return marker;
}

class MarkerPredictionTest : public testing::Test {
 protected:
  std::vector<PredictedMarker> predict(const std::vector<Marker>& markers) const {
    return predictMarkers({"map", markers}, camera_, pose_, config_);
  }

  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  PoseEstimate pose_;
  VisibilityConfig config_;
};

TEST_F(MarkerPredictionTest, SeesMarkersAllAround) {
  std::vector<Marker> markers;
  for (int i = 0; i < 8; ++i) markers.push_back(facingOrigin(3.0, i * kPi / 4.0));
  const std::vector<PredictedMarker> predicted = predict(markers);
  ASSERT_EQ(predicted.size(), 8U);
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    EXPECT_EQ(predicted[i].map_entry, i);
    EXPECT_NEAR(predicted[i].range, 3.0, 0.15);  // the camera stands 0.11 m off the origin
    EXPECT_LT(predicted[i].incidence, 0.15);
  }
}

TEST_F(MarkerPredictionTest, LeavesOutWhatCannotBeSeen) {
  Marker from_behind = facingOrigin(3.0, 0.5);
  from_behind.map_from_marker =
      from_behind.map_from_marker * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY());
  Marker grazing = facingOrigin(3.0, 0.5);
  grazing.map_from_marker =
      grazing.map_from_marker * Eigen::AngleAxisd(radians(80.0), Eigen::Vector3d::UnitY());
  Marker beyond_range = facingOrigin(25.0, 0.5);
  beyond_range.size = 10.0;
  Marker too_small = facingOrigin(3.0, 0.5);
  too_small.size = 0.1;
  // The camera looks down on its mirror: directly above, it sees itself.
  const Marker above = facingOrigin(0.01, 0.5, 5.0);
  EXPECT_TRUE(predict({from_behind, grazing, beyond_range, too_small, above}).empty());
}

TEST_F(MarkerPredictionTest, IncidenceIsTheAngleToTheNormal) {
  Marker marker = facingOrigin(3.0, 0.5);
  const Eigen::Vector3d viewpoint = camera_.mapFromCamera(pose_.pose).translation();
  marker.map_from_marker.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), viewpoint - marker.center())
          .toRotationMatrix() *
      Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX());
  const auto predicted = predict({marker});
  ASSERT_EQ(predicted.size(), 1U);
  EXPECT_NEAR(predicted[0].incidence, 0.6, 1e-9);
}

TEST_F(MarkerPredictionTest, MarginsHoldThePosesUncertainty) {
  Eigen::Matrix3d covariance;
  covariance << 4e-4, 1e-4, 2e-5, 1e-4, 9e-4, -1e-5, 2e-5, -1e-5, 1e-4;
  pose_ = floorEstimate(pose_.pose, covariance);
  const Marker marker = facingOrigin(3.0, 0.9);
  const PredictedMarker predicted = predict({marker}).at(0);
  const Eigen::Vector2d radial =
      (predicted.center - camera_.model().imagePlane().principalPoint()).normalized();
  const Eigen::Vector2d tangential(-radial.y(), radial.x());

  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  double tangential_squares = 0.0;
  double radial_squares = 0.0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d error =
        root * Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    const Eigen::Vector2d moved =
        *camera_.pixelFromMap({error.x(), error.y(), error.z()}, marker.center()) -
        predicted.center;
    tangential_squares += std::pow(moved.dot(tangential), 2);
    radial_squares += std::pow(moved.dot(radial), 2);
  }
  EXPECT_NEAR(predicted.tangential_margin,
              config_.margin_deviations * std::sqrt(tangential_squares / kSamples),
              0.03 * predicted.tangential_margin);
  EXPECT_NEAR(predicted.radial_margin,
              std::max(config_.min_margin_pixels,
                       config_.margin_deviations * std::sqrt(radial_squares / kSamples)),
              0.03 * predicted.radial_margin);
}

TEST_F(MarkerPredictionTest, OneMarkerIsPredictedAsAmongAllOthers) {
  Marker from_behind = facingOrigin(3.0, 0.5);
  from_behind.map_from_marker =
      from_behind.map_from_marker * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY());
  const MarkerMap map{"map", {from_behind, facingOrigin(3.0, 0.9), facingOrigin(2.0, 4.0)}};
  pose_.covariance.diagonal().head<3>() << 1e-3, 2e-3, 1e-3;
  EXPECT_FALSE(predictMarker(map, 0, camera_, pose_, config_));
  for (const std::size_t entry : {1U, 2U}) {
    const auto predicted = predictMarker(map, entry, camera_, pose_, config_);
    ASSERT_TRUE(predicted);
    EXPECT_EQ(predicted->map_entry, entry);
    const Marker& marker = map.markers[entry];
    EXPECT_LT((predicted->center - *camera_.pixelFromMap(pose_.pose, marker.center())).norm(),
              1e-9);
    const Corners<Eigen::Vector3d> corners = marker.corners();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      EXPECT_LT((predicted->corners[k] - *camera_.pixelFromMap(pose_.pose, corners[k])).norm(),
                1e-9);
    }
    EXPECT_GT(predicted->tangential_margin, config_.min_margin_pixels);
  }
}

TEST_F(MarkerPredictionTest, TheLongestEdgeDecidesWhetherAMarkerIsLargeEnough) {
  EXPECT_DOUBLE_EQ(longestEdge({{{0.0, 0.0}, {3.0, 4.0}, {3.0, 5.0}, {0.0, 2.0}}}), 5.0);
  EXPECT_DOUBLE_EQ(longestEdge({{{0.0, 7.0}, {1.0, 0.0}, {2.0, 0.0}, {0.0, 0.0}}}),
                   std::sqrt(50.0));
  const Marker marker = facingOrigin(3.0, 0.5);
  const double edge = longestEdge(predict({marker}).at(0).corners);
  config_.min_edge_pixels = edge + 0.01;
  EXPECT_TRUE(predict({marker}).empty());
  config_.min_edge_pixels = edge - 0.01;
  EXPECT_EQ(predict({marker}).size(), 1U);
}

TEST_F(MarkerPredictionTest, TargetsHoldCornersAndMargins) {
  pose_.covariance.diagonal().head<3>() << 1e-3, 1e-3, 1e-3;
  for (const PredictedMarker& marker : predict({facingOrigin(2.0, 0.3), facingOrigin(4.0, 3.1)})) {
    const ViewTarget target = viewTarget(marker, camera_.model());
    const ImagePlane& plane = camera_.model().imagePlane();
    for (const Eigen::Vector2d& corner : marker.corners) {
      const Eigen::Vector2d ideal = *plane.idealFromPixel(corner);
      const double offset = normalizeAngle(std::atan2(ideal.y(), ideal.x()) - target.azimuth);
      EXPECT_LT(std::abs(offset) + marker.tangential_margin / (plane.scale() * ideal.norm()),
                target.half_width + 0.03);
      EXPECT_GT(ideal.norm(), target.min_radius);
      EXPECT_LT(ideal.norm(), target.max_radius);
    }
    EXPECT_EQ(target.distance, marker.range);
  }
}

TEST(ViewTargetTest, FacesWhatIsNearTheAxisWithItsBorderAndMargins) {
  const MountedCamera camera(test::equidistantCamera(), test::lookingUp());
  const Eigen::Vector3d viewpoint = camera.baseFromCamera().translation();
  PoseEstimate pose;
  pose.covariance.diagonal().head<3>() << 4e-4, 4e-4, 1e-4;
  for (const double away : {0.0, 0.4, 1.0, 4.0}) {
    const Eigen::Vector3d center = viewpoint + Eigen::Vector3d(0.6 * away, -0.8 * away, 2.0);
    const Marker marker = test::lyingMarker(3, center, false, 0.8, 0.4);
    const auto predicted = predictMarkers({"map", {marker}}, camera, pose, {});
    ASSERT_EQ(predicted.size(), 1U);
    const ViewTarget target = viewTarget(predicted[0], camera.model());
    ASSERT_EQ(target.cone.has_value(), away < 2.0) << away;
    if (!target.cone) continue;
    const Eigen::Isometry3d camera_from_base = camera.baseFromCamera().inverse();
    const double margin = predicted[0].radial_margin / target.cone->resolution;
    EXPECT_GT(margin, 0.0);
    for (const Eigen::Vector3d& corner : marker.corners()) {
      // tag36h11 has a white border of an eighth of its edge.
      const Eigen::Vector3d outer = center + 1.25 * (corner - center);
      const Eigen::Vector3d direction = (camera_from_base * outer).normalized();
      const double angle = std::acos(direction.dot(target.cone->direction));
      EXPECT_LT(angle + margin, target.cone->half_angle);
    }
    EXPECT_LT(target.cone->half_angle, 0.4 + margin);
    EXPECT_NEAR(target.cone->resolution, 210.0, 15.0);
  }
}

}  // namespace
}  // namespace omnitag
