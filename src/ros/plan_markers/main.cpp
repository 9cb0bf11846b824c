#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "common/file_replacement.h"
#include "common/format.h"
#include "marker/marker_map_writer.h"
#include "marker/tag_family.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "planning/marker_placement.h"
#include "planning/plan_picture.h"
#include "planning/plan_report.h"
#include "ros/parameters.h"
#include "ros/plan_markers/options.h"

namespace omnitag {
namespace {

/// New markers are judged from at most this many poses: a choice hardly depends on more.
constexpr std::size_t kMostPoses = 3000;

int threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

OccupancyGrid loadGrid(const std::string& path) {
  const GridFile file = loadGridFile(path);
  cv::Mat image;
  try {
    // OpenCV itself would print additional complaints.
    const std::string bytes = YamlReader::textOf(file.image);
    if (!bytes.empty()) {
      image = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_GRAYSCALE);
    }
  } catch (const std::exception&) {
    image = cv::Mat();
  }
  if (image.empty()) {
    throw InputError(path + ": image: expected a PGM or PNG image, cannot read " + file.image);
  }
  return {image, file};
}

std::string png(const cv::Mat& picture) {
  constexpr int kSmallest = 9;
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, kSmallest});
  return {bytes.begin(), bytes.end()};
}

double sizeOf(const PlanOptions& options, const MarkerMap& map) {
  if (options.size) return *options.size;
  return map.default_size > 0.0 ? map.default_size : map.markers.front().size;
}

double heightOf(const PlanOptions& options, const MarkerMap& map) {
  if (options.height) return *options.height;
  double sum = 0.0;
  for (const Marker& marker : map.markers) sum += marker.center().z();
  constexpr double kCentimetre = 0.01;
  return kCentimetre * std::round(sum / static_cast<double>(map.markers.size()) / kCentimetre);
}

/// Picture markers have no ids, so no unused ones to take.
std::string familyOf(const PlanOptions& options, const MarkerMap& map) {
  const std::string& of_map =
      map.default_family.empty() ? map.markers.front().family : map.default_family;
  const std::string& family = options.family.empty() ? of_map : options.family;
  if (tagFamilies().count(family) > 0) return family;
  throw InputError("--family: expected a family of AprilTag or ArUco for new markers, found '" +
                   family + "'");
}

/// A hint that the grid and the map may have different frames; empty if nothing suggests that.
std::string frameRemark(const OccupancyGrid& grid, const MarkerMap& map) {
  std::string ids;
  int count = 0;
  for (const Marker& marker : map.markers) {
    constexpr double kInFront = 0.3;  // m
    const Eigen::Vector3d front = marker.center() + kInFront * marker.normal();
    if (grid.at(Eigen::Vector2d(front.head<2>())) == Cell::kFree) continue;
    ids += (ids.empty() ? "" : ", ") + std::to_string(marker.id);
    ++count;
  }
  if (count == 0) return "";
  return format(
      "In front of %d of %d markers the floor is not free (ids %s). Do the map and the "
      "floor have the same frame?\n",
      count, static_cast<int>(map.markers.size()), ids.c_str());
}

/// Every n-th pose, so that there are not too many, at each of the headings in turn.
std::vector<Pose> someOf(const std::vector<Pose>& poses, int headings) {
  std::size_t step = (poses.size() + kMostPoses - 1) / kMostPoses;
  while (std::gcd(step, static_cast<std::size_t>(headings)) != 1) ++step;
  std::vector<Pose> some;
  for (std::size_t i = 0; i < poses.size(); i += step) some.push_back(poses[i]);
  return some;
}

MarkerMap withMarkers(MarkerMap map, const std::vector<Marker>& added) {
  map.markers.insert(map.markers.end(), added.begin(), added.end());
  return map;
}

std::string plannedText(const std::string& text, const MarkerPlacement& placement,
                        const std::string& origin, const std::string& path) {
  std::vector<MapEntry> entries;
  for (const Marker& marker : placement.markers) {
    entries.push_back({marker, "planned: measure it once it hangs"});
  }
  return movedMapText(withEntries(text, entries, origin), origin, path);
}

