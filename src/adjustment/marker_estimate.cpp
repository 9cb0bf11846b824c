#include "adjustment/marker_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Chi-square with 8 degrees of freedom: 99 of 100 sightings stay below. Beyond it, Cauchy's
/// function weighs a sighting's squares.
constexpr double kExpected = 20.1;

double robustCost(double square) {
  return square <= kExpected ? square : kExpected * (1.0 + std::log(square / kExpected));
}

double robustWeight(double square) { return square <= kExpected ? 1.0 : kExpected / square; }

/// An increment and the change of the size.
using Step = Eigen::Matrix<double, 7, 1>;
using Information = Eigen::Matrix<double, 7, 7>;
using Weight = Eigen::Matrix<double, 8, 8>;

struct Linearization {
  Information information = Information::Zero();
  Step gradient = Step::Zero();
  double cost = 0.0;
  double weighted_squares = 0.0;
};

Marker changed(const Marker& marker, const Step& step) {
  Marker result = marker;
  result.map_from_marker = moved(marker.map_from_marker, step.head<6>());
  result.size = marker.size + step(6);
  return result;
}

/// Least squares over the corners of some sightings.
class Problem {
 public:
  Problem(const CameraModels& cameras, const std::vector<MarkerSighting>& sightings,
          double corner_noise, bool estimates_size)
      : sightings_(sightings), corner_noise_(corner_noise), unknowns_(estimates_size ? 7 : 6) {
    for (const MarkerSighting& sighting : sightings) {
      cameras_.emplace_back(cameras[sighting.camera], sighting.base_from_camera);
      measured_.push_back(stacked(sighting.corners));
    }
    weights_.assign(sightings.size(), Weight::Identity() / (corner_noise * corner_noise));
  }

  /// Also weights each sighting by the uncertainty of its pose, as it affects a marker at this
  /// place.
  void weigh(const Marker& marker) {
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const PoseEstimate& pose = sightings_[i].map_from_base;
      const auto projection = projectMarker(marker, cameras_[i], pose.pose);
      if (!projection) continue;
      const Weight covariance =
          corner_noise_ * corner_noise_ * Weight::Identity() +
          projection->by_pose * pose.covariance * projection->by_pose.transpose();
      weights_[i] = inverseOf(covariance);
    }
  }

  /// With robust weights, unless `plain`.
  Linearization linearize(const Marker& marker, bool plain) const {
    Linearization linear;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const auto projection = projectMarker(marker, cameras_[i], sightings_[i].map_from_base.pose);
      if (!projection) {
        linear.cost += plain ? 1e12 : robustCost(1e12);
        continue;
      }
      const CornerPixels residual = projection->pixels - measured_[i];
      const double square = residual.dot(weights_[i] * residual);
      const double factor = plain ? 1.0 : robustWeight(square);
      linear.cost += plain ? square : robustCost(square);
      linear.weighted_squares += factor * square;
      Eigen::Matrix<double, 8, 7> by_step;
      by_step << projection->by_marker, projection->by_size;
      linear.information += factor * by_step.transpose() * weights_[i] * by_step;
      linear.gradient += factor * by_step.transpose() * weights_[i] * residual;
    }
    for (int i = unknowns_; i < 7; ++i) {
      linear.information.row(i).setZero();
      linear.information.col(i).setZero();
      linear.information(i, i) = 1.0;
      linear.gradient(i) = 0.0;
    }
    return linear;
  }

  /// The optimum that a start leads to; nothing if the problem has none.
  std::optional<Marker> refine(Marker marker, bool plain) const {
    constexpr int kMaxIterations = 50;
    constexpr double kTolerance = 1e-8;  // m and rad
    Linearization linear = linearize(marker, plain);
    double damping = 1e-3;
    for (int i = 0; i < kMaxIterations; ++i) {
      Information damped = linear.information;
      damped.diagonal() *= 1.0 + damping;
      const Step step = -solved(damped, linear.gradient);
      if (!step.allFinite()) return std::nullopt;
      const Marker candidate = changed(marker, step);
      const bool is_possible = candidate.size > 0.0 && step.tail<4>().norm() < kPi;
      if (const Linearization next = is_possible ? linearize(candidate, plain) : Linearization{};
          is_possible && next.cost <= linear.cost) {
        marker = candidate;
        linear = next;
        damping = std::max(0.1 * damping, 1e-9);
        if (step.norm() < kTolerance) break;
      } else {
        damping *= 10.0;
        if (damping > 1e9) break;
      }
    }
    return marker;
  }

  /// Squared residual of a sighting in units of its expected value, and its RMS in pixels.
  std::pair<double, double> residual(const Marker& marker, std::size_t sighting) const {
    const auto projection =
        projectMarker(marker, cameras_[sighting], sightings_[sighting].map_from_base.pose);
    if (!projection) return {kInfinity, kInfinity};
    const CornerPixels off = projection->pixels - measured_[sighting];
    return {off.dot(weights_[sighting] * off), std::sqrt(off.squaredNorm() / 4.0)};
  }

  int unknowns() const { return unknowns_; }

 private:
  const std::vector<MarkerSighting>& sightings_;
  double corner_noise_;
  int unknowns_;
  std::vector<MountedCamera> cameras_;
  std::vector<CornerPixels> measured_;
  std::vector<Weight> weights_;
};

