#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "marker/tag_pattern.h"
#include "photometry/marker_patch.h"
#include "photometry/pattern_alignment.h"

namespace omnitag {

/// Compares a panorama with the expected data modules, whatever the light is and whatever the
/// layout fixes.
class PatternComparison {
 public:
  /// Nothing if too few pixels see data modules, or if all of these should look alike.
  static std::optional<PatternComparison> of(const cv::Mat& panorama,
                                             const std::vector<Footprint>& footprints,
                                             const Placement& placement, const TagPattern& pattern);

  double correlation() const { return correlation_; }

  /// The number of independent ways in which the data modules, as the pixels see them, can vary.
  double dimensions() const { return dimensions_; }

  /// Whether the pixels are likelier by this factor (its logarithm) to show the pattern than
  /// modules that are black or white at random, each at the noise that suits it best. If they do
  /// show such modules, that happens at most once in as many cases (Markov's inequality). Unlike a
  /// correlation, this does not require strong, coarse features to be as sharp as weak, fine ones:
  /// a blurred pattern is accepted by what the noise leaves of it. False for pictures, whose cells
  /// are not independent.
  bool isLikelierThanOthers(double log_ratio) const;

 private:
  static constexpr int kNuisances = 5;
  using Nuisances = Eigen::Matrix<double, kNuisances, 1>;

  /// A pixel that sees something of data modules.
  struct DataPixel {
    double grey = 0.0;
    /// Expected value of the data modules with black as -1.
    double expected = 0.0;
    /// Other contributions to the grey level: the light, and what the layout fixes.
    Nuisances nuisances = Nuisances::Zero();
    /// End of this pixel's range in `shares_`.
    std::ptrdiff_t shares_end = 0;
  };

  PatternComparison() = default;
  void look(const cv::Mat& panorama, const std::vector<Footprint>& footprints,
            const Placement& placement, const TagPattern& pattern);
  bool compare(const TagPattern& pattern);
  double dimensionsOfPicture(const TagPattern& pattern) const;

  /// In `shares_`, each pixel's shares follow those of the pixel before. After compare(), grey
  /// levels and expected values are without what the nuisances explain.
  std::vector<DataPixel> pixels_;
  std::vector<TagPattern::DataShare> shares_;
  Eigen::Matrix<double, kNuisances, Eigen::Dynamic> in_shares_;
  /// Sums over the pixels.
  double product_ = 0.0;
  double grey_squares_ = 0.0;
  double expected_squares_ = 0.0;
  double correlation_ = 0.0;
  double dimensions_ = 0.0;
  /// Sum over the pixels of the windows' areas, in modules squared.
  double window_areas_ = 0.0;
  bool are_modules_independent_ = true;
};

}  // namespace omnitag
