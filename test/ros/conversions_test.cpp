#include "ros/conversions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

geometry_msgs::Pose poseMessage(double x, double y, double z, double qx, double qy, double qz,
                                double qw) {
  geometry_msgs::Pose pose;
  pose.position.x = x;
  pose.position.y = y;
  pose.position.z = z;
  pose.orientation.x = qx;
  pose.orientation.y = qy;
  pose.orientation.z = qz;
  pose.orientation.w = qw;
  return pose;
}

TEST(Conversions, PoseOnTheFloor) {
  const geometry_msgs::Pose pose = toMessage(Pose{1.0, -2.0, M_PI / 2.0});
  EXPECT_EQ(pose.position.x, 1.0);
  EXPECT_EQ(pose.position.y, -2.0);
  EXPECT_EQ(pose.position.z, 0.0);
  EXPECT_NEAR(pose.orientation.z, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(pose.orientation.w, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(pose.orientation.x, 0.0);
  EXPECT_EQ(pose.orientation.y, 0.0);
}

TEST(Conversions, TransformAndBack) {
  const Eigen::Isometry3d transform =
      Eigen::Translation3d(1.0, 2.0, 3.0) *
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized());
  EXPECT_TRUE(fromMessage(toMessage(transform)).isApprox(transform, 1e-14));
}

TEST(Conversions, CovarianceStandsWhereRosExpectsIt) {
  Eigen::Matrix3d on_floor;
  on_floor << 4.0, 0.1, 0.2, 0.1, 9.0, 0.3, 0.2, 0.3, 0.5;
  PoseEstimate estimate = floorEstimate({}, on_floor);
  estimate.covariance.diagonal().tail<3>() << 0.6, 0.7, 0.8;
  const geometry_msgs::PoseWithCovariance message = toMessage(estimate);
  const auto at = [&message](std::size_t row, std::size_t column) {
    return message.covariance[6 * row + column];
  };
  EXPECT_EQ(at(0, 0), 4.0);
  EXPECT_EQ(at(0, 1), 0.1);
  EXPECT_EQ(at(1, 1), 9.0);
  EXPECT_EQ(at(5, 5), 0.5);
  EXPECT_EQ(at(0, 5), 0.2);
  EXPECT_EQ(at(5, 1), 0.3);
  EXPECT_EQ(at(2, 2), 0.6);
  EXPECT_EQ(at(3, 3), 0.7);
  EXPECT_EQ(at(4, 4), 0.8);
  const std::optional<Eigen::Matrix3d> back = planarCovariance(message);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->isApprox(on_floor));
}

TEST(Conversions, RotationsAreAboutTheAxesOfTheMap) {
  // Compares with samples: rotations about the base's own axes, expressed as rotations about the
  // map's.
  PoseEstimate estimate{{0.0, 0.0, 1.2, 0.0, 0.3, -0.4}};
  estimate.covariance.diagonal() << 1.0, 1.0, 1e-4, 1.0, 4e-4, 9e-4;
  const Eigen::Matrix3d map_from_base = estimate.pose.toIsometry().linear();
  std::mt19937 generator(4);
  std::normal_distribution<double> normal(0.0, 1.0);
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    PoseVector change = PoseVector::Zero();
    change[2] = 1e-2 * normal(generator);
    change[4] = 2e-2 * normal(generator);
    change[5] = 3e-2 * normal(generator);
    const Eigen::AngleAxisd turn(moved(estimate.pose, change).toIsometry().linear() *
                                 map_from_base.transpose());
    const Eigen::Vector3d about_map = turn.angle() * turn.axis();
    sampled += about_map * about_map.transpose() / kSamples;
  }
  const geometry_msgs::PoseWithCovariance message = toMessage(estimate);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      EXPECT_NEAR(message.covariance[6 * (row + 3) + column + 3],
                  sampled(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)), 3e-5);
    }
  }
}

TEST(Conversions, CovarianceThatWasNotFilledIn) {
  geometry_msgs::PoseWithCovariance message;
  EXPECT_FALSE(planarCovariance(message)) << "zeros";
  message = toMessage(PoseEstimate{{}, PoseMatrix::Identity()});
  message.covariance[35] = kNaN;
  EXPECT_FALSE(planarCovariance(message)) << "NaN";
  message.covariance[35] = -1.0;
  EXPECT_FALSE(planarCovariance(message)) << "negative";
  message.covariance[35] = 1.0;
  message.covariance[1] = message.covariance[6] = 2.0;
  EXPECT_FALSE(planarCovariance(message)) << "correlation above 1";
}

