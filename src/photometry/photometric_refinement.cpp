#include "photometry/photometric_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "measurement/frame_equations.h"
#include "photometry/lit_patch.h"
#include "photometry/marker_fitter.h"
#include "photometry/marker_patch.h"
#include "photometry/pixel_noise.h"

namespace omnitag {
namespace {

/// Equations for a frame's unknowns.
struct Linearization {
  MarkerFitter::Fits fits;
  FrameEquations equations;
};

/// Sums the equations of the markers, each with its weight, and of the priors.
Linearization combine(MarkerFitter::Fits fits, const PosePrior& prior, const Alignment& alignment) {
  FrameEquations markers;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i]) markers.add(fits[i]->equations, alignment.weights[i]);
  }
  return {std::move(fits), withPriors(markers, prior, alignment.pose, alignment.error)};
}

/// Weight of a marker after this change of the unknowns: less for one that disagrees with the
/// others, because it is shaded, or misplaced by more than the map allows.
double weightOf(const MarkerFit& fit, const FrameVector& change) {
  // 95 of 100 markers stay below this chi-square; their pixels usually err twice as much as they
  // would independently of each other.
  constexpr double kDisagreement = 12.59;
  // If the marker leaves a direction almost undetermined, rounding may make this negative.
  const double chi_square =
      chiSquareOf(fit.equations, fit.equations.information.topLeftCorner<6, 6>(), change);
  return chi_square > kDisagreement ? kDisagreement / chi_square : 1.0;
}

/// Weights the markers by how well they agree with a change of the unknowns.
void weigh(const Linearization& all, const FrameVector& change, Alignment* alignment) {
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (all.fits[i]) alignment->weights[i] = weightOf(*all.fits[i], change);
  }
}

/// The change of the unknowns that fits best; nothing if they are not determined.
std::optional<FrameVector> changeOf(const Linearization& all) {
  const bool is_seen = std::any_of(all.fits.begin(), all.fits.end(),
                                   [](const auto& fit) { return fit.has_value(); });
  return is_seen ? solutionOf(all.equations) : std::nullopt;
}

/// Keeps the lights, and expects the shapes, that fit best after this change of the unknowns.
void keepLights(const Linearization& all, const FrameVector& change, Alignment* alignment) {
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    if (!all.fits[i]) continue;
    alignment->lights[i] = all.fits[i]->patch.lightAfter(change);
    alignment->expected_shape_changes[i] = all.fits[i]->patch.shapeChangeAfter(change);
  }
}

/// Changes the unknowns, the shapes and the lights.
void apply(const Linearization& all, const FrameVector& change, Alignment* alignment) {
  alignment->pose = moved(alignment->pose, change.head<6>());
  alignment->error += change.tail<kImagingUnknowns>();
  keepLights(all, change, alignment);
  for (std::size_t i = 0; i < all.fits.size(); ++i) {
    alignment->shapes[i] += alignment->expected_shape_changes[i];
    alignment->expected_shape_changes[i].setZero();
  }
}

/// Displacement of a marker's edges by these changes, RMS, in pixels.
double displacementOf(const MarkerPixels& pixels, const FacetChanges& changes) {
  if (changes.empty()) return 0.0;
  double squares = 0.0;
  double gradient_squares = 0.0;
  for (const MarkerPixel& pixel : pixels.pixels) {
    const auto facet = static_cast<std::size_t>(pixel.facet);
    squares += std::pow(pixel.white_by_position.dot(changes[facet]), 2);
    gradient_squares += pixel.gradient * pixel.gradient;
  }
  return gradient_squares > 0.0 ? std::sqrt(squares / gradient_squares) : 0.0;
}

/// Largest change of a pose in one step, in m and rad. In directions that the markers leave open,
/// the edges hardly limit the step, and do not follow it linearly.
constexpr double kShort = 0.01;

/// Largest displacement of a marker's edges in one step, in pixels. What a pixel sees of an edge
/// changes linearly as long as the edge stays well within it.
constexpr double kNear = 0.05;

/// Whether pixels follow a change of the unknowns linearly.
bool isShort(const Linearization& all, const FrameVector& change) {
  return change.head<6>().cwiseAbs().maxCoeff() < kShort &&
         std::all_of(all.fits.begin(), all.fits.end(), [&change](const auto& fit) {
           return !fit || displacementOf(fit->pixels, fit->pixels.positionChanges(change)) < kNear;
         });
}

