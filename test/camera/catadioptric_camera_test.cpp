#include "camera/catadioptric_camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <unsupported/Eigen/Polynomials>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "sample_cameras.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class EverySampleCamera : public testing::TestWithParam<SampleCamera> {
 protected:
  const SampleCamera& sample() const { return GetParam(); }
  const CatadioptricCamera& camera() const { return GetParam().camera; }

  /// Calls `check` for positions all over the image.
  template <typename Check>
  void forEachPixel(double step, Check check) const {
    const ImageSize size = camera().imageSize();
    for (double v = -0.499; v < size.height - 0.5; v += step) {
      for (double u = -0.499; u < size.width - 0.5; u += step) check(Eigen::Vector2d(u, v));
    }
  }

  /// A unit normal of the surface at a point of it, by numeric differentiation.
  Eigen::Vector3d normalAt(const Eigen::Vector3d& origin) const {
    const auto sagAt = [this](long double x, long double y) {
      return sample().sag(std::sqrt(x * x + y * y));
    };
    const long double x = origin.x();
    const long double y = origin.y();
    const long double step = 1e-6L * sample().outer_radius;
    const long double by_x = (sagAt(x + step, y) - sagAt(x - step, y)) / (2.0L * step);
    const long double by_y = (sagAt(x, y + step) - sagAt(x, y - step)) / (2.0L * step);
    return Eigen::Vector3d(static_cast<double>(by_x), static_cast<double>(by_y), -1.0).normalized();
  }

  /// Where on the mirror the light from a point at (distance, height) to the lens is reflected, by
  /// Fermat's principle alone: the shortest way over a convex mirror. Nothing where the shortest
  /// way leads over the mirror's edge or through the mirror.
  std::optional<double> reflectionByFermat(double distance, double height) const {
    const auto pathLength = [&](long double rho) {
      const long double z = sample().apex_distance + sample().sag(rho);
      return std::hypot(rho, z) + std::hypot(distance - rho, height - z);
    };
    constexpr int kScan = 500;
    const long double inner = sample().inner_radius;
    const long double step = (sample().outer_radius - inner) / kScan;
    int best = 0;
    for (int i = 1; i <= kScan; ++i) {
      if (pathLength(inner + i * step) < pathLength(inner + best * step)) best = i;
    }
    const long double outer = sample().outer_radius;
    long double low = std::max(inner, inner + (best - 1) * step);
    long double high = std::min(outer, inner + (best + 1) * step);
    const long double golden = (std::sqrt(5.0L) - 1.0L) / 2.0L;
    while (high - low > 1e-12L * outer) {
      const long double a = high - golden * (high - low);
      const long double b = low + golden * (high - low);
      (pathLength(a) < pathLength(b) ? high : low) = pathLength(a) < pathLength(b) ? b : a;
    }
    const auto rho = static_cast<double>((low + high) / 2.0L);
    const double edge = 1e-7 * sample().outer_radius;
    if (rho > sample().outer_radius - edge) return std::nullopt;
    if (inner > 0.0L && rho < sample().inner_radius + edge) return std::nullopt;
    const Eigen::Vector3d origin(rho, 0.0, sample().height(rho));
    const bool in_front =
        normalAt(origin).dot(Eigen::Vector3d(distance, 0.0, height) - origin) > 0.0;
    return in_front ? std::optional(rho) : std::nullopt;
  }
};

