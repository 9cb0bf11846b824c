// Whether what plan_markers predicts is how the localizer errs: in frames of a recording with its
// truth, by place. Each frame is processed by itself, from a prediction that is off by 2 cm and 0.5
// degrees (standard deviations), four times, on its own, and under disturbances that are drawn
// anew each time: the map off by what it says, and also the robot leaning and the camera off.
// Frames are sorted by the predicted deviation of their place; `stated` is what the localizer says
// itself.
//
//   planning_study GRID BAG CAMERA MAP [--only ID,ID,...] [--places]
//
//   --only: the localizer knows no other markers; --places: each frame, with its place

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "disturbances.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "planning/expected_information.h"
#include "planning/pose_prediction.h"
#include "prediction.h"
#include "program.h"
#include "recorded_sequence.h"

namespace omnitag {
namespace {

constexpr double kPositionDeviation = 0.02;
constexpr double kHeadingDeviation = radians(0.5);

struct Outcome {
  Pose truth;
  int predicted_markers = 0;
  int used_markers = 0;
  bool has_pose = false;
  /// m, of x and y together, and rad.
  double predicted = 0.0;
  double predicted_heading = 0.0;
  double stated = 0.0;
  double error = 0.0;
  double heading_error = 0.0;
};

Outcome outcomeOf(const DisturbedFrame& drawn, const OccupancyGrid& grid, std::mt19937* generator) {
  const MountedCamera camera(drawn.camera, drawn.frame.base_from_camera);
  PlanningConfig config;
  config.place_deviation = kPositionDeviation;
  config.heading_deviation = kHeadingDeviation;
  const PlanningScene scene{grid, camera, config};
  const Pose place = drawn.truth.onFloor();
  const PosePrediction prediction = PosePredictor(scene, drawn.map).predict(place);
  const PoseEstimate expected = expectedEstimate(scene, prediction.equations, place);
  Outcome outcome;
  outcome.truth = drawn.truth;
  outcome.predicted_markers = static_cast<int>(prediction.markers.size());
  outcome.predicted = positionDeviation(expected);
  outcome.predicted_heading = std::sqrt(expected.covariance(2, 2));
  Localizer localizer(drawn.camera, drawn.map, {});
  localizer.setPose(drawnPrediction(drawn.truth, kPositionDeviation, kHeadingDeviation, generator));
  const FrameResult result = localizer.process(drawn.frame);
  outcome.used_markers = result.acceptedMarkers();
  outcome.has_pose = result.map_from_base && outcome.used_markers > 0;
  if (!outcome.has_pose) return outcome;
  const PoseVector error = difference(result.map_from_base->pose, drawn.truth);
  outcome.stated = positionDeviation(*result.map_from_base);
  outcome.error = error.head<2>().norm();
  outcome.heading_error = std::abs(error(2));
  return outcome;
}

double rootMeanSquare(const std::vector<Outcome>& outcomes, double Outcome::*value) {
  double squares = 0.0;
  for (const Outcome& outcome : outcomes) squares += outcome.*value * outcome.*value;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(outcomes.size(), 1)));
}

double median(std::vector<Outcome> outcomes, double Outcome::*value) {
  if (outcomes.empty()) return 0.0;
  const auto middle = outcomes.begin() + static_cast<std::ptrdiff_t>(outcomes.size() / 2);
  std::nth_element(outcomes.begin(), middle, outcomes.end(),
                   [value](const Outcome& a, const Outcome& b) { return a.*value < b.*value; });
  return *middle.*value;
}

double meanOf(const std::vector<Outcome>& outcomes, int Outcome::*value) {
  double sum = 0.0;
  for (const Outcome& outcome : outcomes) sum += outcome.*value;
  return sum / static_cast<double>(std::max<std::size_t>(outcomes.size(), 1));
}

void printRow(const std::string& name, const std::vector<Outcome>& outcomes) {
  std::printf("%-24s %6zu | %9.2f %5.2f | %9.3f %9.3f %9.3f | %9.3f %9.3f | %9.4f %9.4f\n",
              name.c_str(), outcomes.size(), meanOf(outcomes, &Outcome::predicted_markers),
              meanOf(outcomes, &Outcome::used_markers),
              1e3 * rootMeanSquare(outcomes, &Outcome::predicted),
              1e3 * rootMeanSquare(outcomes, &Outcome::stated),
              1e3 * rootMeanSquare(outcomes, &Outcome::error),
              1e3 * median(outcomes, &Outcome::predicted), 1e3 * median(outcomes, &Outcome::error),
              degrees(rootMeanSquare(outcomes, &Outcome::predicted_heading)),
              degrees(rootMeanSquare(outcomes, &Outcome::heading_error)));
}

