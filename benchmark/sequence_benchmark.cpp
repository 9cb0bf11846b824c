// Time and markers along a whole drive, in which the localizer follows the robot from image to
// image, beside AprilTag on the unwrapped panorama, which knows nothing of the image before:
//
//   localizer             as localize_bag runs it, from the true pose on, without odometry
//   localizer, odometry   with that of the bag, where it has one
//   cylinder              AprilTag on the panorama unwrapped onto a cylinder, with the settings of
//                         this package's detector
//   cylinder, decimated   the same on an image of half as many pixels each way (quad_decimate 2)
//   cylinder, fastest     with the settings that take least time and find no fewer than `cylinder`,
//                         looked for on every n-th of these images, 60 at most
//
// Each image goes through all methods before the next one; all images go through three times, with
// localizers that start anew. Times are processor time on one core, of each image the least of the
// three. A marker is found where its id is read within half an edge of where it really is; what the
// localizer rejects is not found. A wrong pose is off by more than 2 cm and 5 standard deviations.
// The localizer's steps are its shares of the wall time, of the mean processor time.
//
// comparison_benchmark looks at images one by one, with a prediction that it sets before each. A
// drive needs a localizer that lives on, tells its poses and starts anew: as a mode there it would
// share no more than cylinder_settings.h and visible_markers.h, which both use.
//
//   sequence_benchmark [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by default

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cylinder_settings.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"
#include "processor_time.h"
#include "program.h"
#include "recorded_sequence.h"
#include "statistics.h"
#include "visible_markers.h"
#include "wrong_pose.h"

namespace omnitag {
namespace {

constexpr int kRounds = 3;

/// The localizer along a sequence, which must outlive it.
class Drive {
 public:
  /// What the poses of a round were like, and sums of the times of their steps.
  struct Outcome {
    int poses = 0;
    int wrong = 0;
    /// m^2, sum over the poses.
    double squared_distance = 0.0;
    /// s of wall time, sums over the frames.
    Timings steps;
  };

  Drive(const RecordedSequence& sequence, bool uses_odometry)
      : sequence_(sequence), uses_odometry_(uses_odometry) {}

  /// Goes back to the true pose of the first frame.
  void start() {
    localizer_ = std::make_unique<Localizer>(sequence_.camera, sequence_.map, LocalizerConfig());
    localizer_->setPose(sequence_.truth.front());
    outcome_ = {};
  }

  /// Goes on to a frame, the one after the last.
  std::vector<FoundMarker> follow(std::size_t index) {
    Frame frame = sequence_.frames[index];
    if (!uses_odometry_) {
      frame.odom_from_base.reset();
      frame.velocity.reset();
    }
    const FrameResult result = localizer_->process(frame);
    tally(result, sequence_.truth[index]);
    return foundMarkers(result);
  }

  /// Since the start.
  const Outcome& outcome() const { return outcome_; }

 private:
  void tally(const FrameResult& result, const Pose& truth) {
    Timings& sum = outcome_.steps;
    sum.predict += result.timings.predict;
    sum.recognize += result.timings.recognize;
    sum.warp += result.timings.warp;
    sum.decode += result.timings.decode;
    sum.solve += result.timings.solve;
    sum.total += result.timings.total;
    if (!result.map_from_base) return;
    const Pose& pose = result.map_from_base->pose;
    const Eigen::Vector2d offset(pose.x - truth.x, pose.y - truth.y);
    ++outcome_.poses;
    outcome_.wrong += isWrong(*result.map_from_base, offset) ? 1 : 0;
    outcome_.squared_distance += offset.squaredNorm();
  }

  const RecordedSequence& sequence_;
  bool uses_odometry_;
  std::unique_ptr<Localizer> localizer_;
  Outcome outcome_;
};

/// A way to find the markers of a frame, and what it did.
struct Method {
  Method(std::string its_name, std::function<std::vector<FoundMarker>(std::size_t)> how)
      : name(std::move(its_name)), find(std::move(how)) {}

  double meanTime() const {
    return std::accumulate(milliseconds.begin(), milliseconds.end(), 0.0) /
           static_cast<double>(milliseconds.size());
  }

