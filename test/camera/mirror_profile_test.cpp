#include "camera/mirror_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Eigen::Vector2d> sampled(const std::function<double(double)>& sag, double first,
                                     double last, int count) {
  std::vector<Eigen::Vector2d> samples;
  for (int i = 0; i < count; ++i) {
    const double rho = first + (last - first) * i / (count - 1);
    samples.emplace_back(rho, sag(rho));
  }
  return samples;
}

double sphereSag(double rho) { return 0.04 - std::sqrt(0.04 * 0.04 - rho * rho); }

void expectDerivatives(const MirrorProfile& profile, double first, double last) {
  constexpr double kStep = 1e-6;
  for (double rho = first + 2 * kStep; rho < last - 2 * kStep; rho += (last - first) / 37.0) {
    const MirrorProfile::Point point = profile.at(rho);
    const MirrorProfile::Point ahead = profile.at(rho + kStep);
    const MirrorProfile::Point behind = profile.at(rho - kStep);
    EXPECT_NEAR(point.slope, (ahead.sag - behind.sag) / (2.0 * kStep), 1e-7) << rho;
    EXPECT_NEAR(point.curvature, (ahead.slope - behind.slope) / (2.0 * kStep),
                1e-6 * std::abs(point.curvature) + 1e-4)
        << rho;
  }
}

TEST(Conic, liesOnItsImplicitCurve) {
  for (const double radius : {1e-4, 0.03, 50.0, 1e6}) {
    for (const double k : {-1e3, -1.6, -1.0, -0.4, 0.0, 2.0}) {
      const MirrorProfile profile = MirrorProfile::conic(radius, k);
      const double last = std::min(profile.maxRho(), 3.0 * radius);
      for (double share = 0.0; share < 1.0; share += 0.03) {
        const double rho = share * last;
        const double s = profile.at(rho).sag;
        const double residual = rho * rho + (1.0 + k) * s * s - 2.0 * radius * s;
        EXPECT_NEAR(residual, 0.0, 1e-14 * (rho * rho + 2.0 * radius * s)) << radius << " " << k;
      }
    }
  }
}

TEST(Conic, isTheCircleForTheConstantZero) {
  const MirrorProfile profile = MirrorProfile::conic(0.04, 0.0);
  for (const double rho : {0.0, 1e-9, 0.01, 0.03, 0.0399}) {
    EXPECT_NEAR(profile.at(rho).sag, sphereSag(rho), 1e-16);
  }
  EXPECT_EQ(profile.maxRho(), 0.04);
}

TEST(Conic, keepsItsDigitsNearTheAxis) {
  // For small rho the sag is rho^2 / (2 R); 0.04 - sqrt(...) would leave nothing of it.
  EXPECT_NEAR(MirrorProfile::conic(0.04, 0.0).at(1e-10).sag, 1.25e-19, 1e-33);
}

TEST(Conic, endsWhereItTurnsBack) {
  EXPECT_EQ(MirrorProfile::conic(0.04, -1.0).maxRho(), kInfinity);
  EXPECT_EQ(MirrorProfile::conic(0.04, -2.0).maxRho(), kInfinity);
  EXPECT_DOUBLE_EQ(MirrorProfile::conic(0.04, 3.0).maxRho(), 0.02);
  EXPECT_EQ(MirrorProfile::conic(0.04, 3.0).minRho(), 0.0);
}

TEST(Conic, addsEvenPowers) {
  const MirrorProfile base = MirrorProfile::conic(0.04, -0.5);
  const MirrorProfile aspheric = MirrorProfile::conic(0.04, -0.5, {-300.0, 2e4, 5e6});
  for (const double rho : {0.0, 0.005, 0.02, 0.035}) {
    const double added =
        -300.0 * std::pow(rho, 4) + 2e4 * std::pow(rho, 6) + 5e6 * std::pow(rho, 8);
    EXPECT_NEAR(aspheric.at(rho).sag - base.at(rho).sag, added, 1e-17);
  }
}

TEST(Conic, hasTheDerivativesOfItsSag) {
  for (const double k : {-2.0, -1.0, 0.0}) {
    expectDerivatives(MirrorProfile::conic(0.04, k), 0.0, 0.036);
    expectDerivatives(MirrorProfile::conic(0.04, k, {-300.0, 2e4}), 0.0, 0.036);
  }
}

TEST(Table, passesThroughItsSamples) {
  const std::vector<Eigen::Vector2d> samples = {
      {0.0, 0.002}, {0.003, 0.0021}, {0.011, 0.004}, {0.012, 0.0044}, {0.03, 0.02}};
  const MirrorProfile profile = MirrorProfile::tabulated(samples);
  for (const Eigen::Vector2d& sample : samples) {
    EXPECT_NEAR(profile.at(sample.x()).sag, sample.y(), 1e-16);
  }
  EXPECT_EQ(profile.minRho(), 0.0);
  EXPECT_EQ(profile.maxRho(), 0.03);
}

