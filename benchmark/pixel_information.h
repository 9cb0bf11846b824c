#pragma once

#include <vector>

#include "measurement/frame_equations.h"
#include "pattern_pixels.h"

namespace omnitag {

/// How the greys of a marker's pixels follow its white: grey = black + contrast * white.
struct Light {
  double black = 0.0;
  double contrast = 0.0;
  /// Of the greys, their noise taken off, with what this formula gives: 0 to 1 or a little more;
  /// low where something hides a part of the marker.
  double correlation = 0.0;
};

/// Least squares; at least three pixels. `noise`: standard deviation in grey levels.
Light fitLight(const std::vector<PatternPixel>& pixels, double noise);

/// Mean square, over the pixels at edges, by which the renderer's share of white is off.
double samplingVariance(const std::vector<PatternPixel>& pixels);

/// What a marker's pixels tell about a frame's unknowns, independent normal noise being on each:
/// the inverse of the information is the Cramer-Rao bound. Black, contrast, and the contrast's
/// slopes across the marker are unknown, too. `noise`: standard deviation in grey levels;
/// `edge_variance`: what pixels at edges have besides, of their share of white.
FrameEquations pixelInformation(const std::vector<PatternPixel>& pixels, double contrast,
                                double noise, double edge_variance);

}  // namespace omnitag
