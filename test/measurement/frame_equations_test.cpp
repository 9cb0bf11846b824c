#include "measurement/frame_equations.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <vector>

namespace omnitag {
namespace {

constexpr int kRows = 8;  // of a marker
using Rows = Eigen::Matrix<double, kRows, kFrameUnknowns>;

class FrameEquationsTest : public testing::Test {
 protected:
  Eigen::MatrixXd random(int rows, int columns) {
    Eigen::MatrixXd matrix(rows, columns);
    for (int i = 0; i < matrix.size(); ++i) matrix(i) = normal_(generator_);
    return matrix;
  }

  /// Equations of measurements with noise 1.
  static FrameEquations equationsOf(const Rows& by_frame, const Eigen::VectorXd& residuals) {
    FrameEquations equations;
    equations.information = by_frame.transpose() * by_frame;
    equations.gradient = by_frame.transpose() * residuals;
    equations.by_chance = equations.information;
    return equations;
  }

  std::mt19937 generator_{9};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

TEST_F(FrameEquationsTest, MarginalisingIsEstimatingWithThePrior) {
  // Against one large least-squares problem that also estimates each marker's misplacement.
  constexpr int kMarkers = 3;
  const int unknowns = kFrameUnknowns + 6 * kMarkers;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns);
  FrameEquations sum;
  for (int m = 0; m < kMarkers; ++m) {
    const Rows by_frame = random(kRows, kFrameUnknowns);
    const Eigen::VectorXd residuals = random(kRows, 1);
    const PoseMatrix root = random(6, 6);
    const PoseMatrix misplacement = 0.3 * root * root.transpose();
    sum.add(withMisplacement(equationsOf(by_frame, residuals), misplacement), 1.0);
    Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(kRows, unknowns);
    by_all.leftCols(kFrameUnknowns) = by_frame;
    by_all.middleCols(kFrameUnknowns + 6 * m, 6) = by_frame.leftCols<6>();
    information += by_all.transpose() * by_all;
    gradient += by_all.transpose() * residuals;
    information.block(kFrameUnknowns + 6 * m, kFrameUnknowns + 6 * m, 6, 6) +=
        misplacement.inverse();
  }
  information.block(6, 6, kImagingUnknowns, kImagingUnknowns).diagonal().array() += 1.0;
  const Eigen::VectorXd expected = information.ldlt().solve(gradient);
  const auto change = solutionOf(withPriors(sum, PosePrior{}, {}, ImagingError::Zero()));
  ASSERT_TRUE(change);
  EXPECT_LT((*change - expected.head<kFrameUnknowns>()).norm(), 1e-6 * expected.norm());

  // The covariance as well, since all errors are as large as stated.
  const Eigen::MatrixXd covariance = information.inverse();
  const PoseEstimate estimate = estimateOf(sum, PosePrior{}, {}, 1.0);
  EXPECT_LT((estimate.covariance - covariance.topLeftCorner<6, 6>()).norm(),
            1e-6 * estimate.covariance.norm());
}

TEST_F(FrameEquationsTest, AMisplacementOfNothingChangesNothing) {
  const FrameEquations marker = equationsOf(random(kRows, kFrameUnknowns), random(kRows, 1));
  const FrameEquations same = withMisplacement(marker, PoseMatrix::Zero());
  EXPECT_TRUE(same.information.isApprox(marker.information, 1e-12));
  EXPECT_TRUE(same.gradient.isApprox(marker.gradient, 1e-12));
  EXPECT_TRUE(same.by_shared.isZero(1e-12));
}

TEST_F(FrameEquationsTest, MisplacementsOneAfterTheOtherAreTheirSum) {
  const FrameEquations marker = equationsOf(random(kRows, kFrameUnknowns), random(kRows, 1));
  const PoseMatrix a = random(6, 6);
  const PoseMatrix b = random(6, 6);
  const PoseMatrix first = 0.3 * a * a.transpose();
  const PoseMatrix second = 0.2 * b * b.transpose();
  const FrameEquations each = withMisplacement(withMisplacement(marker, first), second);
  const FrameEquations both = withMisplacement(marker, first + second);
  EXPECT_TRUE(each.information.isApprox(both.information, 1e-9));
  EXPECT_TRUE(each.gradient.isApprox(both.gradient, 1e-9));
  EXPECT_TRUE(each.by_chance.isApprox(both.by_chance, 1e-9));
  EXPECT_TRUE(each.by_shared.isApprox(both.by_shared, 1e-9));
}

TEST_F(FrameEquationsTest, AnUnmovedRobotNeverStatesLessThanHalfOfOneImage) {
  Eigen::MatrixXd rows = random(40, kFrameUnknowns);
  FrameEquations image;
  image.information = rows.transpose() * rows;
  image.by_chance = image.information;
  const PoseEstimate alone = estimateOf(image, PosePrior{}, {}, 1.0);
  PoseEstimate estimate = alone;
  for (int i = 0; i < 1000; ++i) {
    estimate = estimateOf(image, PosePrior::about(estimate), {}, 1.0);
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_GE(estimate.covariance(i, i), 0.25 * alone.covariance(i, i)) << i;
    EXPECT_LE(estimate.covariance(i, i), alone.covariance(i, i)) << i;
  }
}

TEST_F(FrameEquationsTest, WhatImagesShareIsNotAveragedDown) {
  // A robot at rest: each image has new random errors and the same misplacements of its markers.
  // Over many robots, the squared error is what the covariance says, or less.
  constexpr int kRobots = 300;
  constexpr int kImages = 30;
  double nees = 0.0;
  double least_deviation = 1e9;
  for (int robot = 0; robot < kRobots; ++robot) {
    std::vector<Rows> by_frame;
    std::vector<Eigen::VectorXd> shared;
    const PoseMatrix misplacement = 4.0 * PoseMatrix::Identity();
    for (int m = 0; m < 6; ++m) {
      by_frame.emplace_back(random(kRows, kFrameUnknowns));
      by_frame.back().rightCols<6>().setZero();
      shared.emplace_back(by_frame.back().leftCols<6>() * (2.0 * random(6, 1)));
    }
    std::optional<PoseEstimate> estimate;
    PoseVector mean = PoseVector::Zero();
    for (int i = 0; i < kImages; ++i) {
      FrameEquations sum;
      for (std::size_t m = 0; m < by_frame.size(); ++m) {
        // Measurements from the estimate so far; the truth is zero.
        const Eigen::VectorXd residuals =
            shared[m] + random(kRows, 1) - by_frame[m].leftCols<6>() * mean;
        sum.add(withMisplacement(equationsOf(by_frame[m], residuals), misplacement), 1.0);
      }
      const PosePrior prior =
          estimate ? PosePrior::about({{}, estimate->covariance, estimate->shared}) : PosePrior{};
      const auto change = solutionOf(withPriors(sum, prior, {}, ImagingError::Zero()));
      ASSERT_TRUE(change);
      mean += change->head<6>();
      estimate = estimateOf(sum, prior, {}, 1.0);
    }
    nees += mean.dot(estimate->covariance.ldlt().solve(mean)) / kRobots;
    least_deviation = std::min(least_deviation, std::sqrt(estimate->covariance.trace()));
  }
  EXPECT_LT(nees, 6.0 + 1.96 * std::sqrt(12.0 / kRobots));
  EXPECT_GT(nees, 2.0) << "not for nothing";
  EXPECT_GT(least_deviation, 0.5) << "six markers of 2 units leave about one";
}

}  // namespace
}  // namespace omnitag
