// Whether markers that hang elsewhere than the map says move the pose: of the five or more markers
// that each image shows, up to half are displaced in the map, by 0.1 to 1 m and, every second one,
// turned by up to 30 degrees; each its own way, or all the same way, as on a partition that was
// moved. From a prediction as good as odometry's, and searching.
//
//   outlier_study [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by default

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "masking.h"
#include "omnitag/localization/localizer.h"
#include "program.h"
#include "recorded_sequence.h"
#include "wrong_pose.h"

namespace omnitag {
namespace {

using Generator = std::mt19937;

enum class Start { kTracking, kSearching };
enum class Displacement { kEach, kTogether };

constexpr std::size_t kFewestMarkers = 5;

/// Sums over the images of one row.
struct Tally {
  int images = 0;
  int poses = 0;
  int wrong = 0;
  double squared_distance = 0.0;
  double squared_angle = 0.0;
  /// With the displaced ones painted over instead.
  int poses_without = 0;
  double squared_distance_without = 0.0;
  /// Markers.
  int displaced = 0;
  int displaced_read = 0;
  int displaced_accepted = 0;
  int good = 0;
  int good_accepted = 0;
};

/// A motion of a marker in the map, about its own centre.
struct Motion {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double turn = 0.0;
};

Motion randomMotion(bool is_turned, Generator* generator) {
  std::uniform_real_distribution<double> distance(0.1, 1.0);
  std::uniform_real_distribution<double> turn(-radians(30.0), radians(30.0));
  std::normal_distribution<double> normal(0.0, 1.0);
  Motion motion;
  const double x = normal(*generator);
  const double y = normal(*generator);
  const double z = normal(*generator);
  motion.shift = distance(*generator) * Eigen::Vector3d(x, y, z).normalized();
  const double drawn = turn(*generator);
  if (is_turned) motion.turn = drawn;
  return motion;
}

/// The map with these entries elsewhere. Together they move as one about the middle of them.
MarkerMap displacedMap(const MarkerMap& map, const std::vector<std::size_t>& entries,
                       Displacement kind, Generator* generator) {
  MarkerMap displaced = map;
  if (entries.empty()) return displaced;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::size_t entry : entries) middle += map.markers[entry].center();
  middle /= static_cast<double>(entries.size());
  std::bernoulli_distribution coin(0.5);
  const Motion common = randomMotion(coin(*generator), generator);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool is_alone = kind == Displacement::kEach;
    const Motion motion = is_alone ? randomMotion(i % 2 == 1, generator) : common;
    Eigen::Isometry3d& map_from_marker = displaced.markers[entries[i]].map_from_marker;
    const Eigen::Vector3d pivot = is_alone ? map.markers[entries[i]].center() : middle;
    const Eigen::Translation3d back(pivot + motion.shift);
    map_from_marker = back * Eigen::AngleAxisd(motion.turn, Eigen::Vector3d::UnitZ()) *
                      Eigen::Translation3d(-pivot) * map_from_marker;
  }
  return displaced;
}

FrameResult localize(const RecordedSequence& sequence, const MarkerMap& map, const Frame& frame,
                     const std::optional<PoseEstimate>& prediction) {
  Localizer localizer(sequence.camera, map, {});
  if (prediction) localizer.setPose(*prediction);
  return localizer.process(frame);
}

