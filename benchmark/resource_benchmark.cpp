// What the localizer takes besides the time of a frame: start-up, memory, the time of a frame with
// a map of 10,000 markers beside that of the map alone, and with two threads beside that with one.
// Times are processor time, those of threads wall time.
//
//   resource_benchmark [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by default

#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "marker/tag_family.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"
#include "process_memory.h"
#include "processor_time.h"
#include "program.h"
#include "recorded_sequence.h"
#include "statistics.h"

namespace omnitag {
namespace {

constexpr double kFrameInterval = 1.0 / 30.0;  // s

/// The map and, 60 m away and farther, halls of 16 markers each: `count` markers in all.
MarkerMap extended(const MarkerMap& map, std::size_t count) {
  constexpr std::size_t kPerHall = 16;
  constexpr std::size_t kHallsPerRow = 25;
  constexpr double kHall = 10.0;
  constexpr double kAway = 60.0;
  const Marker& model = map.markers.front();
  const int ids = tagCount(model.family);
  std::mt19937 random(1);
  MarkerMap all = map;
  for (std::size_t i = 0; all.markers.size() < count; ++i) {
    const std::size_t hall = i / kPerHall;
    const std::size_t hall_row = hall / kHallsPerRow;
    const std::size_t wall_of_hall = i % kPerHall / 4;
    const double wall = 0.5 * kPi * static_cast<double>(wall_of_hall);
    const double along = 2.0 * static_cast<double>(i % 4) - 3.0;
    const double away = 0.45 * kHall;
    const Eigen::Vector3d center(
        kAway + kHall * static_cast<double>(hall % kHallsPerRow) + away * std::cos(wall) -
            along * std::sin(wall),
        kHall * static_cast<double>(hall_row) + away * std::sin(wall) + along * std::cos(wall),
        1.3);
    Marker marker = model;
    marker.name.clear();
    marker.id = static_cast<int>(random() % static_cast<unsigned>(ids));
    marker.map_from_marker = Eigen::Translation3d(center) * uprightOrientation(wall + kPi, 0.0);
    all.markers.push_back(marker);
  }
  return all;
}

struct FrameTimes {
  double tracking;
  double searching;
};

double wallTime() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Medians, ms, of the time that `clock` tells.
FrameTimes frameTimes(const RecordedSequence& sequence, const MarkerMap& map,
                      const LocalizerConfig& config, double (*clock)()) {
  constexpr std::size_t kLeastSamples = 100;
  Localizer localizer(sequence.camera, map, config);
  std::vector<double> tracking;
  std::vector<double> searching;
  double stamp = 0.0;
  const auto measured = [&](Frame frame) {
    frame.stamp = stamp += kFrameInterval;
    const double start = clock();
    localizer.process(frame);
    return 1e3 * (clock() - start);
  };
  while (tracking.size() < kLeastSamples) {
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      localizer.setPose(floorEstimate(sequence.truth[i], 1e-4 * Eigen::Matrix3d::Identity()));
      tracking.push_back(measured(sequence.frames[i]));
      localizer.forgetPose();
      searching.push_back(measured(sequence.frames[i]));
    }
  }
  return {quantile(tracking, 0.5), quantile(searching, 0.5)};
}

void printStartUp(const std::string& camera_file, const std::string& map_file,
                  const RecordedSequence& sequence) {
  constexpr int kRounds = 11;
  std::vector<double> load;
  std::vector<double> first_frame;
  for (int i = 0; i < kRounds; ++i) {
    double start = processorTime();
    Localizer localizer(loadCamera(camera_file), loadMarkerMap(map_file), {});
    load.push_back(processorTime() - start);
    localizer.setPose(sequence.truth.front());
    start = processorTime();
    localizer.process(sequence.frames.front());
    first_frame.push_back(processorTime() - start);
  }
  std::printf(
      "start-up: %.3f s to load the files and build the tables, %.3f s for the first frame\n",
      quantile(load, 0.5), quantile(first_frame, 0.5));
}

/// Memory of tracking and searching in the first image. Before that, the process holds little more
/// than that image and the libraries.
void printMemory(RecordedSequence sequence, const std::string& camera_file,
                 const std::string& map_file) {
  Frame frame = sequence.frames.front();
  const Pose truth = sequence.truth.front();
  sequence = {};
  malloc_trim(0);
  const double before = processMemory("VmRSS");
  forgetPeakMemory();
  Localizer localizer(loadCamera(camera_file), loadMarkerMap(map_file), {});
  for (int i = 0; i < 20; ++i) {
    frame.stamp += kFrameInterval;
    if (i % 2 == 0) {
      localizer.setPose(truth);
    } else {
      localizer.forgetPose();
    }
    localizer.process(frame);
  }
  std::printf("memory: %.1f MB at most, of which %.1f MB before the localizer was made\n",
              processMemory("VmHWM"), before);
}

int run(int argc, char** argv) {
  constexpr std::size_t kManyMarkers = 10000;
  const std::string package = PACKAGE_DIR;
  RecordedSequence sequence = sequenceFrom(argc, argv);
  const std::string camera_file = argc > 1 ? argv[2] : package + "/config/cameras/paper.yaml";
  const std::string map_file = argc > 1 ? argv[3] : package + "/maps/paper.yaml";
  cv::setNumThreads(1);
  printMemory(std::move(sequence), camera_file, map_file);
  sequence = sequenceFrom(argc, argv);
  printStartUp(camera_file, map_file, sequence);
  const FrameTimes few = frameTimes(sequence, sequence.map, {}, processorTime);
  const FrameTimes many =
      frameTimes(sequence, extended(sequence.map, kManyMarkers), {}, processorTime);
  std::printf("map of %zu markers: %.2f ms tracking, %.2f ms searching\n",
              sequence.map.markers.size(), few.tracking, few.searching);
  std::printf("map of %zu markers: %.2f ms tracking (%+.1f %%), %.2f ms searching (%+.1f %%)\n",
              kManyMarkers, many.tracking, 100.0 * (many.tracking / few.tracking - 1.0),
              many.searching, 100.0 * (many.searching / few.searching - 1.0));
  for (const int threads : {1, 2}) {
    LocalizerConfig config;
    config.threads = threads;
    const FrameTimes times = frameTimes(sequence, sequence.map, config, wallTime);
    // As where no glance finds enough.
    config.look_around.glance = false;
    const double around = frameTimes(sequence, sequence.map, config, wallTime).searching;
    std::printf(
        "threads: %d: %.2f ms tracking, %.2f ms searching, %.2f ms looking all around (wall "
        "time)\n",
        threads, times.tracking, times.searching, around);
  }
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("resource_benchmark", [&] { return omnitag::run(argc, argv); });
}