TEST_P(EverySampleCamera, showsExactlyTheRingOfTheMirror) {
  const double outer = sample().outer_radius / sample().height(sample().outer_radius);
  const double inner = sample().inner_radius / sample().height(sample().inner_radius);
  EXPECT_NEAR(camera().maxRadius(), outer, 1e-6 * outer);
  if (camera().mirror().housing_radius == 0.0) {
    EXPECT_NEAR(camera().minRadius(), inner, 1e-6 * outer);
  }
  for (const double azimuth : {0.0, 0.7, 2.2, 4.0, 5.5}) {
    const Eigen::Vector2d radial(std::cos(azimuth), std::sin(azimuth));
    const auto sees = [&](double radius) {
      const Eigen::Vector2d pixel = camera().imagePlane().pixelFromIdeal(radius * radial);
      const bool is_seen = camera().rayFromPixel(pixel).has_value();
      EXPECT_TRUE(camera().isInImage(pixel) || !is_seen);
      return is_seen || !camera().isInImage(pixel);
    };
    EXPECT_TRUE(sees((1.0 - 1e-5) * outer));
    EXPECT_TRUE(sees(camera().minRadius() + 1e-5 * outer));
    const Eigen::Vector2d beyond =
        camera().imagePlane().pixelFromIdeal((1.0 + 1e-5) * outer * radial);
    EXPECT_FALSE(camera().rayFromPixel(beyond));
    if (camera().minRadius() > 0.0) {
      const Eigen::Vector2d blind =
          camera().imagePlane().pixelFromIdeal((1.0 - 1e-5) * camera().minRadius() * radial);
      EXPECT_FALSE(camera().rayFromPixel(blind));
    }
  }
}

TEST_P(EverySampleCamera, reflectsInSpaceOnItsSurface) {
  forEachPixel(6.3, [&](const Eigen::Vector2d& pixel) {
    const std::optional<Ray> ray = camera().rayFromPixel(pixel);
    if (!ray) return;
    const double rho = ray->origin.head<2>().norm();
    if (rho < sample().inner_radius + 1e-5 || rho > sample().outer_radius - 1e-5) return;
    ASSERT_NEAR(ray->origin.z(), sample().height(rho), sample().surface_tolerance);

    const Eigen::Vector2d lens_pixel =
        camera().imagePlane().pixelFromIdeal(ray->origin.head<2>() / ray->origin.z());
    ASSERT_LT((lens_pixel - pixel).norm(), 1e-9);

    const Eigen::Vector3d incoming = ray->origin.normalized();
    const Eigen::Vector3d normal = normalAt(ray->origin);
    const Eigen::Vector3d reflected = incoming - 2.0 * normal.dot(incoming) * normal;
    const double tolerance = 1e-8 + 1e4 * sample().surface_tolerance;
    ASSERT_LT((reflected - ray->direction).norm(), tolerance) << pixel.transpose();
  });
}

TEST_P(EverySampleCamera, takesTheShortestWay) {
  if (camera().mirror().housing_radius > 0.0) GTEST_SKIP() << "the oracle knows no housing";
  std::mt19937 random(7);
  const double size = sample().apex_distance;
  std::uniform_real_distribution<double> exponent(-0.7, 2.0);
  std::uniform_real_distribution<double> angle(0.0, kPi);
  int visible = 0;
  for (int i = 0; i < 300; ++i) {
    const double range = size * std::pow(10.0, exponent(random));
    const double elevation = angle(random);
    const double distance = range * std::sin(elevation);
    const double height = sample().apex_distance - range * std::cos(elevation);
    const std::optional<double> rho = reflectionByFermat(distance, height);
    const std::optional<RadialImage> image = camera().imageFromPoint(distance, height);
    ASSERT_EQ(image.has_value(), rho.has_value()) << distance << " " << height;
    if (!rho) continue;
    ++visible;
    const double radius = *rho / sample().height(*rho);
    const double tolerance = 1e-7 + 1e4 * sample().surface_tolerance;
    ASSERT_NEAR(image->radius, radius, tolerance * camera().maxRadius());
  }
  EXPECT_GT(visible, 20);
}

