#include "planning/greedy_choice.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

namespace omnitag {
namespace {

/// Candidates that each add something of rank 4 to about half of the poses.
class GreedyChoiceTest : public testing::Test {
 protected:
  void SetUp() override {
    problem_.known.assign(5, 0.3 * FrameMatrix::Identity());
    problem_.candidates = 9;
    added_.resize(problem_.candidates);
    std::normal_distribution<double> normal;
    for (std::size_t c = 0; c < added_.size(); ++c) {
      for (std::size_t pose = 0; pose < problem_.known.size(); ++pose) {
        if ((c + pose) % 2 == 0) continue;
        Eigen::Matrix<double, 4, kFrameUnknowns> rows;
        for (int i = 0; i < rows.size(); ++i) rows(i) = normal(generator_);
        const double scale = 1.0 + static_cast<double>(c % 4);
        added_[c].push_back({pose, scale * rows.transpose() * rows});
      }
    }
    problem_.addedBy = [this](std::size_t candidate) { return added_[candidate]; };
  }

  double measureOf(const std::vector<std::size_t>& choice) const {
    std::vector<FrameMatrix> sums = problem_.known;
    for (const std::size_t candidate : choice) {
      for (const AddedInformation& added : added_[candidate]) sums[added.pose] += added.information;
    }
    double measure = 0.0;
    for (const FrameMatrix& sum : sums) measure += std::log(sum.determinant());
    return measure;
  }

  /// The largest measure of any choice of three.
  double best() const {
    double best = -1e9;
    for (std::size_t a = 0; a < added_.size(); ++a) {
      for (std::size_t b = a + 1; b < added_.size(); ++b) {
        for (std::size_t c = b + 1; c < added_.size(); ++c) {
          best = std::max(best, measureOf({a, b, c}));
        }
      }
    }
    return best;
  }

  std::mt19937 generator_{5};
  InformationProblem problem_;
  std::vector<std::vector<AddedInformation>> added_;
};

TEST_F(GreedyChoiceTest, TakesTheBestOneOfThoseLeftEachTime) {
  const GreedyChoice choice = chooseGreedily(problem_, 4, 2);
  ASSERT_EQ(choice.candidates.size(), 4U);
  std::vector<std::size_t> chosen;
  for (std::size_t step = 0; step < 4; ++step) {
    double largest = -1e9;
    std::size_t next = 0;
    for (std::size_t c = 0; c < added_.size(); ++c) {
      if (std::count(chosen.begin(), chosen.end(), c) > 0) continue;
      std::vector<std::size_t> with = chosen;
      with.push_back(c);
      const double gain = measureOf(with) - measureOf(chosen);
      if (gain <= largest) continue;
      largest = gain;
      next = c;
    }
    EXPECT_EQ(choice.candidates[step], next);
    EXPECT_NEAR(choice.gains[step], largest, 1e-9);
    chosen.push_back(next);
  }
}

TEST_F(GreedyChoiceTest, ItsShareOfTheBestChoiceIsGuaranteed) {
  const double none = measureOf({});
  const GreedyChoice choice = chooseGreedily(problem_, 3, 1);
  const double share = (measureOf(choice.candidates) - none) / (best() - none);
  EXPECT_LE(choice.guaranteed_share, share);
  EXPECT_GE(choice.guaranteed_share, 1.0 - std::exp(-1.0));
  EXPECT_LE(share, 1.0);
}

TEST_F(GreedyChoiceTest, OneIsTheBestOne) {
  const GreedyChoice choice = chooseGreedily(problem_, 1, 1);
  for (std::size_t c = 0; c < added_.size(); ++c) {
    EXPECT_LE(measureOf({c}), measureOf(choice.candidates) + 1e-12);
  }
}

TEST_F(GreedyChoiceTest, WhatAddsNothingIsNotChosen) {
  for (std::size_t c = 2; c < added_.size(); ++c) added_[c].clear();
  const GreedyChoice choice = chooseGreedily(problem_, 5, 1);
  EXPECT_EQ(choice.candidates.size(), 2U);
  EXPECT_DOUBLE_EQ(choice.guaranteed_share, 1.0);
}

}  // namespace
}  // namespace omnitag
