#include "common/correlation_threshold.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Share of the sphere in n dimensions that is within acos(t) of a given direction, by Simpson's
/// rule over the angle: the area of a slice is proportional to sin^(n - 2).
double capShare(int n, double t) {
  const auto integral = [n](double until) {
    constexpr int kSteps = 20000;
    double sum = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const int weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
      sum += weight * std::pow(std::sin(until * i / kSteps), n - 2);
    }
    return sum * until / (3.0 * kSteps);
  };
  return integral(std::acos(t)) / integral(kPi);
}

TEST(CorrelationThresholdTest, TheCapHasNoMoreOfTheSphereThanTheRate) {
  for (const int n : {2, 3, 4, 8, 16, 36, 60}) {
    for (const double rate : {0.3, 0.1, 1e-2, 1e-4, 1e-6, 1e-8}) {
      const double threshold = correlationThreshold(n, rate);
      const double share = capShare(n, threshold);
      EXPECT_LE(share, rate * (1.0 + 1e-6)) << n << ", " << rate;
      // The bound gives away no more than a factor of sqrt(pi n / 2).
      EXPECT_GE(share * std::sqrt(0.5 * kPi * n), rate * (1.0 - 1e-6)) << n << ", " << rate;
    }
  }
}

TEST(CorrelationThresholdTest, RandomPatternsReachItNoMoreOftenThanTheRate) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  for (const int n : {2, 5, 20, 36}) {
    constexpr double kRate = 0.01;
    const double threshold = correlationThreshold(n, kRate);
    constexpr int kTrials = 100000;
    int reached = 0;
    for (int i = 0; i < kTrials; ++i) {
      Eigen::VectorXd pattern(n);
      for (int k = 0; k < n; ++k) pattern[k] = normal(generator);
      reached += pattern[0] >= threshold * pattern.norm() ? 1 : 0;
    }
    const double expected = kRate * kTrials;
    EXPECT_LT(reached, expected + 4.0 * std::sqrt(expected)) << n;
    EXPECT_GT(reached, expected / 20.0) << n;
  }
}

TEST(CorrelationThresholdTest, WithoutASecondDimensionNothingIsEnough) {
  EXPECT_EQ(correlationThreshold(1.0, 0.01), 1.0);
  EXPECT_EQ(correlationThreshold(0.3, 0.01), 1.0);
  EXPECT_EQ(correlationThreshold(20.0, 0.5), 0.0);
  EXPECT_EQ(correlationThreshold(20.0, 1.0), 0.0);
  double last = 1.0;
  for (const double dimensions : {2.0, 3.0, 7.5, 20.0, 50.0}) {
    const double threshold = correlationThreshold(dimensions, 1e-5);
    EXPECT_LT(threshold, last);
    last = threshold;
  }
}

}  // namespace
}  // namespace omnitag
