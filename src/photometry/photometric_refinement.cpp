#include "omnitag/photometry/photometric_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lit_patch.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/parallel.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {
namespace {

/// Covariance of the pose, as a single marker gives it, that comes from where the marker is: it
/// does not hang exactly where the map says, nor exactly even, and all of its pixels together image
/// a little beside where they should.
Eigen::Matrix3d misplacementOf(const Marker& marker, const MountedCamera& camera, const Pose2& pose,
                               const PhotometricConfig& config) {
  Eigen::Matrix<double, 2, 3> pixel_by_pose;
  if (!camera.pixelFromMap(pose, marker.center(), &pixel_by_pose)) return Eigen::Matrix3d::Zero();
  const double pixels_per_metre = std::max(1e-3, pixel_by_pose.leftCols<2>().norm());
  const double placement_deviation = std::max(config.placement_deviation, marker.deviation);
  const double variance = placement_deviation * placement_deviation +
                          std::pow(config.alignment_deviation / pixels_per_metre, 2);
  const Eigen::Vector2d from_marker = Eigen::Vector2d(pose.x, pose.y) - marker.center().head<2>();
  const Eigen::Vector3d by_turn(-from_marker.y(), from_marker.x(), 1.0);
  Eigen::Matrix3d covariance = by_turn * by_turn.transpose() / (marker.size * marker.size);
  covariance.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity();
  return variance * covariance;
}

/// One marker's share in the estimate.
struct MarkerFit {
  std::vector<MarkerPixel> pixels;
  LitPatch patch;
  /// Because of its misplacement the marker says the pose that much less exactly than its pixels.
  Eigen::Matrix3d misplacement;
  Eigen::Matrix3d share;

  Eigen::Matrix3d information() const { return share * patch.information; }
  Eigen::Vector3d gradient() const { return share * patch.gradient; }
  Eigen::Matrix3d gradientCovariance(const PixelNoise& noise) const {
    const Eigen::Matrix3d by_misplacement = patch.information * misplacement * patch.information;
    return share * (omnitag::gradientCovariance(pixels, patch, noise) + by_misplacement) *
           share.transpose();
  }
};

/// What is estimated, and what is learnt on the way.
struct Alignment {
  Pose2 pose;
  PixelNoise noise;
  /// One for each marker; no light where it was not seen yet.
  std::vector<double> weights;
  std::vector<std::optional<Light>> lights;
};

/// All that is known about the pose.
struct Linearization {
  /// One for each marker; nothing where it is not seen.
  std::vector<std::optional<MarkerFit>> fits;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// What the estimate is made from.
class Aligner {
 public:
  Aligner(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
          const TagPatterns& patterns, const std::vector<std::size_t>& entries,
          const PhotometricConfig& config, int threads)
      : panorama_(panorama),
        map_(map),
        camera_(camera),
        patterns_(patterns),
        entries_(entries),
        config_(config),
        threads_(threads) {}

  /// The parts of the panorama that show the markers, to find the pose from an initial one: where
  /// their pixels look is to be asked of their lines of sight.
  std::vector<MarkerPatch> roughPatches(const Pose2& pose) const {
    MarkerPatch::Choice choice;
    choice.tolerance = 0.1;
    choice.facets = 2;
    return patches(pose, config_.max_pixels, choice, kRoughWorthAThread);
  }

  /// The same, from a pose that is hardly to change any more: only those pixels tell more of it
  /// that have an edge in them.
  std::vector<MarkerPatch> finePatches(const Pose2& pose) const {
    MarkerPatch::Choice choice;
    choice.reach = 0.0;
    choice.facets = 6;
    return patches(pose, config_.max_final_pixels, choice, kFineWorthAThread);
  }

  /// What each marker says at the pose of the patches; nothing where it is not seen.
  std::vector<std::optional<MarkerFit>> fits(const std::vector<MarkerPatch>& patches,
                                             const Alignment& alignment) const {
    return fits(alignment, kFineWorthAThread,
                [&](std::size_t i) { return patches[i].pixels(panorama_); });
  }

  /// The same at the alignment's pose, near that of the patches. `lines` are the patches'.
  std::vector<std::optional<MarkerFit>> fits(const std::vector<MarkerPatch>& patches,
                                             const std::vector<LinesOfSight>& lines,
                                             const Alignment& alignment) const {
    return fits(alignment, kRoughWorthAThread, [&](std::size_t i) {
      return patches[i].pixels(panorama_, lines[i], alignment.pose);
    });
  }

