#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "marker/pattern_picture.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Which picture a square shows.
struct PictureMatch {
  int id = 0;
  /// Those of the square, from the lower left of the upright picture on.
  Corners<Eigen::Vector2d> corners;
  double correlation = 0.0;
  /// Grey levels, standard deviation within the border.
  double contrast = 0.0;
  /// The border is at least as wide as 1 / this of the edge.
  int modules_per_edge = 0;
};

/// Identifies which of some pictures is within the border of a square, by normalized correlation in
/// all four turns, whatever the light and however blurred the image.
///
/// A match must be unlikely to come about by chance (correlationThreshold(), with the dimensions
/// that the blur leaves of the picture's own), and likelier than any other picture and turn: for n
/// independent parts with noise of unknown size, the likelihoods of two pictures that correlate
/// with the square by a and b have the ratio ((1 - b^2) / (1 - a^2))^(n / 2). A picture that looks
/// the same when turned is thus never matched.
class PictureMatcher {
 public:
  explicit PictureMatcher(const std::map<int, std::shared_ptr<const PatternPicture>>& pictures);

  /// The borders of all pictures are at least as wide as 1 / this of the edge.
  int modulesPerEdge() const;

  /// `image`: CV_8UC1. `square`: its corners in pixels, counter-clockwise from any of them. Nothing
  /// if the square is too small, reaches beyond the image, or matches no picture.
  std::optional<PictureMatch> match(const cv::Mat& image,
                                    const Corners<Eigen::Vector2d>& square) const;

 private:
  struct Picture {
    int id;
    double border;
    double dimensions;
    /// CV_32F, shares of white, with some of the border around them.
    cv::Mat cells;
  };
  /// What a square shows within a border: the standard deviation in grey levels, and its cells
  /// without their mean and of length 1.
  struct Inside {
    double contrast = 0.0;
    std::vector<float> values;
  };
  /// The picture and turn that correlate best, and how well the next one does.
  struct Ranking {
    std::size_t picture = 0;
    std::size_t turn = 0;
    double best = -1.0;
    double second = 0.0;
    double dimensions = 0.0;
    double contrast = 0.0;

    void add(std::size_t number, std::size_t turned, double correlated, double independent);
  };

  /// By the width of the border.
  std::map<double, Inside> insidesOf(const cv::Mat& image,
                                     const Corners<Eigen::Vector2d>& square) const;
  /// `blur`: pixels, standard deviation.
  Ranking rankingOf(const std::map<double, Inside>& insides, const Corners<Eigen::Vector2d>& square,
                    double blur) const;
  static bool isClear(const Ranking& ranking);

  std::vector<Picture> pictures_;
};

}  // namespace omnitag