TEST(Conversions, RefusesPosesThatAreNone) {
  EXPECT_NO_THROW(fromMessage(poseMessage(1, 2, 0, 0, 0, 0, 1)));
  EXPECT_THROW(fromMessage(poseMessage(kNaN, 2, 0, 0, 0, 0, 1)), InputError);
  EXPECT_THROW(fromMessage(poseMessage(1, 2, 0, 0, 0, kNaN, 1)), InputError);
  EXPECT_THROW(fromMessage(poseMessage(1, 2, 0, 0, 0, 0, 0)), InputError);
  EXPECT_THROW(fromMessage(poseMessage(1, INFINITY, 0, 0, 0, 0, 1)), InputError);
  EXPECT_THROW(fromMessage(poseMessage(1, 2, 0, 0, 0, 0, 1.1)), InputError);
}

TEST(Conversions, Detections) {
  MarkerMap map;
  map.markers.resize(2);
  map.markers[1].name = "door";
  MarkerDetection known;
  known.family = "tag36h11";
  known.id = 7;
  known.map_entry = 1;
  known.accepted = true;
  known.sight = {0.6, 0.0, -0.8};
  known.hamming = 1;
  known.margin = 50.0;
  known.range = 3.0;
  known.residual = 0.1;
  known.corners = {Eigen::Vector2d(1, 2), {3, 4}, {5, 6}, {7, 8}};
  MarkerDetection unknown;
  unknown.reason = "not expected here";
  unknown.range = kNaN;

  std_msgs::Header header;
  header.frame_id = "camera";
  const MarkerDetectionArray message = toMessage(header, {known, unknown}, map);
  EXPECT_EQ(message.header.frame_id, "camera");
  ASSERT_EQ(message.detections.size(), 2U);
  const DetectedMarker& first = message.detections[0];
  EXPECT_EQ(first.id, 7);
  EXPECT_EQ(first.name, "door");
  EXPECT_EQ(first.map_entry, 1);
  EXPECT_TRUE(first.accepted);
  EXPECT_EQ(first.bearing.x, 0.6);
  EXPECT_EQ(first.bearing.z, -0.8);
  EXPECT_EQ(first.hamming, 1);
  EXPECT_EQ(first.margin, 50.0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(first.corners[i].x, static_cast<double>(2 * i + 1));
    EXPECT_EQ(first.corners[i].y, static_cast<double>(2 * i + 2));
  }
  const DetectedMarker& second = message.detections[1];
  EXPECT_EQ(second.map_entry, -1);
  EXPECT_FALSE(second.accepted);
  EXPECT_EQ(second.reason, "not expected here");
  EXPECT_TRUE(std::isnan(second.range));
  EXPECT_TRUE(std::isnan(second.bearing.y)) << "no line of sight";
  EXPECT_EQ(second.hamming, -1) << "not decoded";
  EXPECT_TRUE(std::isnan(second.margin)) << "not decoded";
}

TEST(Conversions, Status) {
  FrameResult result;
  result.mode = Mode::kDeadReckoning;
  result.map_from_base.emplace();
  result.map_from_base->covariance(0, 0) = 9e-4;
  result.map_from_base->covariance(1, 1) = 1e-4;
  result.map_from_base->covariance(2, 2) = 4e-4;
  result.predicted.resize(5);
  result.detections.resize(3);
  result.detections[0].accepted = true;
  result.timings.decode = 0.025;
  result.blur.turn_square = 0.04;
  result.hypotheses.resize(2);
  result.hypotheses[0].probability = 0.7;
  result.hypotheses[1].probability = 0.2;
  result.hypotheses[1].map_from_base.pose.x = 3.0;
  result.hypotheses[1].map_from_base.pose.z = 0.01;
  const LocalizationStatus message = toMessage(std_msgs::Header(), result);
  EXPECT_EQ(message.mode, LocalizationStatus::DEAD_RECKONING);
  EXPECT_TRUE(message.has_pose);
  EXPECT_EQ(message.markers_predicted, 5U);
  EXPECT_EQ(message.markers_detected, 3U);
  EXPECT_EQ(message.markers_used, 1U);
  EXPECT_NEAR(message.position_deviation, std::sqrt(1e-3), 1e-12);
  EXPECT_NEAR(message.heading_deviation, 0.02, 1e-12);
  EXPECT_DOUBLE_EQ(message.decode_time, 0.025) << "seconds";
  EXPECT_DOUBLE_EQ(message.blur_turn, 0.2) << "radians";
  ASSERT_EQ(message.hypotheses.size(), 2U);
  EXPECT_DOUBLE_EQ(message.hypotheses[1].position.x, 3.0);
  EXPECT_DOUBLE_EQ(message.hypotheses[1].position.z, 0.0) << "on a floor";
  EXPECT_EQ(message.probabilities, (std::vector<double>{0.7, 0.2}));
}

}  // namespace
}  // namespace omnitag
