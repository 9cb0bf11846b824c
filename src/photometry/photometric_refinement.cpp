#include "omnitag/photometry/photometric_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lit_patch.h"
#include "marker_fitter.h"
#include "omnitag/common/angle.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {
namespace {

/// All that is known about the pose.
struct Linearization {
  MarkerFitter::Fits fits;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// Adds up what the markers and the prior say, each marker with its weight.
Linearization combine(MarkerFitter::Fits fits, const std::optional<PoseEstimate>& prior,
                      const Alignment& alignment) {
  Linearization all;
  if (prior) {
    all.information = prior->covariance.inverse();
    all.gradient = -all.information * difference(alignment.pose, prior->pose);
  }
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i]) continue;
    all.information += alignment.weights[i] * fits[i]->information();
    all.gradient += alignment.weights[i] * fits[i]->gradient();
  }
  all.fits = std::move(fits);
  return all;
}

/// How much a marker counts where the pose changes so: one that disagrees with the others, since it
/// hangs a little elsewhere or something shades it, counts less.
double weightOf(const MarkerFit& fit, const Eigen::Vector3d& change) {
  // Chi-square that 95 of 100 markers stay below, whose pixels usually err twice as much as they
  // would independently of each other.
  constexpr double kDisagreement = 7.81;
  const Eigen::Matrix3d information = fit.information();
  const Eigen::Vector3d gradient = fit.gradient() - information * change;
  // Where the marker tells hardly anything in some direction, rounding may make this negative.
  const double chi_square = gradient.dot(information.ldlt().solve(gradient));
  return chi_square > kDisagreement ? kDisagreement / chi_square : 1.0;
}

/// Weighs the markers by how well they agree on a change of the pose.
void weigh(const Linearization& all, const Eigen::Vector3d& change, Alignment* alignment) {
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (all.fits[i]) alignment->weights[i] = weightOf(*all.fits[i], change);
  }
}

Pose2 moved(const Pose2& pose, const Eigen::Vector3d& change) {
  return {pose.x + change.x(), pose.y + change.y(), normalizeAngle(pose.yaw + change.z())};
}

/// The change of the pose that fits best; nothing where the pose is not determined.
std::optional<Eigen::Vector3d> changeOf(const Linearization& all) {
  const bool is_seen = std::any_of(all.fits.begin(), all.fits.end(),
                                   [](const auto& fit) { return fit.has_value(); });
  const Eigen::LLT<Eigen::Matrix3d> factors(all.information);
  if (!is_seen || factors.info() != Eigen::Success) return std::nullopt;
  const Eigen::Vector3d change = factors.solve(all.gradient);
  return change.allFinite() ? std::optional(change) : std::nullopt;
}

/// Keeps the lights that fit best once the pose changes so.
void keepLights(const Linearization& all, const Eigen::Vector3d& change, Alignment* alignment) {
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (all.fits[i]) alignment->lights[i] = all.fits[i]->patch.lightAfter(change);
  }
}

/// Pixels by which a marker's edges are displaced, RMS, where the pose changes.
double displacementOf(const MarkerPixels& pixels, const Eigen::Vector3d& change) {
  double squares = 0.0;
  double gradient_squares = 0.0;
  for (const MarkerPixel& pixel : pixels) {
    squares += std::pow(pixel.white_by_pose.dot(change), 2);
    gradient_squares += pixel.gradient * pixel.gradient;
  }
  return gradient_squares > 0.0 ? std::sqrt(squares / gradient_squares) : 0.0;
}

/// m and rad by which a pose may change in one step. What the markers leave open, edges hardly
/// tell, and they do not follow it evenly.
constexpr double kShort = 0.01;

/// Pixels by which a marker's edges may. What a pixel sees of one changes evenly as long as it
/// stays well within it.
constexpr double kNear = 0.05;

/// Whether pixels follow a change of the pose evenly.
bool isShort(const Linearization& all, const Eigen::Vector3d& change) {
  return change.cwiseAbs().maxCoeff() < kShort &&
         std::all_of(all.fits.begin(), all.fits.end(), [&change](const auto& fit) {
           return !fit || displacementOf(fit->pixels, change) < kNear;
         });
}

