#include "omnitag/localization/photometric_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "omnitag/common/angle.h"
#include "omnitag/localization/marker_patch.h"

namespace omnitag {
namespace {

/// How far grey levels are off: noise on even ground, and at edges as much more as if these were
/// displaced by chance from pixel to pixel. No sensor and no print has an edge just as a pixel's
/// average over an ideal pattern has it.
struct Noise {
  double flat = 10.0;  // grey levels
  double edge = 0.05;  // pixels

  double variance(double grey_gradient) const {
    return flat * flat + edge * edge * grey_gradient * grey_gradient;
  }
};

/// A pixel's difference from the pattern.
struct Residual {
  double grey = 0.0;
  /// From pixel to pixel: of the share of white, and of the grey levels.
  double gradient = 0.0;
  double grey_gradient = 0.0;
};

/// What a marker's pixels say about the pose once the light on it is fitted.
struct PatchFit {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::vector<Residual> residuals;
};

/// 1 / variance, and less for pixels that are off by more than this many deviations.
double weightOf(const Residual& residual, const Noise& noise) {
  constexpr double kOutlier = 3.5;
  const double variance = noise.variance(residual.grey_gradient);
  const double ratio_square = residual.grey * residual.grey / (kOutlier * kOutlier * variance);
  return 1.0 / (variance * std::max(1.0, ratio_square));
}

/// Fits grey = black + white * (contrast + slope . position) in the sense of weighted least squares
/// and linearises what remains by the pose.
std::optional<PatchFit> fitLight(const std::vector<MarkerPixel>& pixels, const Noise& noise) {
  constexpr std::size_t kFewestPixels = 24;
  if (pixels.size() < kFewestPixels) return std::nullopt;
  using Light = Eigen::Vector4d;
  const auto regressors = [](const MarkerPixel& pixel) {
    return Light(1.0, pixel.white, pixel.white * pixel.position.x(),
                 pixel.white * pixel.position.y());
  };
  PatchFit fit;
  fit.residuals.assign(pixels.size(), {});
  Light light = Light::Zero();
  const auto contrastAt = [&light](const MarkerPixel& pixel) {
    return light[1] + light.tail<2>().dot(pixel.position);
  };
  Eigen::LDLT<Eigen::Matrix4d> factors;
  // The first round weighs all pixels alike, the second knows what is off.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Light right_side = Light::Zero();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Light x = regressors(pixels[i]);
      const double weight = weightOf(fit.residuals[i], noise);
      normal.noalias() += weight * x * x.transpose();
      right_side += weight * pixels[i].grey * x;
    }
    factors.compute(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    light = factors.solve(right_side);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      fit.residuals[i] = {pixels[i].grey - light.dot(regressors(pixels[i])), pixels[i].gradient,
                          contrastAt(pixels[i]) * pixels[i].gradient};
    }
  }
  constexpr double kLowestContrast = 8.0;
  if (light[1] < kLowestContrast) return std::nullopt;

  Eigen::Matrix<double, 4, 3> mixed = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::RowVector3d by_pose = contrastAt(pixels[i]) * pixels[i].white_by_pose;
    const double weight = weightOf(fit.residuals[i], noise);
    fit.information.noalias() += weight * by_pose.transpose() * by_pose;
    fit.gradient += weight * fit.residuals[i].grey * by_pose.transpose();
    mixed.noalias() += weight * regressors(pixels[i]) * by_pose;
  }
  // The light is free: what it could explain says nothing about the pose.
  fit.information -= mixed.transpose() * factors.solve(mixed);
  return fit;
}

/// The variance of which the squares are samples, by their median.
double varianceOf(std::vector<double> squares) {
  constexpr double kMedianOfChiSquare = 0.455;  // with one degree of freedom
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle / kMedianOfChiSquare;
}

