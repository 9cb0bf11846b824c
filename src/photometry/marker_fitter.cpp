#include "photometry/marker_fitter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/parallel.h"
#include "measurement/marker_misplacement.h"
#include "photometry/blur_fit.h"

namespace omnitag {
namespace {

/// How many markers are worth a thread.
constexpr std::size_t kRoughWorthAThread = 8;
constexpr std::size_t kFineWorthAThread = 2;

/// How many pixels to fit are worth a thread.
constexpr std::size_t kFitWorthAThread = 700;

/// Most facets along a marker's side, and least pixels along the side of a facet if there
/// are several.
constexpr int kMostFacets = 6;
constexpr double kFacet = 4.0;

/// Least number of pixels of a marker, whatever the limits in total.
constexpr std::size_t kLeastPixels = 75;

PoseMatrix misplacementOf(const Marker& marker, const MountedCamera& camera, const Pose& pose,
                          const PhotometricConfig& config) {
  FrameJacobian by_frame;
  if (!camera.pixelFromMap(pose, marker.center(), &by_frame)) return PoseMatrix::Zero();
  const double pixels_per_metre = by_frame.leftCols<2>().norm();
  return seenFrom(pose, marker,
                  omnitag::misplacementOf(marker, camera.model(), pixels_per_metre,
                                          config.alignment_deviation));
}

}  // namespace

FrameEquations MarkerFit::equationsWithErrors(const PixelNoise& noise,
                                              const FrameVector& change) const {
  FrameEquations of_pixels;
  of_pixels.information = patch.information;
  of_pixels.gradient = patch.gradient;
  of_pixels.by_chance = gradientCovariance(pixels, patch, noise, change);
  of_pixels.by_shared = patch.by_shape;
  return withMisplacement(of_pixels, misplacement);
}

std::vector<MarkerPatch> MarkerFitter::roughPatches(const Pose& pose) const {
  MarkerPatch::Choice choice;
  choice.tolerance = 0.1;
  choice.facets = 2;
  return patches(camera_, pose, config_.max_pixels, choice, kRoughWorthAThread);
}

MarkerFitter::Fits MarkerFitter::fits(const std::vector<MarkerPatch>& patches,
                                      const std::vector<LinesOfSight>& lines,
                                      const Alignment& alignment) const {
  Fits fits(patches.size());
  forEachIndex(fits.size(), threads_, kRoughWorthAThread, [&](std::size_t i) {
    fits[i] = fitOf(i,
                    patches[i].pixels(panorama_, lines[i], alignment.pose, alignment.error,
                                      changesByShape(patches[i].facets(), alignment.shapes[i],
                                                     camera_.model().uncertainty())),
                    alignment);
  });
  return fits;
}

std::vector<MarkerPixels> MarkerFitter::finePixels(const Alignment& alignment) const {
  MarkerPatch::Choice choice;
  choice.reach = 0.0;
  choice.facets = kMostFacets;
  const MountedCamera camera = camera_.withError(alignment.error);
  const std::vector<MarkerPatch> fine =
      patches(camera, alignment.pose, config_.max_final_pixels, choice, kFineWorthAThread);
  std::vector<MarkerPixels> pixels(fine.size());
  forEachIndex(fine.size(), threads_, kFineWorthAThread, [&](std::size_t i) {
    pixels[i] = fine[i].pixels(panorama_, changesByShape(fine[i].facets(), alignment.shapes[i],
                                                         camera_.model().uncertainty()));
  });
  return pixels;
}

std::vector<MarkerPixels> MarkerFitter::someOf(const std::vector<MarkerPixels>& pixels) const {
  std::vector<MarkerPixels> some;
  some.reserve(pixels.size());
  const std::size_t share = static_cast<std::size_t>(config_.max_pixels) / pixels.size();
  const std::size_t enough = std::max(kLeastPixels, share);
  for (const MarkerPixels& of_marker : pixels) {
    const std::vector<MarkerPixel>& all = of_marker.pixels;
    const std::size_t every = std::max<std::size_t>(1, all.size() / enough);
    MarkerPixels& part = some.emplace_back();
    part.grid = of_marker.grid;
    part.pixels.reserve(all.size() / every + 1);
    for (std::size_t i = 0; i < all.size(); i += every) part.pixels.push_back(all[i]);
  }
  return some;
}

MarkerFitter::Fits MarkerFitter::fits(std::vector<MarkerPixels> pixels,
                                      const Alignment& alignment) const {
  Fits fits(pixels.size());
  std::size_t count = 1;
  for (const MarkerPixels& of_marker : pixels) count += of_marker.pixels.size();
  const std::size_t worth_a_thread = 1 + kFitWorthAThread * pixels.size() / count;
  forEachIndex(fits.size(), threads_, worth_a_thread,
               [&](std::size_t i) { fits[i] = fitOf(i, std::move(pixels[i]), alignment); });
  return fits;
}

BlurEquations MarkerFitter::blur(const Fits& fits, const PixelNoise& noise,
                                 const FrameVector& change) const {
  constexpr std::size_t kEnough = 200;  // pixels of all markers
  BlurEquations sum;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i]) continue;
    const TagPattern& pattern = patterns_.of(map_.markers[entries_[i]]);
    sum.add(blurEquationsOf(fits[i]->pixels, fits[i]->patch, pattern, camera_, noise, change,
                            kEnough / fits.size() + 1));
  }
  return sum;
}