/// Whether the pose is so near the optimum already that one step will do. Learns the step, the
/// noise and the lights on the way. `some`: of each marker's pixels, from that pose.
bool isNear(const MarkerFitter& fitter, std::vector<MarkerPixels> some,
            const std::optional<PoseEstimate>& prior, Alignment* alignment) {
  const Linearization all = combine(fitter.fits(std::move(some), *alignment), prior, *alignment);
  const std::optional<Eigen::Vector3d> change = changeOf(all);
  if (!change || !isShort(all, *change)) return false;
  alignment->expected_change = *change;
  alignment->noise = fitter.noise(all.fits, *change);
  keepLights(all, *change, alignment);
  return true;
}

/// Takes steps until they hardly change anything. False where that does not come about.
bool converge(const MarkerFitter& fitter, const std::vector<MarkerPatch>& patches,
              const std::optional<PoseEstimate>& prior, Alignment* alignment) {
  constexpr int kMaxSteps = 25;
  // Standard deviations of what these pixels can tell, which is far less than what is to come.
  constexpr double kConverged = 1.0;
  std::vector<LinesOfSight> lines;
  lines.reserve(patches.size());
  for (const MarkerPatch& patch : patches) lines.push_back(patch.linesOfSight());
  for (int step = 0; step < kMaxSteps; ++step) {
    const Linearization all = combine(fitter.fits(patches, lines, *alignment), prior, *alignment);
    const std::optional<Eigen::Vector3d> change = changeOf(all);
    if (!change) return false;
    alignment->pose = moved(alignment->pose, *change);
    const PixelNoise before = std::exchange(alignment->noise, fitter.noise(all.fits, *change));
    const PixelNoise& noise = alignment->noise;
    const bool is_settled = step > 0 && std::abs(noise.flat - before.flat) < 0.2 * noise.flat &&
                            std::abs(noise.edge - before.edge) < 0.2 * noise.edge + 0.01;
    keepLights(all, *change, alignment);
    if (is_settled && change->dot(all.information * *change) < kConverged * kConverged) return true;
    weigh(all, *change, alignment);
  }
  return false;
}

/// The last step from a pose that is nearly right, and what it stands on.
struct FinalStep {
  Linearization all;
  Eigen::Vector3d change;
};

/// `pixels`: of each marker, from the alignment's pose. They are many, and tell better than fewer
/// which markers disagree. Nothing where they leave the pose undetermined.
std::optional<FinalStep> finalStep(const MarkerFitter& fitter, std::vector<MarkerPixels> pixels,
                                   const std::optional<PoseEstimate>& prior, Alignment* alignment) {
  Linearization all = combine(fitter.fits(std::move(pixels), *alignment), prior, *alignment);
  std::optional<Eigen::Vector3d> change = changeOf(all);
  for (int round = 0; round < 2 && change; ++round) {
    weigh(all, *change, alignment);
    all = combine(std::move(all.fits), prior, *alignment);
    change = changeOf(all);
  }
  if (!change) return std::nullopt;
  return FinalStep{std::move(all), *change};
}

/// How many times more than their pixels say the markers disagree about a change of the pose, at
/// least 1: where that is not by chance, something hides, shades or displaces one of them.
/// `gradient_covariances`: one for each marker.
double excessOf(const Linearization& all, const std::vector<Eigen::Matrix3d>& gradient_covariances,
                const Eigen::Vector3d& change) {
  constexpr int kUnknowns = 3;
  double chi_square = 0.0;
  int freedom = -kUnknowns;
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (!all.fits[i]) continue;
    const Eigen::Vector3d gradient = all.fits[i]->gradient() - all.fits[i]->information() * change;
    chi_square += gradient.dot(gradient_covariances[i].ldlt().solve(gradient));
    freedom += kUnknowns;
  }
  // One marker alone cannot disagree: what it is off more than its pixels say is that on average,
  // as the NEES of 1,900 poses from one marker has it.
  constexpr double kExcessOfOne = 1.2;
  if (freedom <= 0) return kExcessOfOne;
  // By chance, chi-square is beyond this in one of a hundred frames.
  constexpr double kDeviations = 2.6;
  const bool is_by_chance = chi_square < freedom + kDeviations * std::sqrt(2.0 * freedom);
  return is_by_chance ? 1.0 : chi_square / freedom;
}

