// How often a single image is enough to find the robot, and whether a pose found so is ever wrong:
// for 1, 2, 3 and 5 visible markers, chosen at random, all others painted over.
//
//   search_study [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by default

#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "masking.h"
#include "omnitag/localization/localizer.h"
#include "program.h"
#include "recorded_sequence.h"
#include "statistics.h"

namespace omnitag {
namespace {

constexpr int kTrialsPerFrame = 3;

struct Tally {
  int frames = 0;
  int solved = 0;
  int wrong = 0;
  std::vector<double> errors;
  std::vector<double> milliseconds;
};

/// Wrong is what no robot should act on: half a metre or ten degrees off, or so far outside of the
/// covariance that it would happen once in a million poses.
bool isWrong(const PoseEstimate& estimate, const Pose& truth) {
  constexpr double kChiSquareLimit = 30.66;
  const Eigen::Vector3d error = difference(estimate.pose, truth).head<3>();
  return error.head<2>().norm() > 0.5 || std::abs(error.z()) > radians(10.0) ||
         error.dot(floorCovariance(estimate).inverse() * error) > kChiSquareLimit;
}

Tally study(const RecordedSequence& sequence, std::size_t visible) {
  std::mt19937 generator(1);
  Tally tally;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const FrameResult seen = lookAtTruth(sequence, i);
    std::vector<std::size_t> readable = readableMarkers(seen);
    if (readable.size() < visible) continue;
    for (int trial = 0; trial < kTrialsPerFrame; ++trial) {
      std::shuffle(readable.begin(), readable.end(), generator);
      const std::vector<std::size_t> chosen(
          readable.begin(), readable.begin() + static_cast<std::ptrdiff_t>(visible));
      Frame masked = sequence.frames[i];
      masked.image = withOnly(chosen, seen, masked.image);
      Localizer localizer(sequence.camera, sequence.map, {});
      const FrameResult result = localizer.process(masked);
      ++tally.frames;
      tally.milliseconds.push_back(1e3 * result.timings.total);
      if (!result.map_from_base) continue;
      ++tally.solved;
      const Eigen::Vector3d error =
          difference(result.map_from_base->pose, sequence.truth[i]).head<3>();
      tally.errors.push_back(error.head<2>().norm());
      if (isWrong(*result.map_from_base, sequence.truth[i])) {
        ++tally.wrong;
        const Eigen::Vector3d deviations =
            floorCovariance(*result.map_from_base).diagonal().cwiseSqrt();
        std::printf(
            "wrong: frame %zu, %d used, off by %.3f m %.3f m %.2f deg, said %.3f %.3f %.2f\n", i,
            result.acceptedMarkers(), error.x(), error.y(), degrees(error.z()), deviations.x(),
            deviations.y(), degrees(deviations.z()));
      }
    }
  }
  return tally;
}

void run(const RecordedSequence& sequence) {
  std::printf("visible  images  solved   wrong  median error     99th  ms median   99th\n");
  for (const std::size_t visible : {1U, 2U, 3U, 5U}) {
    const Tally tally = study(sequence, visible);
    std::printf("%7zu %7d %6.1f %% %6d %10.4f m %8.4f m %9.1f %6.1f\n", visible, tally.frames,
                100.0 * tally.solved / std::max(tally.frames, 1), tally.wrong,
                quantile(tally.errors, 0.5), quantile(tally.errors, 0.99),
                quantile(tally.milliseconds, 0.5), quantile(tally.milliseconds, 0.99));
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("search_study", [&] {
    omnitag::run(omnitag::sequenceFrom(argc, argv));
    return 0;
  });
}