std::string placementText(const MarkerPlacement& placement) {
  std::string text = format("\n%d new markers, the most useful first:\n",
                            static_cast<int>(placement.markers.size()));
  for (const Marker& marker : placement.markers) {
    const Eigen::Vector3d center = marker.center();
    const Eigen::Vector3d normal = marker.normal();
    text += format("  id %-4d at x %.2f, y %.2f, height %.2f m, facing %.0f degrees\n", marker.id,
                   center.x(), center.y(), center.z(), degrees(std::atan2(normal.y(), normal.x())));
  }
  return text + format(
                    "Their information gain is at least %.0f %% of the most that any %d of the "
                    "%d places on walls could have.\n",
                    1e2 * placement.guaranteed_share, static_cast<int>(placement.markers.size()),
                    static_cast<int>(placement.candidates));
}

std::string adviceText(const PlanOptions& options, const FloorSummary& before, bool has_planned) {
  constexpr double kMuch = 0.05;
  std::string text = "\nNext: ";
  if (has_planned) {
    text += "print the map with\n  rosrun omnitag print_markers --map " +
            options.file("planned.yaml") +
            " --output markers.pdf --checklist\nhang the new markers, measure where they really "
            "hang, and correct the map.\n";
  } else if (before.by_markers[0] + before.by_markers[1] + before.by_markers[2] > kMuch) {
    text += "--count N shows where N more markers help most, --size what larger ones would do.\n";
  } else {
    text +=
        "nothing; there are enough markers. A more careful survey (deviation in the map) or "
        "calibrate_camera makes the poses more exact.\n";
  }
  return text;
}

void run(const PlanOptions& options) {
  const auto model = loadCamera(options.camera);
  const MarkerMap map = loadMarkerMap(options.map);
  const OccupancyGrid grid = loadGrid(options.floor);
  const MountedCamera camera(model, options.base_from_camera);
  PlanningConfig config;
  if (!options.params.empty()) {
    config.localizer = readParameters(YamlReader::fromFile(options.params)).localizer;
  }
  const PlanningScene scene{grid, camera, config};
  const FloorPrediction floor = placesOn(grid, options.step, options.clearance);
  if (floor.places.empty()) {
    throw InputError(options.floor + ": expected a free cell with a clearance of " +
                     format("%g m, found none", options.clearance));
  }
  const auto predict = [&](const MarkerMap& of) {
    return predictFloor(scene, of, floor, options.headings, options.over_headings, threads());
  };
  std::vector<std::string> titles{"now"};
  FloorPrediction prediction = predict(map);
  std::vector<FloorSummary> summaries{summaryOf(prediction)};
  MarkerMap shown = map;
  std::vector<std::pair<std::string, std::string>> files;
  std::string report;
  if (options.count > 0) {
    const NewMarkers wanted{options.count, sizeOf(options, map), heightOf(options, map),
                            familyOf(options, map)};
    const std::vector<Pose> poses =
        someOf(posesAt(floor.places, options.headings), options.headings);
    const MarkerPlacement placement = placeMarkers(scene, map, poses, wanted, threads());
    shown = withMarkers(map, placement.markers);
    prediction = predict(shown);
    titles.push_back(format("with %d more", static_cast<int>(placement.markers.size())));
    summaries.push_back(summaryOf(prediction));
    files.emplace_back("planned.yaml", plannedText(YamlReader::textOf(options.map), placement,
                                                   options.map, options.file("planned.yaml")));
    report += placementText(placement);
  }
  if (options.compares) {
    const double size = sizeOf(options, map);
    const double height = heightOf(options, map);
    const std::vector<FamilyReach> reaches = familyReaches(camera, size, height);
    files.emplace_back("compare.csv", reachCsv(reaches));
    report +=
        format("\nMarkers of %.2f m at a height of %.2f m that face the camera:\n", size, height) +
        reachText(reaches);
  }
  files.emplace_back("plan.csv", csvText(prediction));
  files.emplace_back("plan.png", png(planPicture(grid, prediction, shown,
                                                 shown.markers.size() - map.markers.size())));
  std::error_code error;
  std::filesystem::create_directories(options.output, error);
  if (error) throw InputError("--output: " + options.output + ": " + error.message());
  for (const auto& [name, text] : files) replaceFile(options.file(name), text, Backup::kNone);
  std::cout << format("%d places, %.2f m apart, %d headings each\n\n",
                      static_cast<int>(floor.places.size()), floor.step, options.headings)
            << summaryText(titles, summaries) << report << frameRemark(grid, map)
            << adviceText(options, summaries.front(), options.count > 0);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    const std::optional<omnitag::PlanOptions> options = omnitag::parsePlanOptions(argc, argv);
    if (options) omnitag::run(*options);
  } catch (const std::exception& error) {
    std::cerr << "plan_markers: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