TEST(Table, isSmoothAcrossItsSamplesAndFlatOnTheAxis) {
  const MirrorProfile profile = MirrorProfile::tabulated(sampled(sphereSag, 0.0, 0.036, 10));
  EXPECT_EQ(profile.at(0.0).slope, 0.0);
  for (int i = 1; i < 9; ++i) {
    const double rho = 0.004 * i;
    const MirrorProfile::Point below = profile.at(rho - 1e-12);
    const MirrorProfile::Point above = profile.at(rho + 1e-12);
    EXPECT_NEAR(below.slope, above.slope, 1e-9);
    EXPECT_NEAR(below.curvature, above.curvature, 1e-6);
  }
  expectDerivatives(profile, 0.0, 0.036);
}

TEST(Table, isExactForACubic) {
  const auto cubic = [](double rho) { return 0.001 + 7.0 * rho * rho + 90.0 * rho * rho * rho; };
  const auto beginsOffAxis = [&](double rho) { return cubic(rho) + 0.3 * rho; };
  const MirrorProfile from_axis = MirrorProfile::tabulated(sampled(cubic, 0.0, 0.03, 4));
  const MirrorProfile ring = MirrorProfile::tabulated(sampled(beginsOffAxis, 0.01, 0.03, 4));
  EXPECT_EQ(ring.minRho(), 0.01);
  for (double rho = 0.01; rho <= 0.03; rho += 0.001) {
    EXPECT_NEAR(from_axis.at(rho).sag, cubic(rho), 1e-15);
    EXPECT_NEAR(from_axis.at(rho).curvature, 14.0 + 540.0 * rho, 1e-9);
    EXPECT_NEAR(ring.at(rho).sag, beginsOffAxis(rho), 1e-15);
  }
}

/// Greatest distance between a sphere and the spline through its samples.
double splineError(int count, double first, double last) {
  const MirrorProfile profile = MirrorProfile::tabulated(sampled(sphereSag, first, last, count));
  double error = 0.0;
  for (double share = 0.0; share <= 1.0; share += 1e-4) {
    const double rho = first + share * (last - first);
    error = std::max(error, std::abs(profile.at(rho).sag - sphereSag(rho)));
  }
  return error;
}

TEST(Table, followsASphereWithTheFourthPowerOfTheSamplesDistance) {
  // Hall and Meyer: with the slopes at both ends given, a cubic spline errs by at most
  // 5/384 h^4 times the largest fourth derivative. The outer slope is estimated here, which costs a
  // small factor.
  const double last = 0.03;
  const double fourth_derivative =
      3.0 * 0.0016 * (0.0016 + 4.0 * last * last) / std::pow(0.0016 - last * last, 3.5);
  for (const int count : {10, 40, 100, 400}) {
    const double bound = 5.0 / 384.0 * std::pow(last / (count - 1), 4) * fourth_derivative;
    EXPECT_LT(splineError(count, 0.0, last), 3.0 * bound) << count;
    EXPECT_LT(splineError(count, 0.006, last), 3.0 * bound) << count;
  }
}

TEST(Table, takesManySamplesInItsStride) { EXPECT_LT(splineError(20000, 0.0, 0.03), 1e-15); }

std::string refusalOf(const std::vector<Eigen::Vector2d>& samples) {
  try {
    MirrorProfile::tabulated(samples);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Table, refusesWhatIsNoProfile) {
  EXPECT_EQ(refusalOf({{0.0, 0.0}, {1.0, 0.1}, {2.0, 0.4}}),
            "expected at least 4 samples [rho, sag], found 3");
  EXPECT_EQ(refusalOf({}), "expected at least 4 samples [rho, sag], found 0");
  EXPECT_EQ(
      refusalOf({{0.0, 0.0}, {2.0, 0.1}, {2.0, 0.4}, {3.0, 0.9}}),
      "expected samples [rho, sag] with rho increasing from >= 0, found [2, 0.4] after rho 2");
  EXPECT_EQ(refusalOf({{-1.0, 0.0}, {1.0, 0.1}, {2.0, 0.4}, {3.0, 0.9}}),
            "expected samples [rho, sag] with rho increasing from >= 0, found [-1, 0]");
  EXPECT_NE(refusalOf({{0.0, 0.0}, {kNaN, 0.1}, {2.0, 0.4}, {3.0, 0.9}}), "");
  EXPECT_NE(refusalOf({{0.0, 0.0}, {1.0, 0.1}, {2.0, kNaN}, {3.0, 0.9}}), "");
  EXPECT_NE(refusalOf({{0.0, 0.0}, {1.0, 0.1}, {2.0, 0.4}, {kInfinity, 0.9}}), "");
}

}  // namespace
}  // namespace omnitag
