#include "ros/plan_markers/options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>
#include <vector>

#include "camera/camera_yaml.h"
#include "common/format.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "planning/occupancy_grid.h"
#include "ros/bag_tools/command_line.h"
#include "ros/bag_tools/mounting_option.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

constexpr const char* kUsage =
    "usage: plan_markers --camera C.yaml --map M.yaml --floor GRID.yaml\n"
    "                    --mounting X,Y,Z,QX,QY,QZ,QW --output DIR [options]\n"
    "\n"
    "Predicts how well one image tells the robot's pose, all over the floor, and where more "
    "markers\n"
    "would help most. Writes DIR/plan.png, a picture, and DIR/plan.csv, a table; with --count\n"
    "DIR/planned.yaml, the map with new markers; with --compare DIR/compare.csv. Needs no "
    "roscore.\n"
    "\n"
    "  plan_markers --camera my_camera.yaml --map my_map.yaml --floor floor.yaml \\\n"
    "      --mounting 0.10,0,1.1,1,0,0,0 --count 5 --output plan\n";

/// The value of an option. Throws InputError unless it is from `least` to `most`.
template <typename Number>
Number checked(const char* option, Number value, Number least, Number most) {
  if (value >= least && value <= most) return value;
  throw InputError(std::string(option) + ": expected a number from " +
                   format("%g", static_cast<double>(least)) + " to " +
                   format("%g", static_cast<double>(most)) + ", found " +
                   format("%g", static_cast<double>(value)));
}

/// An option with such a number, which is passed to `take`.
template <typename Number, typename Take>
po::typed_value<Number>* numberOption(const char* option, const char* name, Number least,
                                      Number most, const Take& take) {
  return po::value<Number>()->value_name(name)->notifier(
      [=](Number value) { take(checked(option, value, least, most)); });
}

Headings headingsOf(const std::string& text) {
  if (text == "worst") return Headings::kWorst;
  if (text == "mean") return Headings::kMean;
  throw InputError("--over-headings: expected worst or mean, found '" + text + "'");
}

void checkFiles(const PlanOptions& options) {
  std::error_code ignored;
  if (std::filesystem::exists(options.output, ignored) &&
      !std::filesystem::is_directory(options.output, ignored)) {
    throw InputError("--output: expected a directory, found the file " + options.output);
  }
  std::vector<PathOption> outputs;
  for (const char* name : {"plan.png", "plan.csv", "planned.yaml", "compare.csv"}) {
    outputs.emplace_back("--output", options.file(name));
  }
  checkOutputs({cameraFilePath(options.camera), options.map, options.floor, options.params},
               outputs);
}

}  // namespace

std::optional<PlanOptions> parsePlanOptions(int argc, char** argv) {
  constexpr double kLargest = 10.0;  // m, a marker and a height
  constexpr double kWidest = 100.0;  // m
  constexpr int kMostHeadings = 72;
  constexpr int kMostMarkers = 1000;
  PlanOptions options;
  std::string over_headings = "worst";
  po::options_description description("options");
  description.add_options()("help,h", "print this")(
      "camera", textOption(&options.camera, "C.yaml")->required(), "camera file")(
      "map", textOption(&options.map, "M.yaml")->required(), "marker map")(
      "floor", textOption(&options.floor, "GRID.yaml")->required(),
      "occupancy grid, as map_server reads it, in the marker map's frame")(
      "mounting",
      po::value<std::string>()
          ->required()
          ->value_name("X,Y,Z,QX,..")
          ->notifier([&options](const std::string& text) {
            options.base_from_camera = parseMounting("--mounting", text);
          }),
      "the camera's optical frame in base_link: X,Y,Z,QX,QY,QZ,QW, or X,Y,Z,ROLL,PITCH,YAW")(
      "output", textOption(&options.output, "DIR")->required(), "directory for the results")(
      "count",
      numberOption<int>("--count", "N", 1, kMostMarkers,
                        [&options](int count) { options.count = count; }),
      "place this many more markers on the walls")(
      "size",
      numberOption<double>("--size", "S", 0.01, kLargest,
                           [&options](double size) { options.size = size; }),
      "m, edge of new and of compared markers; default: the map's")(
      "height",
      numberOption<double>("--height", "H", -kLargest, kLargest,
                           [&options](double height) { options.height = height; }),
      "m, of their centres; default: the mean of the map's")(
      "family", textOption(&options.family, "F"), "of new markers; default: the map's")(
      "compare", po::bool_switch(&options.compares),
      "print from how far markers of several families are recognized and read")(
      "step",
      numberOption<double>("--step", "M", 0.001, kWidest,
                           [&options](double step) { options.step = step; }),
      "m between places; default: such that there are about 3000")(
      "clearance",
      numberOption<double>("--clearance", "M", 0.0, kWidest,
                           [&options](double clearance) { options.clearance = clearance; }),
      "m between the robot's base and obstacles; default: 0.25")(
      "headings",
      numberOption<int>("--headings", "N", 1, kMostHeadings,
                        [&options](int headings) { options.headings = headings; }),
      "headings at each place; default: 8")(
      "over-headings", textOption(&over_headings, "HOW"),
      "worst: the worst heading counts (default); mean: the mean of those that see a marker")(
      "params", textOption(&options.params, "P.yaml"),
      "the localizer's parameters, as in config/localizer.yaml: floor/…, visibility/…");
  if (!parseCommandLine(argc, argv, kUsage, description)) return std::nullopt;
  options.over_headings = headingsOf(over_headings);
  checkFiles(options);
  return options;
}

}  // namespace omnitag
