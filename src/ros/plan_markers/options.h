#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "planning/floor_prediction.h"

namespace omnitag {

/// The command line of plan_markers.
struct PlanOptions {
  std::string camera;
  std::string map;
  std::string floor;
  std::string params;
  std::string output;
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  /// m; the map's if not given.
  std::optional<double> size;
  std::optional<double> height;
  /// The map's if not given.
  std::string family;
  /// Number of new markers; 0: none.
  int count = 0;
  bool compares = false;
  /// m between places; 0: about 3000 places.
  double step = 0.0;
  /// m: least distance from places to obstacles.
  double clearance = 0.25;
  int headings = 8;
  Headings over_headings = Headings::kWorst;

  std::string file(const std::string& name) const { return output + "/" + name; }
};

/// Reads the command line; nothing if only help was asked for. Throws InputError.
std::optional<PlanOptions> parsePlanOptions(int argc, char** argv);

}  // namespace omnitag
