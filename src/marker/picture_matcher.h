#pragma once

#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/pattern_picture.h"

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

/// Tells which of some pictures is within the border of a square, by normalized correlation in all
/// four turns, whatever the light is and however blurred the image.
///
/// A match must be unlikely to come about by chance (correlationThreshold(), with the dimensions
/// that the blur leaves of the picture's own), and likelier than any other picture and turn: for n
/// independent parts with noise of unknown size, the likelihoods of two pictures that correlate
/// with the square by a and b have the ratio ((1 - b^2) / (1 - a^2))^(n / 2). A picture that looks
/// alike when it is turned is thus never told.
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
    /// CV_32F, shares of white, within some of the border.
    cv::Mat cells;
  };

  std::vector<Picture> pictures_;
};

}  // namespace omnitag
