// How exactly a robot that no floor holds is followed, in all six numbers, and how often it is
// found from nothing in a single image, right or wrong: by all markers, and by 3, 2 and 1 of them.
//
//   free_study BAG CAMERA MAP [STEP]     a bag of render_sequence, as `hand` of
//   scripts/render_real;
//                                        every STEP-th image is searched, 10 by default

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "masking.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "program.h"
#include "recorded_sequence.h"
#include "statistics.h"

namespace omnitag {
namespace {

struct Errors {
  std::vector<double> translations;  // m
  std::vector<double> rotations;     // rad
  std::vector<double> nees;          // of six, 6 where the covariance is true
  std::vector<double> milliseconds;

  void add(const FrameResult& result, const Pose& truth) {
    const PoseEstimate& estimate = *result.map_from_base;
    const PoseVector error = difference(estimate.pose, truth);
    translations.push_back(translationPart(error).norm());
    rotations.push_back(rotationPart(error).norm());
    nees.push_back(error.dot(estimate.covariance.ldlt().solve(error)));
  }
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double rms(std::vector<double> values) {
  for (double& value : values) value *= value;
  return std::sqrt(mean(values));
}

void print(const char* name, const Errors& errors, std::size_t frames, int wrong) {
  std::printf(
      "%-10s %3zu of %3zu images, %d wrong; RMSE %.3f mm %.4f deg, largest %.3f mm %.4f deg; NEES "
      "%.2f; %.1f ms, 99th percentile %.1f\n",
      name, errors.nees.size(), frames, wrong, 1e3 * rms(errors.translations),
      degrees(rms(errors.rotations)), 1e3 * quantile(errors.translations, 1.0),
      degrees(quantile(errors.rotations, 1.0)), mean(errors.nees),
      quantile(errors.milliseconds, 0.5), quantile(errors.milliseconds, 0.99));
}

/// What no robot should act on: half a metre or ten degrees off, or so far outside of the
/// covariance that it would happen once in a million poses.
bool isWrong(const FrameResult& result, const Pose& truth) {
  constexpr double kChiSquareLimit = 38.26;  // with 6 degrees of freedom
  const PoseEstimate& estimate = *result.map_from_base;
  const PoseVector error = difference(estimate.pose, truth);
  return translationPart(error).norm() > 0.5 || rotationPart(error).norm() > radians(10.0) ||
         error.dot(estimate.covariance.ldlt().solve(error)) > kChiSquareLimit;
}

/// Searches every step-th image, all but so many of its markers, chosen at random, painted over; 0:
/// none.
void search(const RecordedSequence& sequence, std::size_t step, std::size_t visible,
            const LocalizerConfig& config) {
  std::mt19937 generator(1);
  Errors found;
  std::size_t searched = 0;
  int wrong = 0;
  for (std::size_t i = 0; i < sequence.frames.size(); i += step) {
    Frame frame = sequence.frames[i];
    if (visible > 0) {
      const FrameResult seen = lookAtTruth(sequence, i, config);
      std::vector<std::size_t> readable = readableMarkers(seen);
      if (readable.size() < visible) continue;
      std::shuffle(readable.begin(), readable.end(), generator);
      readable.resize(visible);
      frame.image = withOnly(readable, seen, frame.image);
    }
    Localizer localizer(sequence.camera, sequence.map, config);
    const FrameResult result = localizer.process(frame);
    ++searched;
    found.milliseconds.push_back(1e3 * result.timings.total);
    if (!result.map_from_base) continue;
    found.add(result, sequence.truth[i]);
    if (!isWrong(result, sequence.truth[i])) continue;
    ++wrong;
    std::printf("image %zu: wrong by %.3f m, %.2f degrees, NEES %.0f, %d markers\n", i,
                found.translations.back(), degrees(found.rotations.back()), found.nees.back(),
                result.acceptedMarkers());
  }
  const std::string name =
      visible > 0 ? "found by " + std::to_string(visible) : std::string("found");
  print(name.c_str(), found, searched, wrong);
}

void run(const RecordedSequence& sequence, std::size_t step) {
  LocalizerConfig config;
  config.motion.pose_model = PoseModel::kFree;
  Errors tracked;
  int wrong = 0;
  Localizer follower(sequence.camera, sequence.map, config);
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const FrameResult result = follower.process(sequence.frames[i]);
    tracked.milliseconds.push_back(1e3 * result.timings.total);
    if (!result.map_from_base) continue;
    tracked.add(result, sequence.truth[i]);
    if (isWrong(result, sequence.truth[i])) ++wrong;
  }
  print("followed", tracked, sequence.frames.size(), wrong);

  for (const std::size_t visible : {0U, 3U, 2U, 1U}) search(sequence, step, visible, config);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("free_study", [&] {
    constexpr int kStep = 4;
    const bool has_step = argc == kStep + 1;
    const int step = has_step ? std::stoi(argv[kStep]) : 10;
    if (step < 1) throw omnitag::InputError("STEP: expected a number >= 1");
    omnitag::run(omnitag::sequenceFrom(has_step ? kStep : argc, argv),
                 static_cast<std::size_t>(step));
    return 0;
  });
}
