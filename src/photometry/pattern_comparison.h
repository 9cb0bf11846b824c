#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/marker/tag_pattern.h"
#include "omnitag/photometry/marker_patch.h"
#include "pattern_alignment.h"

namespace omnitag {

/// How a panorama compares with what a marker's data modules should look like, whatever the light
/// is and whatever the layout fixes.
class PatternComparison {
 public:
  /// Nothing where too few pixels see data modules, or where these should all look alike.
  static std::optional<PatternComparison> of(const cv::Mat& panorama,
                                             const std::vector<Footprint>& footprints,
                                             const Placement& placement, const TagPattern& pattern);

  double correlation() const { return correlation_; }

  /// In how many independent ways the data modules, as the pixels see them, can vary.
  double dimensions() const { return dimensions_; }

  /// Whether the pixels are likelier by this factor (its logarithm) to show the pattern than
  /// modules that are black or white at random, each at the noise that suits it best. Where they do
  /// show such modules, that happens no more often than once in as many cases (Markov's
  /// inequality). Unlike a correlation, this does not ask strong and coarse features to be as sharp
  /// as weak and fine ones: a pattern that is blurred still tells by what the noise leaves of it.
  bool isLikelierThanOthers(double log_ratio) const;

 private:
  static constexpr int kNuisances = 5;
  using Nuisances = Eigen::Matrix<double, kNuisances, 1>;

  /// A pixel that sees something of data modules.
  struct DataPixel {
    double grey = 0.0;
    /// What it would see of the data modules if black were -1.
    double expected = 0.0;
    /// What else may have made it so bright: the light, and what the layout fixes.
    Nuisances nuisances = Nuisances::Zero();
    /// Of the modules' shares in all pixels, how many belong to this one and those before.
    std::ptrdiff_t shares_end = 0;
  };

  PatternComparison() = default;
  void look(const cv::Mat& panorama, const std::vector<Footprint>& footprints,
            const Placement& placement, const TagPattern& pattern);
  bool compare();

  /// One after the other with their shares. Grey levels and what is expected are without what the
  /// nuisances explain, once they were compared.
  std::vector<DataPixel> pixels_;
  std::vector<TagPattern::DataShare> shares_;
  Eigen::Matrix<double, kNuisances, Eigen::Dynamic> in_shares_;
  /// Sums over the pixels.
  double product_ = 0.0;
  double grey_squares_ = 0.0;
  double expected_squares_ = 0.0;
  double correlation_ = 0.0;
  double dimensions_ = 0.0;
};

}  // namespace omnitag
