#include "omnitag/localization/recognition.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "omnitag/localization/marker_patch.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {
namespace {

/// A pixel's share of white in the marker as it should image, and how that changes from pixel to
/// pixel.
struct Sample {
  int column;
  int row;
  double white;
  Eigen::Vector2d by_pixel;
};

/// Pixels of the marker that are looked at, about: more would only make it slower.
constexpr double kPixels = 300.0;

/// Where its place is searched for, one of so many of those, if there are enough.
constexpr std::size_t kCoarse = 2;
constexpr std::size_t kEnough = 150;

/// Pixels; however small the marker, it is worth to look for it so far around.
constexpr double kLeastMargin = 3.0;

int stepFor(const PredictedMarker& predicted, const TagPattern& pattern) {
  const double edge = meanEdge(predicted.corners) * pattern.width() / pattern.widthBetweenCorners();
  return std::max(1, static_cast<int>(std::sqrt(edge * edge / kPixels)));
}

/// What is seen of a marker that is displaced: the pixels move as far as whole pixels go, and what
/// they see of the marker by the rest. (Grey levels between pixels would be blurred.) Leaves out
/// what is then off the marker or the panorama.
std::vector<Footprint> displaced(const std::vector<Footprint>& footprints,
                                 const Eigen::Vector2d& displacement, const cv::Size& panorama,
                                 double width) {
  const Eigen::Vector2d whole = displacement.array().round();
  const cv::Point offset(static_cast<int>(whole.x()), static_cast<int>(whole.y()));
  const cv::Rect image({0, 0}, panorama);
  std::vector<Footprint> moved;
  moved.reserve(footprints.size());
  for (Footprint footprint : footprints) {
    footprint.column += offset.x;
    footprint.row += offset.y;
    footprint.position += footprint.by_pixel * (whole - displacement);
    const Eigen::Vector2d reach = 0.5 * footprint.sides.cwiseAbs().rowwise().sum();
    if (!image.contains({footprint.column, footprint.row}) ||
        (footprint.position - reach).minCoeff() < 0.0 ||
        (footprint.position + reach).maxCoeff() > width) {
      continue;
    }
    moved.push_back(footprint);
  }
  return moved;
}

std::vector<Sample> samplesOf(const std::vector<Footprint>& footprints, const TagPattern& pattern) {
  std::vector<Sample> samples;
  samples.reserve(footprints.size());
  for (const Footprint& footprint : footprints) {
    const TagPattern::White white =
        pattern.averageOver(footprint.position, footprint.sides.col(0), footprint.sides.col(1));
    samples.push_back({footprint.column, footprint.row, white.share,
                       footprint.by_pixel.transpose() * white.by_position});
  }
  return samples;
}

/// Moves the marker by whole pixels and returns where its pattern correlates best with the
/// panorama.
Eigen::Vector2i bestPlace(const cv::Mat& panorama, const std::vector<Sample>& samples,
                          const Eigen::Vector2i& reach, int step) {
  std::vector<Sample> coarse;
  double white_sum = 0.0;
  for (std::size_t i = 0; i<samples.size(); i += samples.size()> kEnough ? kCoarse : 1) {
    coarse.push_back(samples[i]);
    white_sum += samples[i].white;
  }
  const auto count = static_cast<double>(coarse.size());
  const double white_mean = white_sum / count;
  Eigen::Vector2i best = Eigen::Vector2i::Zero();
  double best_correlation = -1.0;
  for (int dv = -reach.y(); dv <= reach.y(); dv += step) {
    for (int du = -reach.x(); du <= reach.x(); du += step) {
      double sum = 0.0;
      double squares = 0.0;
      double product = 0.0;
      for (const Sample& sample : coarse) {
        const int row = std::clamp(sample.row + dv, 0, panorama.rows - 1);
        const int column = std::clamp(sample.column + du, 0, panorama.cols - 1);
        const double grey = panorama.ptr<std::uint8_t>(row)[column];
        sum += grey;
        squares += grey * grey;
        product += grey * (sample.white - white_mean);
      }
      const double variance = squares - sum * sum / count;
      const double correlation = variance > 0.0 ? product / std::sqrt(variance) : -1.0;
      if (correlation > best_correlation) {
        best_correlation = correlation;
        best = {du, dv};
      }
    }
  }
  return best;
}

/// A place of the marker, relative to where it is predicted, and the contrast that it has there.
struct Fit {
  Eigen::Vector2d displacement;
  double contrast;
};

/// Least squares over the displacement, and over grey = black + contrast * white.
std::optional<Fit> align(const cv::Mat& panorama, const std::vector<Footprint>& footprints,
                         const TagPattern& pattern, const Eigen::Vector2d& start) {
  constexpr int kMaxSteps = 10;
  constexpr double kConverged = 0.1;  // pixels; the last step leaves far less
  Fit fit{start, 0.0};
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::vector<Sample> samples = samplesOf(
        displaced(footprints, fit.displacement, panorama.size(), pattern.width()), pattern);
    // The unknowns: black, contrast, and contrast times the change of the displacement.
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right_side = Eigen::Vector4d::Zero();
    for (const Sample& sample : samples) {
      const Eigen::Vector4d x(1.0, sample.white, -sample.by_pixel.x(), -sample.by_pixel.y());
      const double grey = panorama.ptr<std::uint8_t>(sample.row)[sample.column];
      normal += x * x.transpose();
      right_side += grey * x;
    }
    const Eigen::LDLT<Eigen::Matrix4d> factors(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    const Eigen::Vector4d solution = factors.solve(right_side);
    fit.contrast = solution[1];
    if (!(fit.contrast > 0.0)) return std::nullopt;
    constexpr double kMaxChange = 1.5;
    Eigen::Vector2d change = solution.tail<2>() / fit.contrast;
    if (change.norm() > kMaxChange) change *= kMaxChange / change.norm();
    fit.displacement += change;
    if (change.norm() < kConverged) break;
  }
  return fit;
}

struct Comparison {
  double correlation = 0.0;
  /// In how many independent ways the data modules, as the pixels see them, can vary.
  double dimensions = 0.0;
};

/// Compares the data modules with the panorama, whatever the light and the other modules are.
std::optional<Comparison> compareData(const cv::Mat& panorama,
                                      const std::vector<Footprint>& footprints,
                                      const TagPattern& pattern) {
  const Eigen::Index bits = pattern.dataModules();
  Eigen::VectorXd signs(bits);
  for (int bit = 0; bit < bits; ++bit) signs[bit] = pattern.isDataWhite(bit) ? 1.0 : -1.0;

  constexpr Eigen::Index kNuisances = 5;
  const auto count = static_cast<Eigen::Index>(footprints.size());
  // One column for each pixel.
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(bits, count);
  Eigen::MatrixXd nuisances(kNuisances, count);
  Eigen::VectorXd greys(count);
  Eigen::Index used = 0;
  for (const Footprint& footprint : footprints) {
    shares.col(used).setZero();
    pattern.addDataShares(footprint.position, footprint.sides.col(0), footprint.sides.col(1),
                          shares.col(used));
    const double data = shares.col(used).sum();
    constexpr double kLeastData = 0.05;
    if (data < kLeastData) continue;
    const double white =
        pattern.averageOver(footprint.position, footprint.sides.col(0), footprint.sides.col(1))
            .share;
    const double data_white = 0.5 * (data + shares.col(used).dot(signs));
    const Eigen::Vector2d place = footprint.position / pattern.width();
    nuisances.col(used) << 1.0, place.x(), place.y(), white - data_white, data;
    greys[used] = panorama.ptr<std::uint8_t>(footprint.row)[footprint.column];
    ++used;
  }
  if (used <= kNuisances + 2) return std::nullopt;
  shares.conservativeResize(Eigen::NoChange, used);
  nuisances.conservativeResize(Eigen::NoChange, used);
  greys.conservativeResize(used);

  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(nuisances.transpose());
  const Eigen::MatrixXd basis =
      decomposition.householderQ() * Eigen::MatrixXd::Identity(used, decomposition.rank());
  shares -= (shares * basis) * basis.transpose();
  greys -= basis * (basis.transpose() * greys);
  const Eigen::VectorXd expected = shares.transpose() * signs;
  const double norms = expected.norm() * greys.norm();
  if (!(norms > 1e-9)) return std::nullopt;
  Comparison comparison;
  comparison.correlation = expected.dot(greys) / norms;
  // Of random signs r, the correlation with the expected ones s has the variance
  // |G s|^2 / (s'G s tr G), G = A'A; of n independent dimensions it would be 1 / n.
  comparison.dimensions =
      expected.squaredNorm() * shares.squaredNorm() / (shares * expected).squaredNorm();
  return comparison;
}

}  // namespace