/// Whether the pixels follow the changes of the markers' shapes linearly enough: the shapes
/// themselves are of no interest.
bool areBentLittle(const Linearization& all, const FrameVector& change) {
  constexpr double kLittle = 0.3;  // pixels
  return std::all_of(all.fits.begin(), all.fits.end(), [&](const auto& fit) {
    return !fit || displacementOf(fit->pixels, changesByShape(fit->pixels.facets(),
                                                              fit->patch.shapeChangeAfter(change),
                                                              fit->patch.uncertainty)) < kLittle;
  });
}

/// Whether the unknowns are so near the optimum that one step suffices. Learns the step, the noise
/// and the lights along the way. `some`: some of each marker's pixels, from the alignment's pose.
bool isNear(const MarkerFitter& fitter, std::vector<MarkerPixels> some, const PosePrior& prior,
            Alignment* alignment) {
  const Linearization all = combine(fitter.fits(std::move(some), *alignment), prior, *alignment);
  const std::optional<FrameVector> change = changeOf(all);
  if (!change || !isShort(all, *change) || !areBentLittle(all, *change)) return false;
  alignment->expected_change = *change;
  alignment->noise = fitter.noise(all.fits, *change);
  keepLights(all, *change, alignment);
  return true;
}

/// Takes steps until they hardly change anything. False if they do not converge.
bool converge(const MarkerFitter& fitter, const std::vector<MarkerPatch>& patches,
              const PosePrior& prior, Alignment* alignment) {
  constexpr int kMaxSteps = 25;
  // In standard deviations of the estimate from these pixels; the last step's pixels determine
  // far more.
  constexpr double kConverged = 1.0;
  std::vector<LinesOfSight> lines;
  lines.reserve(patches.size());
  for (const MarkerPatch& patch : patches) lines.push_back(patch.linesOfSight());
  for (int step = 0; step < kMaxSteps; ++step) {
    const Linearization all = combine(fitter.fits(patches, lines, *alignment), prior, *alignment);
    const std::optional<FrameVector> change = changeOf(all);
    if (!change) return false;
    apply(all, *change, alignment);
    const PixelNoise before = std::exchange(alignment->noise, fitter.noise(all.fits, *change));
    const PixelNoise& noise = alignment->noise;
    const bool is_settled = step > 0 && std::abs(noise.flat - before.flat) < 0.2 * noise.flat &&
                            std::abs(noise.edge - before.edge) < 0.2 * noise.edge + 0.01;
    if (is_settled && change->dot(all.equations.information * *change) < kConverged * kConverged) {
      return true;
    }
    weigh(all, *change, alignment);
  }
  return false;
}

/// The last step from a pose that is nearly right, and the equations that it solves.
struct FinalStep {
  Linearization all;
  FrameVector change;
};

/// `pixels`: of each marker, from the alignment's pose. They are many, and show better than fewer
/// which markers disagree. Nothing if they leave the pose undetermined.
std::optional<FinalStep> finalStep(const MarkerFitter& fitter, std::vector<MarkerPixels> pixels,
                                   const PosePrior& prior, Alignment* alignment) {
  Linearization all = combine(fitter.fits(std::move(pixels), *alignment), prior, *alignment);
  std::optional<FrameVector> change = changeOf(all);
  for (int round = 0; round < 2 && change; ++round) {
    weigh(all, *change, alignment);
    all = combine(std::move(all.fits), prior, *alignment);
    change = changeOf(all);
  }
  if (!change) return std::nullopt;
  return FinalStep{std::move(all), *change};
}

/// How much the markers disagree about a change of the unknowns. `markers`: nothing for one that is
/// not seen.
Disagreement disagreementOf(const std::vector<std::optional<FrameEquations>>& markers,
                            const FrameVector& change, const ImagingError& error) {
  constexpr int kUnknowns = 6;
  double chi_square = error.squaredNorm();
  int freedom = possibleErrors(error) - kUnknowns;
  int seen = 0;
  for (const std::optional<FrameEquations>& marker : markers) {
    if (!marker) continue;
    chi_square += chiSquareOf(*marker, change);
    freedom += kUnknowns;
    ++seen;
  }
  if (seen < 2) return {};
  return {chi_square, static_cast<double>(freedom)};
}

/// The factor by which squared errors in an image exceed `lasting`, at least 1. If that is not by
/// chance, something hides, shades or displaces a marker, or the camera is farther off than its
/// file says.
double surpriseOf(const Disagreement& image, double lasting) {
  // Factor by which one marker's squared errors exceed what its pixels show on average, from the
  // NEES of 1,900 poses from one marker.
  constexpr double kOfOne = 1.2;
  if (image.freedom <= 0.0) return kOfOne;
  // Chance exceeds this in one of a hundred frames.
  constexpr double kDeviations = 2.6;
  const double chi_square = image.chi_square / lasting;
  const bool is_by_chance =
      chi_square < image.freedom + kDeviations * std::sqrt(2.0 * image.freedom);
  return is_by_chance ? 1.0 : chi_square / image.freedom;
}

