#include "photometry/pattern_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdint>

namespace omnitag {
namespace {

/// In pixels; the last step leaves far less. On the way a coarser limit suffices.
constexpr double kConverged = 0.1;
constexpr double kConvergedOnTheWay = 0.3;

/// Widths of the pattern's features. If pixels see less of the pattern than this, it is blurred by
/// this much until it is nearly in place: only pixels that see an edge determine where it should
/// be.
constexpr double kBlurOnTheWay = 0.2;

/// The unknowns: black, contrast, and contrast times the change of the displacement and, row by
/// row, of the stretch.
constexpr int kDisplaced = 4;
constexpr int kStretched = 8;

/// Largest distance of a footprint from the middle, in pixels: scales the stretch to pixels.
double sizeOf(const std::vector<Footprint>& footprints, const Eigen::Vector2d& middle) {
  double size = 1.0;
  for (const Footprint& footprint : footprints) {
    size = std::max(size, (Eigen::Vector2d(footprint.column, footprint.row) - middle).norm());
  }
  return size;
}

class Aligner {
 public:
  Aligner(const cv::Mat& panorama, const std::vector<Footprint>& footprints,
          const TagPattern& pattern, const Placement& start)
      : panorama_(panorama),
        footprints_(footprints),
        pattern_(pattern),
        fit_{start, 0.0},
        size_(sizeOf(footprints, start.predicted_middle)) {}

  /// Takes steps with this many unknowns until they hardly change anything; false if that fails.
  template <int Unknowns>
  bool converge(double blur) {
    constexpr int kMaxSteps = 10;
    const double enough = blur > 0.0 ? kConvergedOnTheWay : kConverged;
    for (int i = 0; i < kMaxSteps; ++i) {
      const std::optional<double> change = step<Unknowns>(blur);
      if (!change) return false;
      if (*change < enough) break;
    }
    return true;
  }

  const PatternFit& fit() const { return fit_; }

 private:
  /// Norm of the change that it makes, in pixels.
  template <int Unknowns>
  std::optional<double> step(double blur) {
    using Vector = Eigen::Matrix<double, Unknowns, 1>;
    Eigen::Matrix<double, Unknowns, Unknowns> normal;
    normal.setZero();
    Vector right_side = Vector::Zero();
    Placement& placement = fit_.placement;
    visitPlaced(footprints_, placement, panorama_.size(), pattern_.width(), 0.5 * blur,
                [&](const Eigen::Vector2d& predicted, const Footprint& footprint) {
                  const TagPattern::White white = pattern_.average(
                      footprint.position, footprint.facet->window.size().cwiseMax(blur));
                  const Eigen::Vector2d by_displacement =
                      -footprint.facet->by_pixel.transpose() * white.by_position;
                  Vector x;
                  x.template head<kDisplaced>() << 1.0, white.share, by_displacement;
                  if constexpr (Unknowns == kStretched) {
                    const Eigen::Vector2d place = (predicted - placement.predicted_middle) / size_;
                    x.template segment<2>(4) = by_displacement.x() * place;
                    x.template segment<2>(6) = by_displacement.y() * place;
                  }
                  const double grey = panorama_.ptr<std::uint8_t>(footprint.row)[footprint.column];
                  normal.noalias() += x * x.transpose();
                  right_side += grey * x;
                });
    const Eigen::LDLT<Eigen::Matrix<double, Unknowns, Unknowns>> factors(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    const Vector solution = factors.solve(right_side);
    fit_.contrast = solution[1];
    if (!(fit_.contrast > 0.0)) return std::nullopt;
    constexpr double kMaxChange = 1.5;
    Eigen::Matrix<double, Unknowns - 2, 1> change =
        solution.template tail<Unknowns - 2>() / fit_.contrast;
    if (change.norm() > kMaxChange) change *= kMaxChange / change.norm();
    placement.displacement += change.template head<2>();
    if constexpr (Unknowns == kStretched) {
      placement.stretch.row(0) += change.template segment<2>(2).transpose() / size_;
      placement.stretch.row(1) += change.template segment<2>(4).transpose() / size_;
    }
    return change.norm();
  }

  const cv::Mat& panorama_;
  const std::vector<Footprint>& footprints_;
  const TagPattern& pattern_;
  PatternFit fit_;
  double size_;
};

/// Whether some pixels see less of the pattern than the blur on the way.
bool isSharp(const std::vector<Footprint>& footprints, double blur) {
  return std::any_of(footprints.begin(), footprints.end(), [blur](const Footprint& footprint) {
    return footprint.facet->window.size().minCoeff() < blur;
  });
}

}  // namespace

std::optional<PatternFit> alignPattern(const cv::Mat& panorama,
                                       const std::vector<Footprint>& footprints,
                                       const TagPattern& pattern, const Placement& start,
                                       bool is_stretched) {
  Aligner aligner(panorama, footprints, pattern, start);
  const auto converge = [&](double blur) {
    return is_stretched ? aligner.converge<kStretched>(blur) : aligner.converge<kDisplaced>(blur);
  };
  const double blur = kBlurOnTheWay * pattern.featureWidth();
  const bool is_near =
      !isSharp(footprints, blur) ||
      (aligner.converge<kDisplaced>(blur) && (!is_stretched || aligner.converge<kStretched>(blur)));
  return is_near && converge(0.0) ? std::optional(aligner.fit()) : std::nullopt;
}

}  // namespace omnitag
