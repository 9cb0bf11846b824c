#pragma once

namespace omnitag {

/// How much the markers of an image disagree about its pose, given the errors of their pixels, the
/// map and the camera: chi-square and its degrees of freedom. Both are 0 if a single marker
/// determines the pose.
struct Disagreement {
  double chi_square = 0.0;
  double freedom = 0.0;
};

}  // namespace omnitag