RecognitionConfig readRecognitionConfig(const YamlReader& reader) {
  reader.allowOnly({"max_margin", "false_accept_rate", "min_contrast", "period"});
  RecognitionConfig config;
  reader.read("max_margin", &config.max_margin, kNonNegative);
  reader.read("false_accept_rate", &config.false_accept_rate, {1e-12, 0.1});
  reader.read("min_contrast", &config.min_contrast, kPositive);
  reader.read("period", &config.period, kPositive);
  return config;
}

double correlationThreshold(double dimensions, double rate) {
  if (dimensions <= 1.0) return 1.0;
  return std::sqrt(1.0 - std::min(1.0, std::pow(2.0 * rate, 2.0 / (dimensions - 1.0))));
}

std::optional<Recognition> recognize(const cv::Mat& panorama, const Marker& marker,
                                     const TagPattern& pattern, const MountedCamera& camera,
                                     const Pose2& map_from_base, const PredictedMarker& predicted,
                                     double blur, const RecognitionConfig& config) {
  const double module = meanEdge(predicted.corners) / pattern.widthBetweenCorners();
  const double margin = std::max(predicted.tangential_margin, predicted.radial_margin);
  if (margin > std::max(kLeastMargin, config.max_margin * module)) return std::nullopt;
  MarkerPatch::Choice choice;
  choice.step = stepFor(predicted, pattern);
  const MarkerPatch patch(marker, pattern, camera, map_from_base, blur, choice);
  const std::vector<Footprint> footprints = patch.footprints(map_from_base);
  constexpr std::size_t kFewestPixels = 24;
  if (footprints.size() < kFewestPixels) return std::nullopt;
  const std::vector<Sample> samples = samplesOf(footprints, pattern);

  // Alignment finds its way from a third of a module.
  const int step = std::max(1, static_cast<int>(0.5 * module));
  const int steps = static_cast<int>(std::ceil(margin / step));
  const Eigen::Vector2i reach(steps * step, steps * step);
  const Eigen::Vector2i place = bestPlace(panorama, samples, reach, step);
  const std::optional<Fit> fit = align(panorama, footprints, pattern, place.cast<double>());
  if (!fit || fit->contrast < config.min_contrast) return std::nullopt;
  const double limit = reach.x() + 1.0;
  if (fit->displacement.cwiseAbs().maxCoeff() > limit) return std::nullopt;
  const auto comparison = compareData(
      panorama, displaced(footprints, fit->displacement, panorama.size(), pattern.width()),
      pattern);
  if (!comparison) return std::nullopt;
  const double trials = (2.0 * steps + 1.0) * (2.0 * steps + 1.0);
  return Recognition{
      fit->displacement, comparison->correlation,
      correlationThreshold(comparison->dimensions, config.false_accept_rate / trials)};
}

}  // namespace omnitag