TEST_P(EverySampleCamera, givesAnImageOnlyToWhatItSees) {
  if (sample().name == "Ball") GTEST_SKIP() << "a silhouette's rays hang by a thread";
  std::mt19937 random(11);
  int visible = 0;
  for (const double box : {1.2 * sample().apex_distance, 5.0, 1e3}) {
    std::uniform_real_distribution<double> coordinate(-box, box);
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3d point(coordinate(random), coordinate(random), coordinate(random));
      const std::optional<Eigen::Vector2d> pixel = camera().pixelFromPoint(point);
      if (!pixel) continue;
      ++visible;
      ASSERT_TRUE(camera().isInImage(*pixel));
      const std::optional<Ray> ray = camera().rayFromPixel(*pixel);
      ASSERT_TRUE(ray);
      const Eigen::Vector3d way = point - ray->origin;
      const double along = way.dot(ray->direction);
      ASSERT_GT(along, 0.0);
      ASSERT_LT(way.cross(ray->direction).norm(), 1e-9 * std::max(1.0, box));
      for (double share = 0.001; share <= 1.0; share *= 1.1) {
        const Eigen::Vector3d passed = ray->origin + share * along * ray->direction;
        const double rho = passed.head<2>().norm();
        if (rho > sample().outer_radius) break;
        ASSERT_LT(passed.z(), sample().height(rho))
            << "through the mirror to " << point.transpose();
      }
    }
  }
  EXPECT_GT(visible, sample().name == "NearlyFlat" ? 10 : 100);
}

TEST_P(EverySampleCamera, seesNothingBehindTheMirrorOrInside) {
  for (double rho = 0.0; rho <= sample().outer_radius; rho += sample().outer_radius / 50.0) {
    for (const double depth : {1e-9, 1e-4, 0.01, 1.0, 1e6}) {
      EXPECT_FALSE(camera().pixelFromPoint({rho, 0.0, sample().height(rho) + depth}))
          << rho << " " << depth;
      EXPECT_FALSE(camera().imageFromPoint(rho, sample().height(rho) + depth));
    }
  }
  EXPECT_FALSE(camera().pixelFromPoint({0.0, 0.0, 1e3}));
}

TEST_P(EverySampleCamera, seesUpToTheRaysAtItsEdges) {
  const MeridionalRay last = *camera().rayFromRadius(camera().maxRadius());
  const MeridionalRay first = *camera().rayFromRadius(camera().minRadius());
  for (const double range : {0.01, 0.5, 20.0}) {
    // A point beside a ray, toward larger elevations if the angle is positive.
    const auto beside = [range](const MeridionalRay& ray, double angle) -> Eigen::Vector2d {
      return ray.origin + range * (Eigen::Rotation2Dd(angle) * ray.direction);
    };
    const Eigen::Vector2d beyond = beside(last, 1e-4);
    const Eigen::Vector2d within = beside(last, -1e-4);
    EXPECT_FALSE(camera().imageFromPoint(beyond.x(), beyond.y()));
    EXPECT_TRUE(camera().imageFromPoint(within.x(), within.y()));
    if (camera().minRadius() == 0.0) continue;
    const Eigen::Vector2d blind = beside(first, -1e-4);
    const Eigen::Vector2d clear = beside(first, 1e-4);
    EXPECT_FALSE(camera().imageFromPoint(blind.x(), blind.y()));
    EXPECT_TRUE(camera().imageFromPoint(clear.x(), clear.y()));
  }
}

INSTANTIATE_TEST_SUITE_P(, EverySampleCamera, testing::ValuesIn(sampleCameras()),
                         [](const auto& info) { return info.param.name; });

CatadioptricCamera cameraWith(MirrorProfile profile, double apex_distance, double rim_radius,
                              double housing_radius = 0.0) {
  return {{500, 500},
          squareLens(1225.0, 249.5),
          {std::move(profile), apex_distance, rim_radius, housing_radius}};
}

/// Where the extensions of a camera's rays come closest to the axis: the height along it.
struct Crossings {
  double lowest = kInfinity;
  double highest = -kInfinity;
};

Crossings axisCrossings(const CatadioptricCamera& camera) {
  Crossings crossings;
  for (double share = 0.01; share < 1.0; share += 0.01) {
    const MeridionalRay ray = *camera.rayFromRadius(share * camera.maxRadius());
    const double height = ray.heightAt(0.0);
    crossings.lowest = std::min(crossings.lowest, height);
    crossings.highest = std::max(crossings.highest, height);
  }
  return crossings;
}

