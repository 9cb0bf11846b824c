#include "marker_fitter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "omnitag/common/parallel.h"

namespace omnitag {
namespace {

/// Markers.
constexpr std::size_t kRoughWorthAThread = 8;
constexpr std::size_t kFineWorthAThread = 2;

/// Pixels to fit.
constexpr std::size_t kFitWorthAThread = 700;

/// Pixels of a marker, whatever the others need.
constexpr std::size_t kLeastPixels = 75;

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

}  // namespace

Eigen::Matrix3d MarkerFit::gradientCovariance(const PixelNoise& noise,
                                              const Eigen::Vector3d& change) const {
  const Eigen::Matrix3d by_misplacement = patch.information * misplacement * patch.information;
  return share * (omnitag::gradientCovariance(pixels, patch, noise, change) + by_misplacement) *
         share.transpose();
}

std::vector<MarkerPatch> MarkerFitter::roughPatches(const Pose2& pose) const {
  MarkerPatch::Choice choice;
  choice.tolerance = 0.1;
  choice.facets = 2;
  return patches(pose, config_.max_pixels, choice, kRoughWorthAThread);
}

MarkerFitter::Fits MarkerFitter::fits(const std::vector<MarkerPatch>& patches,
                                      const std::vector<LinesOfSight>& lines,
                                      const Alignment& alignment) const {
  Fits fits(patches.size());
  forEachIndex(fits.size(), threads_, kRoughWorthAThread, [&](std::size_t i) {
    fits[i] = fitOf(i, patches[i].pixels(panorama_, lines[i], alignment.pose), alignment);
  });
  return fits;
}

std::vector<MarkerPixels> MarkerFitter::finePixels(const Pose2& pose) const {
  MarkerPatch::Choice choice;
  choice.reach = 0.0;
  choice.facets = 6;
  const std::vector<MarkerPatch> fine =
      patches(pose, config_.max_final_pixels, choice, kFineWorthAThread);
  std::vector<MarkerPixels> pixels(fine.size());
  forEachIndex(fine.size(), threads_, kFineWorthAThread,
               [&](std::size_t i) { pixels[i] = fine[i].pixels(panorama_); });
  return pixels;
}

std::vector<MarkerPixels> MarkerFitter::someOf(const std::vector<MarkerPixels>& pixels) const {
  std::vector<MarkerPixels> some;
  some.reserve(pixels.size());
  const std::size_t share = static_cast<std::size_t>(config_.max_pixels) / pixels.size();
  const std::size_t enough = std::max(kLeastPixels, share);
  for (const MarkerPixels& all : pixels) {
    const std::size_t every = std::max<std::size_t>(1, all.size() / enough);
    MarkerPixels& part = some.emplace_back();
    part.reserve(all.size() / every + 1);
    for (std::size_t i = 0; i < all.size(); i += every) part.push_back(all[i]);
  }
  return some;
}

MarkerFitter::Fits MarkerFitter::fits(std::vector<MarkerPixels> pixels,
                                      const Alignment& alignment) const {
  Fits fits(pixels.size());
  std::size_t count = 1;
  for (const MarkerPixels& of_marker : pixels) count += of_marker.size();
  const std::size_t worth_a_thread = 1 + kFitWorthAThread * pixels.size() / count;
  forEachIndex(fits.size(), threads_, worth_a_thread,
               [&](std::size_t i) { fits[i] = fitOf(i, std::move(pixels[i]), alignment); });
  return fits;
}

PixelNoise MarkerFitter::noise(const Fits& fits, const Eigen::Vector3d& change) const {
  constexpr std::size_t kEnough = 1000;
  std::size_t count = 0;
  for (const auto& fit : fits) count += fit ? fit->pixels.size() : 0;
  const std::size_t every = 1 + count / kEnough;
  std::vector<PixelResidual> residuals;
  for (const auto& fit : fits) {
    if (!fit) continue;
    const Light light = fit->patch.lightAfter(change);
    for (std::size_t i = 0; i < fit->pixels.size(); i += every) {
      residuals.push_back(residualOf(fit->pixels[i], light, change));
    }
  }
  return noiseOf(std::move(residuals), config_.min_noise);
}

std::optional<MarkerFit> MarkerFitter::fitOf(std::size_t index, MarkerPixels pixels,
                                             const Alignment& alignment) const {
  const std::optional<LitPatch> lit =
      fitLight(pixels, alignment.noise, alignment.lights[index], alignment.expected_change);
  if (!lit) return std::nullopt;
  const Eigen::Matrix3d misplacement =
      misplacementOf(map_.markers[entries_[index]], camera_, alignment.pose, config_);
  // (information^-1 + misplacement)^-1, also where the information has no inverse.
  const Eigen::Matrix3d share =
      (Eigen::Matrix3d::Identity() + lit->information * misplacement).inverse();
  return MarkerFit{std::move(pixels), *lit, misplacement, share};
}

std::vector<MarkerPatch> MarkerFitter::patches(const Pose2& pose, int max_pixels,
                                               const MarkerPatch::Choice& choice,
                                               std::size_t worth_a_thread) const {
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
    own.max_at_edges =
        std::max(kLeastPixels, static_cast<std::size_t>(max_pixels * areas[i] / whole));
    own.max_on_even_ground = std::min(own.max_at_edges / 8, kEnoughForLight);
    own.max_considered = kLookedAt * own.max_at_edges;
    made[i].emplace(marker, patterns_.of(marker), camera_, pose, config_.blur, own);
  });
  std::vector<MarkerPatch> patches;
  patches.reserve(made.size());
  for (std::optional<MarkerPatch>& patch : made) patches.push_back(std::move(*patch));
  return patches;
}

double MarkerFitter::areaOf(const Marker& marker, const Pose2& pose) const {
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

}  // namespace omnitag