void printPlaces(const std::vector<Outcome>& outcomes) {
  for (const Outcome& outcome : outcomes) {
    std::printf("%8.3f %8.3f %8.3f  predicted: %2d markers, %8.3f mm; ", outcome.truth.x,
                outcome.truth.y, outcome.truth.yaw, outcome.predicted_markers,
                1e3 * outcome.predicted);
    if (outcome.has_pose) {
      std::printf("true: %2d markers, off by %8.3f mm, stated %8.3f mm\n", outcome.used_markers,
                  1e3 * outcome.error, 1e3 * outcome.stated);
    } else {
      std::printf("no pose\n");
    }
  }
}

void study(const Disturbance& disturbance, const RecordedSequence& sequence,
           const std::string& camera_file, const OccupancyGrid& grid, bool prints_places) {
  std::mt19937 generator(5);
  std::vector<Outcome> outcomes;
  int without = 0;
  int expected = 0;
  int surprises = 0;
  constexpr std::size_t kDraws = 4;
  for (std::size_t k = 0; k < kDraws * sequence.frames.size(); ++k) {
    const DisturbedFrame drawn =
        disturbed(disturbance, sequence, camera_file, k % sequence.frames.size(), &generator);
    // The robot of the recording may stand where the grid is not free.
    if (grid.at(Eigen::Vector2d(drawn.truth.x, drawn.truth.y)) != Cell::kFree) continue;
    const Outcome outcome = outcomeOf(drawn, grid, &generator);
    if (prints_places) printPlaces({outcome});
    if (outcome.has_pose && outcome.predicted_markers > 0) {
      outcomes.push_back(outcome);
    } else if (outcome.has_pose) {
      ++surprises;
    } else {
      ++(outcome.predicted_markers > 0 ? without : expected);
    }
  }
  std::sort(outcomes.begin(), outcomes.end(),
            [](const Outcome& a, const Outcome& b) { return a.predicted < b.predicted; });
  constexpr std::size_t kParts = 4;
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto begin =
        outcomes.begin() + static_cast<std::ptrdiff_t>(part * outcomes.size() / kParts);
    const auto end =
        outcomes.begin() + static_cast<std::ptrdiff_t>((part + 1) * outcomes.size() / kParts);
    printRow("  quarter " + std::to_string(part + 1), {begin, end});
  }
  printRow(disturbance.name, outcomes);
  std::printf(
      "  no marker predicted: %d frames without a pose, %d with one; no pose, though a marker is "
      "predicted: %d\n",
      expected, surprises, without);
  std::fflush(stdout);
}

/// The ids between commas.
std::set<int> idsIn(const std::string& text) {
  std::istringstream stream(text);
  std::set<int> ids;
  for (std::string id; std::getline(stream, id, ',');) ids.insert(std::atoi(id.c_str()));
  return ids;
}

struct Arguments {
  std::vector<std::string> files;
  std::set<int> only;
  bool prints_places = false;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--places") {
      arguments.prints_places = true;
    } else if (argument == "--only" && i + 1 < argc) {
      arguments.only = idsIn(argv[++i]);
    } else {
      arguments.files.push_back(argument);
    }
  }
  constexpr std::size_t kFiles = 4;
  if (arguments.files.size() != kFiles) {
    throw InputError("expected GRID BAG CAMERA MAP [--only ID,ID,...] [--places]");
  }
  return arguments;
}

int run(const Arguments& arguments) {
  const GridFile file = loadGridFile(arguments.files[0]);
  const OccupancyGrid grid(cv::imread(file.image, cv::IMREAD_GRAYSCALE), file);
  const std::string& camera_file = arguments.files[2];
  RecordedSequence sequence = loadSequence(arguments.files[1], camera_file, arguments.files[3]);
  std::vector<Marker>& markers = sequence.map.markers;
  markers.erase(std::remove_if(markers.begin(), markers.end(),
                               [&](const Marker& marker) {
                                 return !arguments.only.empty() &&
                                        arguments.only.count(marker.id) == 0;
                               }),
                markers.end());
  std::printf("%-24s %6s | %15s | %29s | %19s | %19s\n", "", "", "markers", "position, RMS (mm)",
              "median (mm)", "heading, RMS (deg)");
  std::printf("%-24s %6s | %9s %5s | %9s %9s %9s | %9s %9s | %9s %9s\n", "disturbed", "frames",
              "predicted", "used", "predicted", "stated", "error", "predicted", "error",
              "predicted", "error");
  Disturbance nothing;
  nothing.name = "nothing";
  Disturbance map;
  map.name = "map";
  map.marker = map.stated_marker = 0.005;
  map.marker_orientation = map.stated_marker_orientation = radians(1.0);
  Disturbance all = map;
  all.name = "map, lean, camera";
  all.lean = radians(0.5);
  all.height = 0.003;
  all.center = 0.5;
  all.rim = 0.5;
  all.stated_camera = 0.5;
  for (const Disturbance& disturbance : {nothing, map, all}) {
    study(disturbance, sequence, camera_file, grid, arguments.prints_places);
  }
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("planning_study",
                             [&] { return omnitag::run(omnitag::parse(argc, argv)); });
}