TEST(SingleViewpoint, isTheInnerFocusOfAHyperbolaSeenFromItsOuterFocus) {
  // With K = -e^2 the implicit equation rho^2 + (1 + K) s^2 - 2 R s = 0 becomes
  // ((s + a) / a)^2 - (rho / b)^2 = 1, a = R / (e^2 - 1), b^2 = R^2 / (e^2 - 1): a hyperbola about
  // s = -a. Its foci lie c = sqrt(a^2 + b^2) = R e / (e^2 - 1) to either side, which makes
  // s = c - a = R / (e + 1) behind the mirror and s = -(c + a) = -R / (e - 1) before it.
  for (const double eccentricity : {1.1, 1.3, 2.0}) {
    constexpr double kRadius = 0.03;
    const double apex_distance = kRadius / (eccentricity - 1.0);
    const CatadioptricCamera camera = cameraWith(
        MirrorProfile::conic(kRadius, -eccentricity * eccentricity), apex_distance, 0.035);
    const double viewpoint = apex_distance + kRadius / (eccentricity + 1.0);
    const Crossings crossings = axisCrossings(camera);
    EXPECT_NEAR(crossings.lowest, viewpoint, 1e-12);
    EXPECT_NEAR(crossings.highest, viewpoint, 1e-12);
  }
}

TEST(SingleViewpoint, isApproachedByAParabolaAsTheLensMovesAway) {
  // The focus of rho^2 = 2 R s lies at s = R / 2. Rays that are not quite parallel to the axis
  // miss it by a distance that falls as 1 / apex_distance.
  constexpr double kRadius = 0.03;
  const auto errorAt = [&](double apex_distance) {
    const Crossings crossings =
        axisCrossings(cameraWith(MirrorProfile::conic(kRadius, -1.0), apex_distance, 0.035));
    const double viewpoint = apex_distance + kRadius / 2.0;
    return std::max(viewpoint - crossings.lowest, crossings.highest - viewpoint);
  };
  EXPECT_LT(errorAt(1000.0), 2e-6);
  EXPECT_NEAR(errorAt(100.0) / errorAt(1000.0), 10.0, 0.02);
}

TEST(SingleViewpoint, doesNotExistForASphere) {
  const Crossings crossings =
      axisCrossings(cameraWith(MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375));
  EXPECT_GT(crossings.highest - crossings.lowest, 0.005);
}

/// Alhazen's problem in closed form: radius in the ideal image plane of a point (distance, height)
/// reflected by a ball. In units of the ball's radius and from its centre, the lens is at (0, -a),
/// the point at (x, y), and the point of reflection at n = (sin t, -cos t) with the tangent
/// (cos t, sin t). Equal angles mean
///   (lens . tangent) (point . n - 1) + (point . tangent) (lens . n - 1) = 0, that is,
///   a x cos 2t + a y sin 2t + (a - y) sin t - x cos t = 0,
/// a quartic in u = tan(t / 2).
double radiusByAlhazen(double ball_radius, double apex_distance, double distance, double height) {
  const double a = (apex_distance + ball_radius) / ball_radius;
  const double x = distance / ball_radius;
  const double y = (height - apex_distance - ball_radius) / ball_radius;
  Eigen::Matrix<double, 5, 1> coefficients;
  coefficients << x * (a - 1.0), 4.0 * a * y + 2.0 * (a - y), -6.0 * a * x,
      -4.0 * a * y + 2.0 * (a - y), x * (a + 1.0);
  const Eigen::PolynomialSolver<double, 4> solver(coefficients);
  std::vector<double> roots;
  solver.realRoots(roots, 1e-9);
  double radius = kNaN;
  for (const double u : roots) {
    const double t = 2.0 * std::atan(u);
    const bool lens_in_front = a * std::cos(t) > 1.0;
    const bool point_in_front = x * std::sin(t) - y * std::cos(t) > 1.0;
    if (!(u >= 0.0) || !lens_in_front || !point_in_front) continue;
    EXPECT_TRUE(std::isnan(radius)) << "two reflections";
    radius = ball_radius * std::sin(t) / (apex_distance + ball_radius - ball_radius * std::cos(t));
  }
  return radius;
}