double largestDeviation(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, eigenPairs(covariance).values(2)));
}

bool isSamePlace(const Marker& a, const Marker& b) {
  constexpr double kSameTurn = radians(1.0);
  const double turn =
      Eigen::AngleAxisd(a.map_from_marker.linear().transpose() * b.map_from_marker.linear())
          .angle();
  return turn < kSameTurn && (a.center() - b.center()).norm() < 0.1 * a.size;
}

bool isFacing(const Marker& marker, const Eigen::Vector3d& viewpoint) {
  return marker.normal().dot(viewpoint - marker.center()) > 0.0;
}

Eigen::Isometry3d mapFromCamera(const MarkerSighting& sighting) {
  return sighting.map_from_base.pose.toIsometry() * sighting.base_from_camera;
}

/// Places at the right distance in the right direction, turned and tilted in many ways.
std::vector<Marker> startsFrom(const Marker& marker, const MountedCamera& camera,
                               const MarkerSighting& sighting) {
  const Eigen::Isometry3d map_from_base = sighting.map_from_base.pose.toIsometry();
  std::array<Eigen::Vector3d, 4> directions;
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    const auto ray = camera.rayInBase(sighting.corners[k]);
    if (!ray) return {};
    directions[k] = map_from_base.linear() * ray->direction;
    viewpoint += 0.25 * (map_from_base * ray->origin);
  }
  const Eigen::Vector3d middle =
      (directions[0] + directions[1] + directions[2] + directions[3]).normalized();
  const double longest_angle = std::max(std::acos(std::min(1.0, directions[0].dot(directions[2]))),
                                        std::acos(std::min(1.0, directions[1].dot(directions[3]))));
  const double distance = 0.5 * std::sqrt(2.0) * marker.size / std::tan(0.5 * longest_angle);
  const Eigen::Vector3d right = directions[1] + directions[2] - directions[0] - directions[3];

  Eigen::Matrix3d facing;
  facing.col(2) = -middle;
  facing.col(0) = (right - right.dot(middle) * middle).normalized();
  facing.col(1) = facing.col(2).cross(facing.col(0));
  std::vector<Marker> starts;
  const auto add = [&](double tilt, double direction) {
    const Eigen::Vector3d axis(std::cos(direction), std::sin(direction), 0.0);
    Marker start = marker;
    start.map_from_marker.linear() = facing * Eigen::AngleAxisd(tilt, axis).toRotationMatrix();
    start.map_from_marker.translation() = viewpoint + distance * middle;
    starts.push_back(start);
  };
  for (const double tilt : {radians(30.0), radians(60.0)}) {
    constexpr int kDirections = 8;
    for (int i = 0; i < kDirections; ++i) add(tilt, 2.0 * kPi * i / kDirections);
  }
  return starts;
}

/// Up to three sightings to start from: the first, the last, and the one that shows the
/// marker largest.
std::vector<std::size_t> tellingSightings(const std::vector<MarkerSighting>& sightings) {
  const auto size = [](const MarkerSighting& sighting) {
    return (sighting.corners[2] - sighting.corners[0]).norm() +
           (sighting.corners[3] - sighting.corners[1]).norm();
  };
  const auto largest = std::max_element(
      sightings.begin(), sightings.end(),
      [&](const MarkerSighting& a, const MarkerSighting& b) { return size(a) < size(b); });
  std::vector<std::size_t> telling = {static_cast<std::size_t>(largest - sightings.begin()), 0,
                                      sightings.size() - 1};
  std::sort(telling.begin(), telling.end());
  telling.erase(std::unique(telling.begin(), telling.end()), telling.end());
  return telling;
}

}  // namespace

bool MarkerEstimate::isUnambiguous() const {
  constexpr double kMinLead = 5.0;
  return lead >= kMinLead;
}

double MarkerEstimate::agreement() const {
  const auto agreeing = std::count(agrees.begin(), agrees.end(), true);
  return static_cast<double>(agreeing) / static_cast<double>(agrees.size());
}

