// This package beside what could be done without it, on the same images in the same process:
//
//   tracking           this package, from a prediction that is off by 2 cm and 0.5 degrees
//                      (standard deviations)
//   searching          this package without a prediction
//   cylinder           the panorama unwrapped by cv::remap onto a cylinder, AprilTag all over it,
//                      with the settings of this package's detector
//   cylinder, default  the same with the settings that the library has by default
//   cylinder, most     the same with those settings that find most
//   cylinder, fastest  with those that take least time and find no fewer than this package's
//   flipped            AprilTag on the panorama itself, turned left to right
//
// Settings are looked for one at a time, on these very images, among those that alternatives()
// lists. Where the library refines edges, this package's detector places corners anew, for all
// methods alike. Times are processor time on one core. A marker counts as visible where it faces
// the camera by 60 degrees or less and the panorama shows all of it, and as found where its id is
// read within half an edge of where it really is. `wrong` are ids that were read where no such
// marker hangs; `off` is how far from their place the centres of the markers were found (RMS,
// pixels of the panorama).
//
//   comparison_benchmark DIRECTORY [SIZE_MARKERS]...   bags of scripts/render_comparison

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "cylinder_settings.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "prediction.h"
#include "processor_time.h"
#include "program.h"
#include "recorded_sequence.h"
#include "statistics.h"
#include "visible_markers.h"

namespace omnitag {
namespace {

const std::string kPackage = PACKAGE_DIR;
const double kMaxIncidence = radians(60.0);
constexpr double kFrameInterval = 1.0 / 30.0;  // s

/// What finds markers in the frame of an index.
using Method = std::function<std::vector<FoundMarker>(std::size_t)>;

struct NamedMethod {
  std::string name;
  Method find;
};

/// This package with its pose set or forgotten before each frame.
class Localization {
 public:
  explicit Localization(const RecordedSequence& sequence)
      : sequence_(sequence), localizer_(sequence.camera, sequence.map, {}) {}

  std::vector<FoundMarker> track(std::size_t frame) {
    localizer_.setPose(goodPrediction(sequence_.truth[frame], &generator_));
    return process(frame);
  }

  std::vector<FoundMarker> search(std::size_t frame) {
    localizer_.forgetPose();
    return process(frame);
  }

 private:
  std::vector<FoundMarker> process(std::size_t frame) {
    Frame next = sequence_.frames[frame];
    next.stamp = stamp_ += kFrameInterval;
    return foundMarkers(localizer_.process(next));
  }

  const RecordedSequence& sequence_;
  Localizer localizer_;
  std::mt19937 generator_{1};
  double stamp_ = 0.0;
};

/// AprilTag on the flipped panorama.
class FlippedReader {
 public:
  explicit FlippedReader(const RecordedSequence& sequence)
      : sequence_(sequence), detector_({}, familiesOf(sequence.map)) {}

  std::vector<FoundMarker> read(std::size_t frame) const {
    cv::Mat flipped;
    cv::flip(sequence_.frames[frame].image, flipped, 1);
    std::vector<FoundMarker> found;
    for (const TagDetection& tag : detector_.detect(flipped)) {
      found.push_back({tag.family, tag.id, {flipped.cols - 1.0 - tag.center.x(), tag.center.y()}});
    }
    return found;
  }