PoseEstimate predictionAbout(const Pose& truth, Generator* generator) {
  constexpr double kPositionDeviation = 0.02;
  const double heading_deviation = radians(1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  PoseEstimate prediction;
  prediction.pose.x = truth.x + kPositionDeviation * normal(*generator);
  prediction.pose.y = truth.y + kPositionDeviation * normal(*generator);
  prediction.pose.yaw = truth.yaw + heading_deviation * normal(*generator);
  const Eigen::Vector3d deviations(kPositionDeviation, kPositionDeviation, heading_deviation);
  prediction = floorEstimate(prediction.pose, deviations.cwiseAbs2().asDiagonal());
  return prediction;
}

/// The entry that a detection was taken for or, where it was taken for none, the only one that has
/// its id.
std::optional<std::size_t> entryOf(const MarkerDetection& detection, const MarkerMap& map) {
  if (detection.map_entry) return detection.map_entry;
  const std::vector<std::size_t> entries = entriesOf(map, detection.family, detection.id);
  return entries.size() == 1 ? std::optional(entries.front()) : std::nullopt;
}

void countMarkers(const FrameResult& result, const MarkerMap& map,
                  const std::set<std::size_t>& displaced, const std::set<std::size_t>& good,
                  Tally* tally) {
  tally->displaced += static_cast<int>(displaced.size());
  tally->good += static_cast<int>(good.size());
  std::set<std::size_t> read;
  std::set<std::size_t> accepted;
  for (const MarkerDetection& detection : result.detections) {
    const std::optional<std::size_t> entry = entryOf(detection, map);
    if (!entry) continue;
    read.insert(*entry);
    if (detection.accepted) accepted.insert(*entry);
  }
  for (const std::size_t entry : displaced) {
    tally->displaced_read += static_cast<int>(read.count(entry));
    tally->displaced_accepted += static_cast<int>(accepted.count(entry));
  }
  for (const std::size_t entry : good) {
    tally->good_accepted += static_cast<int>(accepted.count(entry));
  }
}

void countPose(const FrameResult& result, const Pose& truth, Tally* tally) {
  if (!result.map_from_base) return;
  const Eigen::Vector3d error = difference(result.map_from_base->pose, truth).head<3>();
  ++tally->poses;
  tally->squared_distance += error.head<2>().squaredNorm();
  tally->squared_angle += error.z() * error.z();
  if (isWrong(*result.map_from_base, error.head<2>())) ++tally->wrong;
}

/// 0 for none, 1 for up to a tenth, 2 for up to two tenths, ...
std::size_t rowOf(std::size_t displaced, std::size_t all) {
  return (10 * displaced + all - 1) / all;
}

constexpr std::size_t kRows = 6;

/// One image with so many of its markers displaced.
void localizeWithDisplaced(const RecordedSequence& sequence, std::size_t index,
                           const FrameResult& seen, const std::vector<std::size_t>& shuffled,
                           std::size_t count, Start start, Displacement kind, Generator* generator,
                           Tally* tally) {
  std::vector<std::size_t> moved;
  std::set<std::size_t> good;
  for (std::size_t i = 0; i < shuffled.size(); ++i) {
    const std::size_t entry = seen.predicted[shuffled[i]].map_entry;
    if (i < count) moved.push_back(entry);
    if (i >= count) good.insert(entry);
  }
  const MarkerMap map = displacedMap(sequence.map, moved, kind, generator);
  std::optional<PoseEstimate> prediction;
  if (start == Start::kTracking) prediction = predictionAbout(sequence.truth[index], generator);

  const FrameResult result = localize(sequence, map, sequence.frames[index], prediction);
  ++tally->images;
  countPose(result, sequence.truth[index], tally);
  countMarkers(result, map, {moved.begin(), moved.end()}, good, tally);

  Frame without = sequence.frames[index];
  without.image = withOnly({shuffled.begin() + static_cast<std::ptrdiff_t>(count), shuffled.end()},
                           seen, without.image);
  Tally baseline;
  countPose(localize(sequence, sequence.map, without, prediction), sequence.truth[index],
            &baseline);
  tally->poses_without += baseline.poses;
  tally->squared_distance_without += baseline.squared_distance;
}

double percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

double rootOfMean(double sum, int count) { return std::sqrt(sum / std::max(count, 1)); }

void show(std::size_t row, const Tally& tally) {
  std::printf(
      "%5zu %% %7d %6d %6d %9.2f mm %9.2f mm %9.4f deg %7d %6.1f %% %9.1f %% %9.1f %%\n", 10 * row,
      tally.images, tally.poses, tally.wrong, 1e3 * rootOfMean(tally.squared_distance, tally.poses),
      1e3 * rootOfMean(tally.squared_distance_without, tally.poses_without),
      degrees(rootOfMean(tally.squared_angle, tally.poses)), tally.displaced,
      percent(tally.displaced_read, tally.displaced),
      percent(tally.displaced_accepted, tally.displaced), percent(tally.good_accepted, tally.good));
}

void study(const RecordedSequence& sequence, const std::vector<FrameResult>& at_truth, Start start,
           Displacement kind) {
  Generator generator(1);
  std::array<Tally, kRows> tallies;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    std::vector<std::size_t> readable = readableMarkers(at_truth[i]);
    if (readable.size() < kFewestMarkers) continue;
    for (std::size_t count = 0; 2 * count <= readable.size(); ++count) {
      std::shuffle(readable.begin(), readable.end(), generator);
      localizeWithDisplaced(sequence, i, at_truth[i], readable, count, start, kind, &generator,
                            &tallies.at(rowOf(count, readable.size())));
    }
  }
  std::printf("\n%s, %s\n", start == Start::kTracking ? "tracking" : "searching",
              kind == Displacement::kEach ? "each displaced its own way" : "all displaced as one");
  std::printf(
      "  up to  images  poses  wrong      RMSE    without them       heading"
      "   displaced    read   accepted  good accepted\n");
  for (std::size_t row = 0; row < kRows; ++row) show(row, tallies.at(row));
}

void run(const RecordedSequence& sequence) {
  std::vector<FrameResult> at_truth;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    at_truth.push_back(lookAtTruth(sequence, i));
  }
  for (const Displacement kind : {Displacement::kEach, Displacement::kTogether}) {
    for (const Start start : {Start::kTracking, Start::kSearching}) {
      study(sequence, at_truth, start, kind);
    }
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("outlier_study", [&] {
    omnitag::run(omnitag::sequenceFrom(argc, argv));
    return 0;
  });
}