/// The result of the last step: the estimate's terms are weighted as its equations say, and err as
/// the residuals show (the sandwich of Huber and White).
PhotometricFit fitAfter(const FinalStep& step, const PosePrior& prior, const Alignment& alignment,
                        double lasting_excess) {
  std::vector<std::optional<FrameEquations>> markers;
  markers.reserve(step.all.fits.size());
  for (const std::optional<MarkerFit>& fit : step.all.fits) {
    markers.push_back(fit ? std::optional(fit->equationsWithErrors(alignment.noise, step.change))
                          : std::nullopt);
  }
  FrameEquations sum;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (markers[i]) sum.add(*markers[i], alignment.weights[i]);
  }
  PhotometricFit fit;
  fit.imaging_error = alignment.error + step.change.tail<kImagingUnknowns>();
  fit.disagreement = disagreementOf(markers, step.change, fit.imaging_error);
  fit.surprise = surpriseOf(fit.disagreement, lasting_excess);
  fit.excess = lasting_excess * fit.surprise;
  fit.map_from_base =
      estimateOf(sum, prior, moved(alignment.pose, step.change.head<6>()), fit.excess);
  for (std::optional<FrameEquations>& marker : markers) {
    if (marker) marker->gradient -= marker->information * step.change;
  }
  fit.markers = std::move(markers);
  return fit;
}

}  // namespace

double photometricMisfit(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
                         const TagPatterns& patterns, const std::vector<std::size_t>& entries,
                         const Pose& map_from_base, const PhotometricFit& fit,
                         const PhotometricConfig& config) {
  const MarkerFitter fitter(panorama, map, camera, patterns, entries, config, 1);
  const PixelNoise noise{fit.noise, fit.edge_noise};
  double misfit = 0.0;
  for (const MarkerPatch& patch : fitter.roughPatches(map_from_base)) {
    const MarkerPixels pixels =
        patch.pixels(panorama, patch.linesOfSight(), map_from_base, ImagingError::Zero());
    const auto lit = fitLight(pixels, noise, camera.model().uncertainty(), Shape::Zero(), {});
    if (!lit) return std::numeric_limits<double>::infinity();
    const std::vector<Eigen::Vector2d> changes = lit->positionChanges(pixels, FrameVector::Zero());
    for (const MarkerPixel& pixel : pixels.pixels) {
      const PixelResidual residual =
          residualOf(pixel, lit->light, changes[static_cast<std::size_t>(pixel.facet)]);
      misfit += weightOf(residual, noise) * residual.grey * residual.grey;
    }
  }
  return misfit;
}

std::optional<PhotometricFit> refinePhotometrically(
    const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
    const TagPatterns& patterns, const std::vector<std::size_t>& entries, const Pose& initial,
    const PosePrior& prior, const PhotometricConfig& config, int threads, double lasting_excess) {
  if (entries.empty()) return std::nullopt;
  const MarkerFitter fitter(panorama, map, camera, patterns, entries, config, threads);
  Alignment start;
  start.pose = initial;
  start.weights.assign(entries.size(), 1.0);
  start.lights.resize(entries.size());
  start.shapes.assign(entries.size(), Shape::Zero());
  start.expected_shape_changes = start.shapes;
  Alignment alignment = start;
  std::optional<FinalStep> step;
  std::vector<MarkerPixels> pixels = fitter.finePixels(start);
  if (isNear(fitter, fitter.someOf(pixels), prior, &alignment)) {
    step = finalStep(fitter, std::move(pixels), prior, &alignment);
  }
  if (!step || !isShort(step->all, step->change)) {
    alignment = start;
    if (!converge(fitter, fitter.roughPatches(initial), prior, &alignment)) return std::nullopt;
    step = finalStep(fitter, fitter.finePixels(alignment), prior, &alignment);
  }
  if (!step) return std::nullopt;
  const PixelNoise noise = fitter.noise(step->all.fits, step->change);
  PhotometricFit result = fitAfter(*step, prior, alignment, lasting_excess);
  result.blur = fitter.blur(step->all.fits, noise, step->change);
  result.noise = noise.flat;
  result.edge_noise = noise.edge;
  result.weights = std::move(alignment.weights);
  return result;
}

}  // namespace omnitag
