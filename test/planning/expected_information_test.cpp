#include "planning/expected_information.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "building.h"
#include "localization/reprojection.h"
#include "marker/tag_pattern.h"
#include "planning/pose_prediction.h"

namespace omnitag {
namespace {

/// An empty hall of 10 x 10 m about the origin.
OccupancyGrid hall() {
  return {test::FloorDrawing(10.0, 10.0).free(0.0, 0.0, 10.0, 10.0).image(),
          test::gridFileAt(-5.0, -5.0)};
}

class ExpectedInformationTest : public testing::Test {
 protected:
  ExpectedInformationTest() {
    map_.markers = test::markersAround(3.0, 0.8);
    for (Marker& marker : map_.markers) {
      marker.deviation = 0.005;
      marker.orientation_deviation = 0.0175;
    }
  }

  PoseEstimate predicted() const {
    return expectedEstimate(scene_, PosePredictor(scene_, map_).predict(truth_).equations, truth_);
  }

  OccupancyGrid grid_ = hall();
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  PlanningScene scene_{grid_, camera_, {}};
  MarkerMap map_;
  Pose truth_{0.3, -0.2, 0.7};
};

/// The pixel of a point after a change of the robot's pose (as in a FrameVector) and of the
/// marker's place (six numbers, along and about its axes).
Eigen::Vector2d pixelAfter(const MountedCamera& camera, const Pose& pose, const Marker& marker,
                           const Eigen::Vector2d& on_marker,
                           const Eigen::Matrix<double, 12, 1>& change) {
  Eigen::Isometry3d misplaced = Eigen::Isometry3d::Identity();
  misplaced.translation() = change.segment<3>(6);
  const Eigen::Vector3d turn = change.tail<3>();
  const double angle = turn.norm();
  if (angle > 0.0) misplaced.linear() = Eigen::AngleAxisd(angle, turn / angle).matrix();
  Marker there = marker;
  there.map_from_marker = marker.map_from_marker * misplaced;
  const Eigen::Vector3d point =
      there.map_from_marker * Eigen::Vector3d(on_marker.x(), on_marker.y(), 0.0);
  return camera.pixelFromMap(moved(pose, change.head<6>()), point).value();
}

TEST_F(ExpectedInformationTest, IsThatOfADenseLeastSquaresOverTheEdges) {
  // All edges of all patterns, module by module, with numerical derivatives, and every marker's
  // misplacement as six more unknowns.
  const auto markers = static_cast<int>(map_.markers.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(6 + 6 * markers, 6 + 6 * markers);
  information.topLeftCorner<6, 6>() = scene_.priorAt(truth_).information;
  for (int m = 0; m < markers; ++m) {
    const Marker& marker = map_.markers[static_cast<std::size_t>(m)];
    const int first = 6 + 6 * m;
    information.diagonal().segment<3>(first).array() += 1.0 / (marker.deviation * marker.deviation);
    information.diagonal().segment<3>(first + 3).array() +=
        1.0 / (marker.orientation_deviation * marker.orientation_deviation);
    const TagPattern pattern(marker);
    const double module = marker.size / pattern.widthBetweenCorners();
    const auto addEdge = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
      const auto onMarker = [&](const Eigen::Vector2d& place) -> Eigen::Vector2d {
        return module * Eigen::Vector2d(place.x() - 0.5 * pattern.width(),
                                        0.5 * pattern.width() - place.y());
      };
      const Eigen::Vector2d middle = onMarker(0.5 * (from + to));
      using Change = Eigen::Matrix<double, 12, 1>;
      const auto pixel = [&](const Eigen::Vector2d& place, const Change& change) {
        return pixelAfter(camera_, truth_, marker, place, change);
      };
      const Eigen::Vector2d along =
          pixel(onMarker(to), Change::Zero()) - pixel(onMarker(from), Change::Zero());
      const double length = along.norm();
      const Eigen::RowVector2d normal = Eigen::RowVector2d(-along.y(), along.x()) / length;
      // The distance to the next edge that is parallel to this one.
      const Eigen::Vector2d side(to.y() - from.y(), to.x() - from.x());
      const double width = std::abs(
          normal * (pixel(middle + module * side, Change::Zero()) - pixel(middle, Change::Zero())));
      const double phase = 0.5 * kPi / width;
      const double transfer = std::sin(phase) / phase;
      Eigen::Matrix<double, 1, 12> row;
      for (int i = 0; i < 12; ++i) {
        constexpr double kStep = 1e-6;
        row(i) =
            (normal *
             (pixel(middle, kStep * Change::Unit(i)) - pixel(middle, -kStep * Change::Unit(i))) /
             (2.0 * kStep))(0);
      }
      Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(information.cols());
      all.head<6>() = row.head<6>();
      all.segment<6>(first) = row.tail<6>();
      const double noise = scene_.config.edge_noise;
      information += transfer * transfer * length / (noise * noise) * all.transpose() * all;
    };
    for (int i = 0; i < pattern.width(); ++i) {
      for (int k = 0; k + 1 < pattern.width(); ++k) {
        if (pattern.whiteAt(k, i) != pattern.whiteAt(k + 1, i)) {
          addEdge({k + 1.0, i}, {k + 1.0, i + 1.0});
        }
        if (pattern.whiteAt(i, k) != pattern.whiteAt(i, k + 1)) {
          addEdge({i, k + 1.0}, {i + 1.0, k + 1.0});
        }
      }
    }
  }
  const Eigen::MatrixXd covariance = information.inverse();
  const PoseEstimate estimate = predicted();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(estimate.covariance(i, i)), std::sqrt(covariance(i, i)),
                0.05 * std::sqrt(covariance(i, i)))
        << i;
  }
}