double MarkerEstimate::positionDeviation() const {
  return largestDeviation(covariance.topLeftCorner<3, 3>());
}

double MarkerEstimate::orientationDeviation() const {
  return largestDeviation(covariance.bottomRightCorner<3, 3>());
}

double parallax(const Eigen::Vector3d& center, const std::vector<MarkerSighting>& sightings) {
  double smallest_cosine = 1.0;
  std::vector<Eigen::Vector3d> directions;
  for (const MarkerSighting& sighting : sightings) {
    directions.push_back((mapFromCamera(sighting).translation() - center).normalized());
    for (const Eigen::Vector3d& other : directions) {
      smallest_cosine = std::min(smallest_cosine, directions.back().dot(other));
    }
  }
  return std::acos(std::max(-1.0, smallest_cosine));
}

std::vector<Marker> markersFromSighting(const Marker& marker, const CameraModels& cameras,
                                        const MarkerSighting& sighting, double max_residual) {
  const std::vector<MarkerSighting> only = {sighting};
  const Problem problem(cameras, only, 1.0, false);
  const Eigen::Vector3d viewpoint = mapFromCamera(sighting).translation();
  std::vector<std::pair<double, Marker>> found;
  for (const Marker& start : startsFrom(
           marker, MountedCamera(cameras[sighting.camera], sighting.base_from_camera), sighting)) {
    const std::optional<Marker> refined = problem.refine(start, true);
    if (!refined || !isFacing(*refined, viewpoint)) continue;
    const double residual = problem.residual(*refined, 0).second;
    if (!(residual <= max_residual)) continue;
    const bool is_known = std::any_of(found.begin(), found.end(), [&](const auto& other) {
      return isSamePlace(other.second, *refined);
    });
    if (!is_known) found.emplace_back(residual, *refined);
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Marker> markers;
  markers.reserve(found.size());
  for (auto& [residual, place] : found) markers.push_back(std::move(place));
  return markers;
}

std::optional<MarkerEstimate> estimateMarker(const Marker& marker, const CameraModels& cameras,
                                             const std::vector<MarkerSighting>& sightings,
                                             const std::optional<Marker>& start,
                                             const MarkerEstimateConfig& config) {
  if (sightings.empty()) return std::nullopt;
  constexpr double kMaxStartResidual = 3.0;  // pixels
  std::vector<Marker> starts;
  if (start) starts.push_back(*start);
  for (const std::size_t i : tellingSightings(sightings)) {
    for (Marker& each : markersFromSighting(marker, cameras, sightings[i], kMaxStartResidual)) {
      starts.push_back(std::move(each));
    }
  }

  Problem problem(cameras, sightings, config.corner_noise, config.estimates_size);
  std::optional<Marker> best;
  double best_cost = kInfinity;
  double next_cost = kInfinity;
  for (Marker& each : starts) {
    problem.weigh(each);
    std::optional<Marker> refined = problem.refine(std::move(each), false);
    if (!refined) continue;
    const double cost = problem.linearize(*refined, false).cost;
    if (best && isSamePlace(*best, *refined)) {
      best_cost = std::min(best_cost, cost);
    } else if (cost < best_cost) {
      next_cost = best_cost;
      best_cost = cost;
      best = std::move(refined);
    } else {
      next_cost = std::min(next_cost, cost);
    }
  }
  if (!best) return std::nullopt;
  problem.weigh(*best);
  best = problem.refine(*best, false);
  if (!best) return std::nullopt;

  const Linearization linear = problem.linearize(*best, false);
  constexpr double kSmallestEigenvalue = 1e-12;
  const SmallVector eigenvalues = eigenPairs(linear.information).values;
  if (!(eigenvalues(0) > kSmallestEigenvalue * eigenvalues(6))) return std::nullopt;
  const double freedom =
      8.0 * static_cast<double>(sightings.size()) - static_cast<double>(problem.unknowns());
  const double factor = std::max(1.0, linear.weighted_squares / std::max(freedom, 1.0));
  const Information covariance = factor * inverseOf(linear.information);
  MarkerEstimate estimate;
  estimate.marker = *best;
  estimate.covariance = covariance.topLeftCorner<6, 6>();
  estimate.size_variance = config.estimates_size ? covariance(6, 6) : 0.0;
  estimate.lead = 0.5 * (next_cost - best_cost);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const auto [square, pixels] = problem.residual(*best, i);
    estimate.residuals.push_back(pixels);
    estimate.agrees.push_back(square <= kExpected);
  }
  return estimate;
}

}  // namespace omnitag