 private:
  const RecordedSequence& sequence_;
  TagDetector detector_;
};

void compare(const std::string& name, const RecordedSequence& sequence,
             const std::vector<NamedMethod>& methods) {
  constexpr std::size_t kLeastSamples = 100;
  const std::size_t frames = sequence.frames.size();
  std::vector<std::vector<PredictedMarker>> visible;
  std::vector<std::vector<PredictedMarker>> all;
  for (std::size_t i = 0; i < frames; ++i) {
    visible.push_back(visibleMarkers(sequence, i, kMaxIncidence));
    all.push_back(visibleMarkers(sequence, i, radians(89.0)));
  }
  struct Tally {
    std::vector<double> milliseconds;
    double found = 0.0;
    double wrong = 0.0;
    double squares = 0.0;
  };
  std::vector<Tally> tallies(methods.size());
  double seen = 0.0;
  const std::size_t rounds = (kLeastSamples + frames - 1) / std::max<std::size_t>(frames, 1);
  for (std::size_t sample = 0; sample < rounds * frames; ++sample) {
    const std::size_t frame = sample % frames;
    seen += static_cast<double>(visible[frame].size());
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double start = processorTime();
      const std::vector<FoundMarker> found = methods[m].find(frame);
      tallies[m].milliseconds.push_back(1e3 * (processorTime() - start));
      for (const auto& offset : offsetsOfFound(visible[frame], sequence.map, found)) {
        if (!offset) continue;
        tallies[m].found += 1.0;
        tallies[m].squares += *offset * *offset;
      }
      tallies[m].wrong += countStrangers(all[frame], sequence.map, found);
    }
  }
  const auto samples = static_cast<double>(rounds * frames);
  const double tracking = quantile(tallies.front().milliseconds, 0.5);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const double median = quantile(tallies[m].milliseconds, 0.5);
    std::printf("%-8s %-18s %8.2f %8.2f %8.2f %6.2f of %5.2f %7.2f %8.3f\n", name.c_str(),
                methods[m].name.c_str(), median, quantile(tallies[m].milliseconds, 0.99),
                median / tracking, tallies[m].found / samples, seen / samples,
                tallies[m].wrong / samples,
                std::sqrt(tallies[m].squares / std::max(tallies[m].found, 1.0)));
  }
}

void study(const std::string& directory, const std::string& name) {
  const std::size_t separator = name.find('_');
  if (separator == std::string::npos) throw InputError("expected SIZE_MARKERS, found " + name);
  const std::string size = name.substr(0, separator);
  const RecordedSequence sequence =
      loadSequence(directory + "/" + name + ".bag",
                   kPackage + "/config/cameras/paper" + (size == "500" ? "" : "_" + size) + ".yaml",
                   kPackage + "/maps/comparison_" + name.substr(separator + 1) + ".yaml");

  Localization localization(sequence);
  const FlippedReader flipped(sequence);
  const CylinderTrial trial(sequence, kMaxIncidence);
  const CylinderSettings same;
  const CylinderSettings most = settingsThatFindMost(trial);
  const CylinderSettings fastest = fastestSettings(trial);
  CylinderSettings usual;
  usual.detector.quad_decimate = 2.0;
  usual.detector.min_white_black_diff = 5;
  usual.detector.min_decision_margin = 0.0;
  const CylinderReader with_same(sequence, same);
  const CylinderReader with_default(sequence, usual);
  const CylinderReader with_most(sequence, most);
  const CylinderReader with_fastest(sequence, fastest);
  compare(name, sequence,
          {{"tracking", [&](std::size_t frame) { return localization.track(frame); }},
           {"searching", [&](std::size_t frame) { return localization.search(frame); }},
           {"cylinder", [&](std::size_t frame) { return with_same.read(frame); }},
           {"cylinder, default", [&](std::size_t frame) { return with_default.read(frame); }},
           {"cylinder, most", [&](std::size_t frame) { return with_most.read(frame); }},
           {"cylinder, fastest", [&](std::size_t frame) { return with_fastest.read(frame); }},
           {"flipped", [&](std::size_t frame) { return flipped.read(frame); }}});
  std::printf("  cylinder %d x %d; most: %s; fastest: %s\n", with_same.size().width,
              with_same.size().height, describe(most).c_str(), describe(fastest).c_str());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  if (argc < 2) throw InputError("expected DIRECTORY [SIZE_MARKERS]...");
  const std::string directory = argv[1];
  std::vector<std::string> names(argv + 2, argv + argc);
  if (names.empty()) {
    for (const char* size : {"500", "1000", "1500", "2000"}) {
      for (const char* markers : {"2", "8", "20", "8_small"}) {
        std::string name = size;
        name.append("_").append(markers);
        if (std::ifstream(directory + "/" + name + ".bag")) names.push_back(name);
      }
    }
  }
  cv::setNumThreads(1);
  std::printf("%-8s %-18s %8s %8s %8s %15s %7s %8s\n", "images", "method", "ms", "99th", "times",
              "found of seen", "wrong", "off px");
  for (const std::string& name : names) study(directory, name);
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("comparison_benchmark", [&] { return omnitag::run(argc, argv); });
}