PixelNoise MarkerFitter::noise(const Fits& fits, const FrameVector& change) const {
  constexpr std::size_t kEnough = 1000;
  std::size_t count = 0;
  for (const auto& fit : fits) count += fit ? fit->pixels.pixels.size() : 0;
  const std::size_t every = 1 + count / kEnough;
  std::vector<PixelResidual> residuals;
  for (const auto& fit : fits) {
    if (!fit) continue;
    const Light light = fit->patch.lightAfter(change);
    const std::vector<Eigen::Vector2d> changes = fit->patch.positionChanges(fit->pixels, change);
    const std::vector<MarkerPixel>& pixels = fit->pixels.pixels;
    for (std::size_t i = 0; i < pixels.size(); i += every) {
      const auto facet = static_cast<std::size_t>(pixels[i].facet);
      residuals.push_back(residualOf(pixels[i], light, changes[facet]));
    }
  }
  return noiseOf(std::move(residuals), config_.min_noise);
}

std::optional<MarkerFit> MarkerFitter::fitOf(std::size_t index, MarkerPixels pixels,
                                             const Alignment& alignment) const {
  const std::optional<LitPatch> lit =
      fitLight(pixels, alignment.noise, camera_.model().uncertainty(), alignment.shapes[index],
               {alignment.lights[index], alignment.expected_change,
                alignment.expected_shape_changes[index]});
  if (!lit) return std::nullopt;
  const PoseMatrix misplacement =
      misplacementOf(map_.markers[entries_[index]], camera_, alignment.pose, config_);
  FrameEquations of_pixels;
  of_pixels.information = lit->information;
  of_pixels.gradient = lit->gradient;
  return MarkerFit{std::move(pixels), *lit, misplacement,
                   withMisplacement(of_pixels, misplacement)};
}

std::vector<MarkerPatch> MarkerFitter::patches(const MountedCamera& camera, const Pose& pose,
                                               int max_pixels, const MarkerPatch::Choice& choice,
                                               std::size_t worth_a_thread) const {
  constexpr std::size_t kEnoughForLight = 60;
  // This many times more are considered, to find those at edges.
  constexpr std::size_t kLookedAt = 2;
  std::vector<double> areas;
  for (const std::size_t entry : entries_) areas.push_back(areaOf(map_.markers[entry], pose));
  const double whole = std::accumulate(areas.begin(), areas.end(), 1.0);
  std::vector<std::optional<MarkerPatch>> made(entries_.size());
  forEachIndex(entries_.size(), threads_, worth_a_thread, [&](std::size_t i) {
    const Marker& marker = map_.markers[entries_[i]];
    MarkerPatch::Choice own = choice;
    own.facets = std::min(choice.facets, 1 + static_cast<int>(std::sqrt(areas[i]) / kFacet));
    own.max_at_edges =
        std::max(kLeastPixels, static_cast<std::size_t>(max_pixels * areas[i] / whole));
    own.max_on_even_ground = std::min(own.max_at_edges / 8, kEnoughForLight);
    own.max_considered = kLookedAt * own.max_at_edges;
    made[i].emplace(marker, patterns_.of(marker), camera, pose, own);
  });
  std::vector<MarkerPatch> patches;
  patches.reserve(made.size());
  for (std::optional<MarkerPatch>& patch : made) patches.push_back(std::move(*patch));
  return patches;
}

double MarkerFitter::areaOf(const Marker& marker, const Pose& pose) const {
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