/// Tells both kinds of noise apart by the pixels on even ground and those on edges.
Noise noiseOf(std::vector<Residual> residuals, double least_flat) {
  constexpr double kFlat = 0.05;  // share of white per pixel
  constexpr double kEdge = 0.25;
  constexpr std::ptrdiff_t kFewest = 30;
  constexpr Noise kTypical;
  std::sort(residuals.begin(), residuals.end(),
            [](const Residual& a, const Residual& b) { return a.gradient < b.gradient; });
  const auto firstFrom = [&residuals](double gradient) {
    return std::partition_point(residuals.begin(), residuals.end(),
                                [gradient](const Residual& r) { return r.gradient < gradient; });
  };
  // Small markers have hardly any even ground: the most even pixels must do.
  const auto count = static_cast<std::ptrdiff_t>(residuals.size());
  const auto flat_end = residuals.begin() + std::max(firstFrom(kFlat) - residuals.begin(),
                                                     std::min(kFewest, (count + 4) / 5));
  std::vector<double> flat_squares;
  std::for_each(residuals.begin(), flat_end,
                [&](const Residual& r) { flat_squares.push_back(r.grey * r.grey); });
  Noise noise;
  noise.flat = std::max(std::sqrt(varianceOf(std::move(flat_squares))), least_flat);

  const auto edge_begin = firstFrom(kEdge);
  noise.edge = kTypical.edge;
  if (residuals.end() - edge_begin < kFewest) return noise;
  std::vector<double> edge_squares;
  double gradient_square = 0.0;
  std::for_each(edge_begin, residuals.end(), [&](const Residual& r) {
    edge_squares.push_back(r.grey * r.grey);
    gradient_square += r.grey_gradient * r.grey_gradient;
  });
  gradient_square /= static_cast<double>(edge_squares.size());
  const double edge_variance = varianceOf(std::move(edge_squares)) - noise.flat * noise.flat;
  noise.edge = std::sqrt(std::max(0.0, edge_variance) / gradient_square);
  return noise;
}

/// Takes into account that a marker does not hang exactly where the map says, nor exactly even, and
/// that all of its pixels together image a little beside where they should: the pose errs along
/// with it, however exact the pixels are.
void blurPlacement(const Marker& marker, const MountedCamera& camera, const Pose2& pose,
                   const PhotometricConfig& config, PatchFit* fit) {
  Eigen::Matrix<double, 2, 3> pixel_by_pose;
  if (!camera.pixelFromMap(pose, marker.center(), &pixel_by_pose)) return;
  const double pixels_per_metre = std::max(1e-3, pixel_by_pose.leftCols<2>().norm());
  const double placement_deviation = std::max(config.placement_deviation, marker.deviation);
  const double variance = placement_deviation * placement_deviation +
                          std::pow(config.alignment_deviation / pixels_per_metre, 2);
  const Eigen::Vector2d from_marker = Eigen::Vector2d(pose.x, pose.y) - marker.center().head<2>();
  const Eigen::Vector3d by_turn(-from_marker.y(), from_marker.x(), 1.0);
  Eigen::Matrix3d placement = by_turn * by_turn.transpose() / (marker.size * marker.size);
  placement.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity();
  placement *= variance;
  // (information^-1 + placement)^-1, also where the information has no inverse.
  const Eigen::Matrix3d share =
      (Eigen::Matrix3d::Identity() + fit->information * placement).inverse();
  fit->information = share * fit->information;
  fit->gradient = share * fit->gradient;
}

/// How far a marker's own optimum is from a pose at which its gradient is `gradient`: chi-square
/// with 3 degrees of freedom.
double disagreement(const PatchFit& fit, const Eigen::Vector3d& gradient) {
  return gradient.dot(fit.information.ldlt().solve(gradient));
}

/// The parts of the panorama that show the markers at `entries`.
std::vector<MarkerPatch> patchesOf(const MarkerMap& map, const MountedCamera& camera,
                                   const TagPatterns& patterns,
                                   const std::vector<std::size_t>& entries, const Pose2& pose,
                                   const PhotometricConfig& config) {
  MarkerPatch::Choice choice;
  choice.max_at_edges = static_cast<std::size_t>(config.max_pixels);
  choice.max_on_even_ground = choice.max_at_edges / 4;
  std::vector<MarkerPatch> patches;
  patches.reserve(entries.size());
  for (const std::size_t entry : entries) {
    const Marker& marker = map.markers[entry];
    patches.emplace_back(marker, patterns.of(marker), camera, pose, config.blur, choice);
  }
  return patches;
}

}  // namespace