  /// What all markers' residuals say about the pixels' noise; there must be some.
  PixelNoise noise(const Linearization& all) const {
    constexpr std::size_t kEnough = 3000;
    std::size_t count = 0;
    for (const auto& fit : all.fits) count += fit ? fit->patch.residuals.size() : 0;
    const std::size_t every = 1 + count / kEnough;
    std::vector<PixelResidual> residuals;
    for (const auto& fit : all.fits) {
      if (!fit) continue;
      const std::vector<PixelResidual>& of_marker = fit->patch.residuals;
      for (std::size_t i = 0; i < of_marker.size(); i += every) residuals.push_back(of_marker[i]);
    }
    return noiseOf(std::move(residuals), config_.min_noise);
  }

 private:
  /// Markers.
  static constexpr std::size_t kRoughWorthAThread = 8;
  static constexpr std::size_t kFineWorthAThread = 2;

  template <typename PixelsOf>
  std::vector<std::optional<MarkerFit>> fits(const Alignment& alignment, std::size_t worth_a_thread,
                                             const PixelsOf& pixels_of) const {
    std::vector<std::optional<MarkerFit>> fits(entries_.size());
    forEachIndex(fits.size(), threads_, worth_a_thread,
                 [&](std::size_t i) { fits[i] = fitOf(i, pixels_of(i), alignment); });
    return fits;
  }

  std::optional<MarkerFit> fitOf(std::size_t index, std::vector<MarkerPixel> pixels,
                                 const Alignment& alignment) const {
    const std::optional<LitPatch> lit = fitLight(pixels, alignment.noise, alignment.lights[index]);
    if (!lit) return std::nullopt;
    const Eigen::Matrix3d misplacement =
        misplacementOf(map_.markers[entries_[index]], camera_, alignment.pose, config_);
    // (information^-1 + misplacement)^-1, also where the information has no inverse.
    const Eigen::Matrix3d share =
        (Eigen::Matrix3d::Identity() + lit->information * misplacement).inverse();
    return MarkerFit{std::move(pixels), *lit, misplacement, share};
  }

  /// With so many pixels at edges at most, all together, but for what a marker needs. Large markers
  /// get more of them: they are near, and each of their pixels tells more of the pose.
  std::vector<MarkerPatch> patches(const Pose2& pose, int max_pixels,
                                   const MarkerPatch::Choice& choice,
                                   std::size_t worth_a_thread) const {
    constexpr double kLeast = 75.0;
    constexpr std::size_t kEnoughForLight = 60;
    // So many more are looked at to find those at edges.
    constexpr std::size_t kLookedAt = 2;
    std::vector<double> areas;
    for (const std::size_t entry : entries_) areas.push_back(areaOf(map_.markers[entry], pose));
    const double whole = std::accumulate(areas.begin(), areas.end(), 1.0);
    std::vector<std::optional<MarkerPatch>> made(entries_.size());
    forEachIndex(entries_.size(), threads_, worth_a_thread, [&](std::size_t i) {
      const Marker& marker = map_.markers[entries_[i]];
      MarkerPatch::Choice own = choice;
      own.max_at_edges = static_cast<std::size_t>(std::max(kLeast, max_pixels * areas[i] / whole));
      own.max_on_even_ground = std::min(own.max_at_edges / 8, kEnoughForLight);
      own.max_considered = kLookedAt * own.max_at_edges;
      made[i].emplace(marker, patterns_.of(marker), camera_, pose, config_.blur, own);
    });
    std::vector<MarkerPatch> patches;
    patches.reserve(made.size());
    for (std::optional<MarkerPatch>& patch : made) patches.push_back(std::move(*patch));
    return patches;
  }

  /// Of a marker between its corners, in pixels, about; 0 where one of them is not seen.
  double areaOf(const Marker& marker, const Pose2& pose) const {
    const Corners<Eigen::Vector3d> corners = marker.corners();
    Corners<Eigen::Vector2d> pixels;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto pixel = camera_.pixelFromMap(pose, corners[k]);
      if (!pixel) return 0.0;
      pixels[k] = *pixel;
    }
    const Eigen::Vector2d a = pixels[2] - pixels[0];
    const Eigen::Vector2d b = pixels[3] - pixels[1];
    return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }

  const cv::Mat& panorama_;
  const MarkerMap& map_;
  const MountedCamera& camera_;
  const TagPatterns& patterns_;
  const std::vector<std::size_t>& entries_;
  const PhotometricConfig& config_;
  int threads_;
};

/// Adds up what the markers and the prior say, each marker with its weight.
Linearization combine(std::vector<std::optional<MarkerFit>> fits,
                      const std::optional<PoseEstimate>& prior, const Alignment& alignment) {
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

/// How much a marker counts whose own optimum is, with `information`, `off` away from the pose: one
/// that disagrees with the others, since it hangs a little elsewhere or something shades it, counts
/// less.
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

/// Takes steps until they hardly change anything. False where that does not come about.
bool converge(const Aligner& aligner, const std::vector<MarkerPatch>& patches,
              const std::optional<PoseEstimate>& prior, Alignment* alignment) {
  constexpr int kMaxSteps = 25;
  // Standard deviations of what these pixels can tell, which is far less than what is to come.
  constexpr double kConverged = 1.0;
  std::vector<LinesOfSight> lines;
  lines.reserve(patches.size());
  for (const MarkerPatch& patch : patches) lines.push_back(patch.linesOfSight());
  for (int step = 0; step < kMaxSteps; ++step) {
    const Linearization all = combine(aligner.fits(patches, lines, *alignment), prior, *alignment);
    const std::optional<Eigen::Vector3d> change = changeOf(all);
    if (!change) return false;
    alignment->pose = moved(alignment->pose, *change);
    const PixelNoise before = std::exchange(alignment->noise, aligner.noise(all));
    const PixelNoise& noise = alignment->noise;
    const bool is_settled = step > 0 && std::abs(noise.flat - before.flat) < 0.2 * noise.flat &&
                            std::abs(noise.edge - before.edge) < 0.2 * noise.edge + 0.01;
    for (std::size_t i = 0; i < all.fits.size(); ++i) {
      if (all.fits[i]) alignment->lights[i] = all.fits[i]->patch.light;
    }
    if (is_settled && change->dot(all.information * *change) < kConverged * kConverged) return true;
    weigh(all, *change, alignment);
  }
  return false;
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
    gradient_covariances[i] = all.fits[i]->gradientCovariance(alignment.noise);
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
  const Aligner aligner(panorama, map, camera, patterns, entries, config, 1);
  const PixelNoise noise{fit.noise, fit.edge_noise};
  double misfit = 0.0;
  for (const MarkerPatch& patch : aligner.roughPatches(map_from_base)) {
    const auto lit = fitLight(patch.pixels(panorama, patch.linesOfSight(), map_from_base), noise);
    if (!lit) return std::numeric_limits<double>::infinity();
    for (const PixelResidual& residual : lit->residuals) {
      misfit += weightOf(residual, noise) * residual.grey * residual.grey;
    }
  }
  return misfit;
}

std::optional<PhotometricFit> refinePhotometrically(
    const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
    const TagPatterns& patterns, const std::vector<std::size_t>& entries, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const PhotometricConfig& config, int threads) {
  const Aligner aligner(panorama, map, camera, patterns, entries, config, threads);
  Alignment alignment{initial,
                      {},
                      std::vector<double>(entries.size(), 1.0),
                      std::vector<std::optional<Light>>(entries.size())};
  if (!converge(aligner, aligner.roughPatches(initial), prior, &alignment)) {
    return std::nullopt;
  }
  // From so near, one step with many more pixels is enough. They tell better, too, which markers
  // disagree.
  Linearization all =
      combine(aligner.fits(aligner.finePatches(alignment.pose), alignment), prior, alignment);
  std::optional<Eigen::Vector3d> change = changeOf(all);
  for (int round = 0; round < 2 && change; ++round) {
    weigh(all, *change, &alignment);
    all = combine(std::move(all.fits), prior, alignment);
    change = changeOf(all);
  }
  if (!change) return std::nullopt;
  const PixelNoise noise = aligner.noise(all);
  PhotometricFit result;
  result.map_from_base = {moved(alignment.pose, *change),
                          covarianceOf(all, *change, prior, alignment)};
  result.noise = noise.flat;
  result.edge_noise = noise.edge;
  result.weights = std::move(alignment.weights);
  return result;
}

}  // namespace omnitag