/// Covariance of the pose: of an estimate whose terms count as `all.information` says, and err as
/// the residuals say (the sandwich of Huber and White).
Eigen::Matrix3d covarianceOf(const Linearization& all, const Eigen::Vector3d& change,
                             const std::optional<PoseEstimate>& prior, const Alignment& alignment) {
  std::vector<Eigen::Matrix3d> gradient_covariances(all.fits.size(), Eigen::Matrix3d::Zero());
  Eigen::Matrix3d by_markers = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (!all.fits[i]) continue;
    gradient_covariances[i] = all.fits[i]->gradientCovariance(alignment.noise, change);
    by_markers += alignment.weights[i] * alignment.weights[i] * gradient_covariances[i];
  }
  Eigen::Matrix3d gradient_covariance = excessOf(all, gradient_covariances, change) * by_markers;
  if (prior) gradient_covariance += prior->covariance.inverse();
  const Eigen::Matrix3d inverse = all.information.inverse();
  return inverse * gradient_covariance * inverse;
}

}  // namespace

double photometricMisfit(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
                         const TagPatterns& patterns, const std::vector<std::size_t>& entries,
                         const Pose2& map_from_base, const PhotometricFit& fit,
                         const PhotometricConfig& config) {
  const MarkerFitter fitter(panorama, map, camera, patterns, entries, config, 1);
  const PixelNoise noise{fit.noise, fit.edge_noise};
  double misfit = 0.0;
  for (const MarkerPatch& patch : fitter.roughPatches(map_from_base)) {
    const MarkerPixels pixels = patch.pixels(panorama, patch.linesOfSight(), map_from_base);
    const auto lit = fitLight(pixels, noise);
    if (!lit) return std::numeric_limits<double>::infinity();
    for (const MarkerPixel& pixel : pixels) {
      const PixelResidual residual = residualOf(pixel, lit->light, Eigen::Vector3d::Zero());
      misfit += weightOf(residual, noise) * residual.grey * residual.grey;
    }
  }
  return misfit;
}

std::optional<PhotometricFit> refinePhotometrically(
    const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
    const TagPatterns& patterns, const std::vector<std::size_t>& entries, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const PhotometricConfig& config, int threads) {
  if (entries.empty()) return std::nullopt;
  const MarkerFitter fitter(panorama, map, camera, patterns, entries, config, threads);
  const Alignment start{initial,
                        Eigen::Vector3d::Zero(),
                        {},
                        std::vector<double>(entries.size(), 1.0),
                        std::vector<std::optional<Light>>(entries.size())};
  Alignment alignment = start;
  std::optional<FinalStep> step;
  std::vector<MarkerPixels> pixels = fitter.finePixels(initial);
  if (isNear(fitter, fitter.someOf(pixels), prior, &alignment)) {
    step = finalStep(fitter, std::move(pixels), prior, &alignment);
  }
  if (!step || !isShort(step->all, step->change)) {
    alignment = start;
    if (!converge(fitter, fitter.roughPatches(initial), prior, &alignment)) return std::nullopt;
    step = finalStep(fitter, fitter.finePixels(alignment.pose), prior, &alignment);
  }
  if (!step) return std::nullopt;
  const PixelNoise noise = fitter.noise(step->all.fits, step->change);
  PhotometricFit result;
  result.map_from_base = {moved(alignment.pose, step->change),
                          covarianceOf(step->all, step->change, prior, alignment)};
  result.noise = noise.flat;
  result.edge_noise = noise.edge;
  result.weights = std::move(alignment.weights);
  return result;
}

}  // namespace omnitag