TEST(Sphere, solvesAlhazensProblem) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> range_exponent(-1.0, 1.5);
  std::uniform_real_distribution<double> angle(0.01, 2.2);
  int compared = 0;
  for (const double apex_distance : {0.06, 0.21, 1.0}) {
    const CatadioptricCamera camera =
        cameraWith(MirrorProfile::conic(0.04, 0.0), apex_distance, 0.03);
    for (int i = 0; i < 1000; ++i) {
      const double range = std::pow(10.0, range_exponent(random));
      const double elevation = angle(random);
      const double distance = range * std::sin(elevation);
      const double height = apex_distance - range * std::cos(elevation);
      const std::optional<RadialImage> image = camera.imageFromPoint(distance, height);
      if (!image) continue;
      ++compared;
      ASSERT_NEAR(image->radius, radiusByAlhazen(0.04, apex_distance, distance, height), 1e-9);
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(Axis, isSeenInTheImagesCentreWithACentralDerivative) {
  const CatadioptricCamera camera = cameraWith(MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375);
  Eigen::Matrix<double, 2, 3> jacobian;
  const Eigen::Vector3d point(0.0, 0.0, -1.0);
  const std::optional<Eigen::Vector2d> pixel = camera.pixelFromPoint(point, &jacobian);
  ASSERT_TRUE(pixel);
  EXPECT_EQ(*pixel, Eigen::Vector2d(249.5, 249.5));
  // A ball's virtual image of an object at the distance g before its apex is b = g f / (g + f)
  // behind the apex and, across the axis, smaller by b / g, with f = R / 2.
  const double g = 1.21;
  const double b = g * 0.02 / (g + 0.02);
  const double pixels_per_metre = 1225.0 * (b / g) / (0.21 + b);
  EXPECT_NEAR(jacobian(0, 0), pixels_per_metre, 1e-9);
  EXPECT_NEAR(jacobian(1, 1), pixels_per_metre, 1e-9);
  EXPECT_NEAR(jacobian(0, 1), 0.0, 1e-12);
  EXPECT_NEAR(jacobian(1, 0), 0.0, 1e-12);
  EXPECT_EQ(jacobian.col(2), Eigen::Vector2d::Zero());

  for (const double offset : {1e-300, 1e-18, 1e-12, 1e-8}) {
    Eigen::Matrix<double, 2, 3> beside;
    ASSERT_TRUE(camera.pixelFromPoint({0.6 * offset, 0.8 * offset, -1.0}, &beside)) << offset;
    EXPECT_LT((beside - jacobian).norm(), 1e-5) << offset;
  }
}

TEST(Azimuth, survivesTheReflection) {
  const CatadioptricCamera camera = cameraWith(MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375);
  for (double azimuth = -3.0; azimuth < 3.1; azimuth += 0.37) {
    const Eigen::Vector3d point(1.5 * std::cos(azimuth), 1.5 * std::sin(azimuth), 0.1);
    const Eigen::Vector2d image = *camera.pixelFromPoint(point) - Eigen::Vector2d(249.5, 249.5);
    EXPECT_NEAR(std::atan2(image.y(), image.x()), azimuth, 1e-12);
  }
}

TEST(Housing, hidesTheRaysThatMeetIt) {
  constexpr double kHousing = 0.03;
  const CatadioptricCamera camera =
      cameraWith(MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375, kHousing);
  const MeridionalRay first = *camera.rayFromRadius(camera.minRadius());
  const double distance_at_lens =
      first.origin.x() - first.origin.y() * first.direction.x() / first.direction.y();
  EXPECT_NEAR(distance_at_lens, kHousing, 1e-9);
  EXPECT_FALSE(camera.pixelFromPoint({0.0, 0.0, -1.0}));
  EXPECT_FALSE(camera.pixelFromPoint({0.9 * kHousing, 0.0, 0.0}));
  EXPECT_TRUE(camera.pixelFromPoint({1.1 * kHousing, 0.0, 0.0}));
}

TEST(Housing, mayBeHiddenByAHoleInTheMirror) {
  const auto sag = conicSag(0.04L, 0.0L);
  const double with_hole =
      cameraWith(sampledProfile(sag, 0.01, 0.036, 50), 0.21, 0.035).minRadius();
  for (const double housing : {0.005, 0.02}) {
    const CatadioptricCamera camera =
        cameraWith(sampledProfile(sag, 0.01, 0.036, 50), 0.21, 0.035, housing);
    EXPECT_EQ(camera.minRadius(), with_hole) << housing;
  }
}

std::string refusalOf(MirrorProfile profile, double apex_distance, double rim_radius,
                      double housing_radius = 0.0) {
  try {
    cameraWith(std::move(profile), apex_distance, rim_radius, housing_radius);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Constructor, refusesMirrorsThatCannotWork) {
  const MirrorProfile sphere = MirrorProfile::conic(0.04, 0.0);
  const auto refusal = [](const std::string& text, const std::string& fragment) {
    return text.find(fragment) != std::string::npos;
  };
  EXPECT_PRED2(refusal, refusalOf(sphere, 0.21, 0.041), "rim_radius");
  EXPECT_PRED2(refusal, refusalOf(sphere, 0.21, 0.0), "rim_radius");
  EXPECT_PRED2(refusal, refusalOf(sphere, 0.21, kNaN), "rim_radius");
  EXPECT_PRED2(refusal, refusalOf(MirrorProfile::conic(0.04, -1.0), 0.21, kInfinity), "rim_radius");
  EXPECT_PRED2(refusal, refusalOf(sphere, 0.021, 0.0375), "the lens sees no more");
  EXPECT_PRED2(refusal, refusalOf(sphere, kNaN, 0.0375), "the lens sees no more");
  EXPECT_PRED2(refusal, refusalOf(sphere, -0.21, 0.0375), "the lens sees no more");
  EXPECT_PRED2(refusal, refusalOf(MirrorProfile::conic(-0.04, -1.0), 0.21, 0.0375), "cross");
  EXPECT_PRED2(refusal, refusalOf(MirrorProfile::conic(kNaN, 0.0), 0.21, 0.0375), "mirror");
  EXPECT_PRED2(refusal, refusalOf(MirrorProfile::conic(0.04, 0.0, {-30000.0}), 0.21, 0.0375),
               "cross");
  EXPECT_PRED2(refusal, refusalOf(MirrorProfile::conic(0.4, 0.0), 0.21, 0.0375, 0.2),
               "housing_radius");
  const auto funnel = [](long double rho) { return -0.9L * rho; };
  EXPECT_PRED2(refusal, refusalOf(sampledProfile(funnel, 0.004, 0.036, 5), 0.21, 0.03),
               "cross the axis");
}

TEST(Constructor, refusesADistortionThatFoldsTheMirrorsImage) {
  const ImagePlane folding(Eigen::Vector2d(1225.0, 1225.0).asDiagonal(),
                           Eigen::Vector2d(249.5, 249.5), {-20.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_THROW(
      CatadioptricCamera({500, 500}, folding, {MirrorProfile::conic(0.04, 0.0), 0.21, 0.0375}),
      InputError);
}

TEST(Constructor, takesAWholeBall) {
  const CatadioptricCamera camera = cameraWith(MirrorProfile::conic(0.04, 0.0), 0.21, 0.04);
  EXPECT_NEAR(camera.maxRadius(), std::tan(std::asin(0.04 / 0.25)), 1e-7);
}

}  // namespace
}  // namespace omnitag