TEST_F(ExpectedInformationTest, GrowsWithTheNoiseOfEdgesInAnExactMap) {
  for (Marker& marker : map_.markers) marker.deviation = marker.orientation_deviation = 0.0;
  const double exact = positionDeviation(predicted());
  PlanningConfig noisy;
  noisy.edge_noise *= 3.0;
  noisy.localizer.estimation.photometric.alignment_deviation *= 3.0;
  const PlanningScene scene{grid_, camera_, noisy};
  const PosePrediction prediction = PosePredictor(scene, map_).predict(truth_);
  EXPECT_NEAR(positionDeviation(expectedEstimate(scene, prediction.equations, truth_)), 3.0 * exact,
              0.02 * exact);
}

TEST_F(ExpectedInformationTest, IsHowTheEstimatorScatters) {
  // The robot leans, and markers are misplaced; the corners are exact, as the pixels nearly are.
  constexpr int kDraws = test::kIsSanitized ? 30 : 600;
  const PosePrior standing = scene_.priorAt(truth_).withoutPlace();
  const PoseMatrix information = standing.information;
  std::mt19937 generator(8);
  std::normal_distribution<double> normal;
  double position = 0.0;
  double heading = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Pose pose = truth_;
    pose.z = normal(generator) / std::sqrt(information(3, 3));
    pose.roll = normal(generator) / std::sqrt(information(4, 4));
    pose.pitch = normal(generator) / std::sqrt(information(5, 5));
    std::vector<MarkerObservation> observations;
    for (std::size_t i = 0; i < map_.markers.size(); ++i) {
      Marker hung = map_.markers[i];
      Eigen::Vector3d shift;
      Eigen::Vector3d turn;
      for (int k = 0; k < 3; ++k) {
        shift(k) = hung.deviation * normal(generator);
        turn(k) = hung.orientation_deviation * normal(generator);
      }
      hung.map_from_marker = hung.map_from_marker * Eigen::Translation3d(shift) *
                             Eigen::AngleAxisd(turn.norm(), turn.normalized());
      const auto reading = test::exactReading(hung, camera_, pose);
      if (reading) observations.push_back({i, reading->corners, reading->center});
    }
    ReprojectionConfig config;
    config.corner_noise = 0.01;
    const auto fit = refineByReprojection(map_, camera_, observations, truth_, standing, config);
    ASSERT_TRUE(fit);
    const PoseVector error = difference(fit->map_from_base.pose, pose);
    position += error.head<2>().squaredNorm() / kDraws;
    heading += error(2) * error(2) / kDraws;
  }
  const PoseEstimate estimate = predicted();
  const double tolerance = 3.0 / std::sqrt(2.0 * kDraws);
  EXPECT_NEAR(std::sqrt(position) / positionDeviation(estimate), 1.0, tolerance);
  EXPECT_NEAR(std::sqrt(heading / estimate.covariance(2, 2)), 1.0, tolerance);
}

TEST_F(ExpectedInformationTest, WithoutMarkersOnlyThePriorIsKnown) {
  const PoseEstimate estimate = expectedEstimate(scene_, {}, truth_);
  EXPECT_NEAR(positionDeviation(estimate), scene_.config.place_deviation * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(std::sqrt(estimate.covariance(2, 2)), scene_.config.heading_deviation, 1e-6);
}

}  // namespace
}  // namespace omnitag
