#include "planning/colour_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/quantile.h"

namespace omnitag {
namespace {

/// 1, 2 or 5 times a power of ten, from 0.1 micrometres on (index 0); in metres.
double roundNumber(int index) {
  constexpr std::array<double, 3> kFactors{1.0, 2.0, 5.0};
  const int decade = index / 3;
  return 1e-7 * kFactors.at(static_cast<std::size_t>(index % 3)) * std::pow(10.0, decade);
}

}  // namespace

ColourScale::ColourScale(const FloorPrediction& floor) {
  constexpr int kMost = 30;
  constexpr double kLow = 0.02;
  constexpr double kHigh = 0.98;
  std::vector<double> deviations;
  for (const PlacePrediction& place : floor.places) {
    if (place.position_deviation) deviations.push_back(*place.position_deviation);
  }
  if (deviations.empty()) deviations = {1e-3, 1e-2};
  int first = 0;
  while (first + 1 < kMost && roundNumber(first + 1) <= quantile(deviations, kLow)) ++first;
  int last = first + 1;
  while (last < kMost && roundNumber(last) < quantile(deviations, kHigh)) ++last;
  for (int i = first; i <= last; ++i) ticks_.push_back(roundNumber(i));
}

double ColourScale::shareOf(double deviation) const {
  const double share =
      std::log(deviation / ticks_.front()) / std::log(ticks_.back() / ticks_.front());
  return std::clamp(share, 0.0, 1.0);
}

cv::Vec3b ColourScale::colourAt(double share) {
  // ColorBrewer's RdYlBu, reversed (Harrower and Brewer 2003); R, G, B.
  constexpr std::array<std::array<double, 3>, 7> kColours{{{69, 117, 180},
                                                           {145, 191, 219},
                                                           {224, 243, 248},
                                                           {255, 255, 191},
                                                           {254, 224, 144},
                                                           {252, 141, 89},
                                                           {215, 48, 39}}};
  const double place = std::clamp(share, 0.0, 1.0) * (kColours.size() - 1.0);
  const auto below = std::min(static_cast<std::size_t>(place), kColours.size() - 2);
  const double above = place - static_cast<double>(below);
  cv::Vec3b colour;
  for (int i = 0; i < 3; ++i) {
    const auto channel = static_cast<std::size_t>(2 - i);
    const double value =
        (1.0 - above) * kColours.at(below).at(channel) + above * kColours.at(below + 1).at(channel);
    colour[i] = static_cast<std::uint8_t>(std::lround(value));
  }
  return colour;
}

}  // namespace omnitag