double photometricMisfit(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
                         const TagPatterns& patterns, const std::vector<std::size_t>& entries,
                         const Pose2& map_from_base, const PhotometricFit& fit,
                         const PhotometricConfig& config) {
  const Noise noise{fit.noise, fit.edge_noise};
  double misfit = 0.0;
  for (const MarkerPatch& patch :
       patchesOf(map, camera, patterns, entries, map_from_base, config)) {
    const auto lit = fitLight(patch.pixels(panorama, map_from_base), noise);
    if (!lit) return std::numeric_limits<double>::infinity();
    for (const Residual& residual : lit->residuals) {
      misfit += weightOf(residual, noise) * residual.grey * residual.grey;
    }
  }
  return misfit;
}

std::optional<PhotometricFit> refinePhotometrically(
    const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
    const TagPatterns& patterns, const std::vector<std::size_t>& entries, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const PhotometricConfig& config) {
  const std::vector<MarkerPatch> patches =
      patchesOf(map, camera, patterns, entries, initial, config);
  Eigen::Matrix3d prior_information = Eigen::Matrix3d::Zero();
  if (prior) prior_information = prior->covariance.inverse();

  constexpr int kMaxSteps = 25;
  // Standard deviations. The averages over pixels are not smooth enough to come much closer, nor
  // would it gain anything.
  constexpr double kConverged = 0.3;
  // Chi-square that 95 of 100 markers stay below: one that disagrees by more, since it hangs a
  // little elsewhere or something shades it, counts less.
  constexpr double kDisagreement = 7.81;
  Pose2 pose = initial;
  Noise noise;
  PhotometricFit result;
  std::vector<double> weights(patches.size(), 1.0);
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::Matrix3d information = prior_information;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    if (prior) gradient = -prior_information * difference(pose, prior->pose);
    std::vector<Residual> residuals;
    std::vector<std::optional<PatchFit>> fits;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      fits.push_back(fitLight(patches[i].pixels(panorama, pose), noise));
      if (!fits[i]) continue;
      blurPlacement(map.markers[entries[i]], camera, pose, config, &*fits[i]);
      information += weights[i] * fits[i]->information;
      gradient += weights[i] * fits[i]->gradient;
      residuals.insert(residuals.end(), fits[i]->residuals.begin(), fits[i]->residuals.end());
    }
    if (residuals.empty()) return std::nullopt;
    const Eigen::LLT<Eigen::Matrix3d> factors(information);
    if (factors.info() != Eigen::Success) return std::nullopt;
    const Eigen::Vector3d change = factors.solve(gradient);
    if (!change.allFinite()) return std::nullopt;
    pose = {pose.x + change.x(), pose.y + change.y(), normalizeAngle(pose.yaw + change.z())};

    const Noise noise_before =
        std::exchange(noise, noiseOf(std::move(residuals), config.min_noise));
    const bool is_settled = step > 0 &&
                            std::abs(noise.flat - noise_before.flat) < 0.1 * noise.flat &&
                            std::abs(noise.edge - noise_before.edge) < 0.1 * noise.edge + 0.01;
    if (is_settled && change.dot(information * change) < kConverged * kConverged) {
      result.map_from_base = {pose, information.inverse()};
      result.noise = noise.flat;
      result.edge_noise = noise.edge;
      result.weights = std::move(weights);
      return result;
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (!fits[i]) continue;
      const double off = disagreement(*fits[i], fits[i]->gradient - fits[i]->information * change);
      weights[i] = std::min(1.0, kDisagreement / off);
    }
  }
  return std::nullopt;
}

}  // namespace omnitag
