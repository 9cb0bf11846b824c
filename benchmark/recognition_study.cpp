// Which markers tracking finds: the share of those that the camera sees, by the width of their
// modules along the tangent of the panorama, in its pixels and with the foreshortening, and by the
// angle at which they are seen. Each frame starts from a prediction that is off by 2 cm and 0.5
// degrees (standard deviations). No marker of the world may be hidden.
//
//   recognition_study [BAG CAMERA MAP]     a bag of render_sequence; the shipped one, of which a
//                                          partition hides some, by default

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "marker/tag_pattern.h"
#include "omnitag/localization/localizer.h"
#include "prediction.h"
#include "program.h"
#include "recorded_sequence.h"
#include "visible_markers.h"

namespace omnitag {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Pixels, upper ends of the bins of module widths.
constexpr std::array<double, 9> kWidths{1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, kInfinity};
/// Degrees, upper ends of the bins of incidences.
constexpr std::array<double, 3> kIncidences{30.0, 45.0, 60.0};

struct Share {
  int seen = 0;
  int found = 0;
};

template <std::size_t kCount>
std::size_t binOf(double value, const std::array<double, kCount>& upper_ends) {
  const auto* const bin = std::upper_bound(upper_ends.begin(), upper_ends.end() - 1, value);
  return static_cast<std::size_t>(bin - upper_ends.begin());
}

void print(const Share& share) {
  if (share.seen == 0) {
    std::printf("  %15s", "-");
  } else {
    std::printf("  %5.1f %% of %4d", 100.0 * share.found / share.seen, share.seen);
  }
}

void run(const RecordedSequence& sequence) {
  std::array<std::array<Share, kIncidences.size()>, kWidths.size()> shares{};
  Localizer localizer(sequence.camera, sequence.map, {});
  std::mt19937 generator(1);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const auto visible = visibleMarkers(sequence, i, radians(kIncidences.back()));
    localizer.setPose(goodPrediction(sequence.truth[i], &generator));
    const auto found = foundMarkers(localizer.process(sequence.frames[i]));
    const auto offsets = offsetsOfFound(visible, sequence.map, found);
    for (std::size_t m = 0; m < visible.size(); ++m) {
      Share& share = shares[binOf(tangentialWidth(visible[m], sequence), kWidths)]
                           [binOf(degrees(visible[m].incidence), kIncidences)];
      ++share.seen;
      share.found += offsets[m] ? 1 : 0;
    }
  }
  std::printf("%-14s %17s%17s%17s%17s\n", "pixels/module", "0 to 30 deg", "30 to 45 deg",
              "45 to 60 deg", "all");
  double from = 0.0;
  for (std::size_t w = 0; w < kWidths.size(); ++w) {
    if (w + 1 < kWidths.size()) {
      std::printf("%4.2f to %-5.2f ", from, kWidths[w]);
    } else {
      std::printf("%4.2f and more ", from);
    }
    from = kWidths[w];
    Share all;
    for (const Share& share : shares[w]) {
      print(share);
      all.seen += share.seen;
      all.found += share.found;
    }
    print(all);
    std::printf("\n");
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("recognition_study", [&] {
    omnitag::run(omnitag::sequenceFrom(argc, argv));
    return 0;
  });
}