  std::string name;
  std::function<std::vector<FoundMarker>(std::size_t)> find;
  /// Of each frame.
  std::vector<double> milliseconds;
  /// Of each frame, in the last round.
  std::vector<int> found;
};

void measure(const RecordedSequence& sequence, std::size_t frame, Method* method) {
  const double start = processorTime();
  const std::vector<FoundMarker> found = method->find(frame);
  double& least = method->milliseconds[frame];
  least = std::min(least, 1e3 * (processorTime() - start));
  const auto markers = visibleMarkers(sequence, frame, radians(89.0));
  method->found[frame] = countFound(markers, sequence.map, found);
}

void measureAll(const RecordedSequence& sequence, std::vector<Drive>* drives,
                std::vector<Method>* methods) {
  const std::size_t frames = sequence.frames.size();
  for (Method& method : *methods) {
    method.milliseconds.assign(frames, std::numeric_limits<double>::infinity());
    method.found.assign(frames, 0);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (Drive& drive : *drives) drive.start();
    for (std::size_t frame = 0; frame < frames; ++frame) {
      for (Method& method : *methods) measure(sequence, frame, &method);
    }
  }
}

/// At most so many of its frames, evenly spread.
RecordedSequence thinned(const RecordedSequence& sequence, std::size_t most) {
  RecordedSequence some = sequence;
  some.frames.clear();
  some.truth.clear();
  const std::size_t step = (sequence.frames.size() + most - 1) / most;
  for (std::size_t i = 0; i < sequence.frames.size(); i += step) {
    some.frames.push_back(sequence.frames[i]);
    some.truth.push_back(sequence.truth[i]);
  }
  return some;
}

CylinderSettings fastestSettingsOf(const RecordedSequence& sequence) {
  constexpr std::size_t kFrames = 60;
  const double max_incidence = radians(60.0);
  const RecordedSequence some = thinned(sequence, kFrames);
  return fastestSettings(CylinderTrial(some, max_incidence));
}

void printTimes(const std::vector<Method>& methods) {
  std::printf("%-20s %8s %8s %8s %8s\n", "ms a frame", "mean", "median", "99th", "found");
  for (const Method& method : methods) {
    const int found = std::accumulate(method.found.begin(), method.found.end(), 0);
    std::printf("%-20s %8.2f %8.2f %8.2f %8.2f\n", method.name.c_str(), method.meanTime(),
                quantile(method.milliseconds, 0.5), quantile(method.milliseconds, 0.99),
                static_cast<double>(found) / static_cast<double>(method.found.size()));
  }
}

/// Of the drives, which are the first of the methods.
void printDrives(const std::vector<Drive>& drives, const std::vector<Method>& methods) {
  std::printf("\n%-20s %9s %9s %9s %9s %9s %6s %6s %8s\n", "mean ms", "predict", "recognize",
              "warp", "decode", "solve", "poses", "wrong", "RMSE mm");
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Drive::Outcome& outcome = drives[i].outcome();
    const Timings& steps = outcome.steps;
    const double scale = methods[i].meanTime() / steps.total;
    std::printf("%-20s %9.2f %9.2f %9.2f %9.2f %9.2f %6d %6d %8.2f\n", methods[i].name.c_str(),
                scale * steps.predict, scale * steps.recognize, scale * steps.warp,
                scale * steps.decode, scale * steps.solve, outcome.poses, outcome.wrong,
                1e3 * std::sqrt(outcome.squared_distance / std::max(outcome.poses, 1)));
  }
}

/// How many times the mean of a drive the other methods' means are.
void printRatios(std::size_t drives, const std::vector<Method>& methods) {
  std::printf("\n%-20s", "times the mean of");
  for (std::size_t m = drives; m < methods.size(); ++m)
    std::printf(" %20s", methods[m].name.c_str());
  std::printf("\n");
  for (std::size_t i = 0; i < drives; ++i) {
    std::printf("%-20s", methods[i].name.c_str());
    for (std::size_t m = drives; m < methods.size(); ++m) {
      std::printf(" %20.2f", methods[m].meanTime() / methods[i].meanTime());
    }
    std::printf("\n");
  }
}

int run(int argc, char** argv) {
  cv::setNumThreads(1);
  const RecordedSequence sequence = sequenceFrom(argc, argv, "odom");
  std::vector<Drive> drives;
  drives.emplace_back(sequence, false);
  if (sequence.frames.front().odom_from_base) drives.emplace_back(sequence, true);

  const CylinderSettings same;
  CylinderSettings decimated;
  decimated.detector.quad_decimate = 2.0;
  const CylinderSettings fastest = fastestSettingsOf(sequence);
  const CylinderReader with_same(sequence, same);
  const CylinderReader with_decimated(sequence, decimated);
  const CylinderReader with_fastest(sequence, fastest);

  std::vector<Method> methods;
  for (Drive& drive : drives) {
    methods.emplace_back(methods.empty() ? "localizer" : "localizer, odometry",
                         [&drive](std::size_t frame) { return drive.follow(frame); });
  }
  const auto add = [&methods](const char* name, const CylinderReader& reader) {
    methods.emplace_back(name, [&reader](std::size_t frame) { return reader.read(frame); });
  };
  add("cylinder", with_same);
  add("cylinder, decimated", with_decimated);
  add("cylinder, fastest", with_fastest);
  measureAll(sequence, &drives, &methods);

  const cv::Size size = sequence.frames.front().image.size();
  std::printf("%zu frames of %d x %d, %zu markers in the map; cylinder %d x %d, fastest: %s\n\n",
              sequence.frames.size(), size.width, size.height, sequence.map.markers.size(),
              with_same.size().width, with_same.size().height, describe(fastest).c_str());
  printTimes(methods);
  printDrives(drives, methods);
  printRatios(drives.size(), methods);
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("sequence_benchmark", [&] { return omnitag::run(argc, argv); });
}
