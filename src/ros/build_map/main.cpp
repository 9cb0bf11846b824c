#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../bag_tools/bag_input.h"
#include "map_drawing.h"
#include "omnitag/adjustment/map_builder.h"
#include "omnitag/adjustment/mapped_entries.h"
#include "omnitag/adjustment/marker_estimate.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/common/file_replacement.h"
#include "omnitag/marker/marker_map_file.h"
#include "omnitag/marker/marker_map_writer.h"
#include "options.h"
#include "recording_reader.h"

namespace omnitag {
namespace {

LocalizerParameters parametersOf(const BuildOptions& options) {
  LocalizerParameters parameters;
  if (!options.params.empty()) parameters = readParameters(YamlReader::fromFile(options.params));
  parameters.frames.odom = options.odom_frame;
  return parameters;
}

MapBuilderConfig builderConfig(const BuildOptions& options, const LocalizerParameters& parameters,
                               const MarkerMap& seed) {
  MapBuilderConfig config;
  config.size = options.size > 0.0 ? options.size : seed.default_size;
  if (config.size == 0.0) {
    throw InputError(
        "--size: expected the size of unknown markers (m), as the seed has no default");
  }
  config.estimates_sizes = options.estimates_sizes;
  config.corner_noise = parameters.mapper.corner_noise;
  config.blur = parameters.localizer.estimation.blur;
  config.relocalization = parameters.localizer.relocalization;
  config.motion = parameters.localizer.motion;
  return config;
}

std::set<std::string> familiesOf(const BuildOptions& options, const MarkerMap& seed) {
  std::set<std::string> families;
  for (const Marker& marker : seed.markers) families.insert(marker.family);
  if (!options.family.empty()) {
    families.insert(options.family);
  } else if (!seed.default_family.empty()) {
    families.insert(seed.default_family);
  } else if (families.empty()) {
    families.insert("tag36h11");
  }
  return families;
}

/// m and rad: standard deviations in the direction in which they are largest.
std::pair<double, double> deviationsOf(const BuiltMarker& marker) {
  MarkerEstimate estimate;
  estimate.covariance = marker.covariance;
  return {estimate.positionDeviation(), estimate.orientationDeviation()};
}

void print(const BuiltMap& built, const ReadRecording& recording) {
  std::printf("images:           %zu, %zu of them with a pose, %zu with odometry\n", built.images,
              built.trajectory.size(), recording.with_odometry);
  std::printf("\n%6s  %-20s %24s %10s %10s %6s %9s\n", "id", "name", "position (m)", "dev (mm)",
              "dev (deg)", "read", "rms (px)");
  for (const BuiltMarker& each : built.markers) {
    const auto [position, orientation] = deviationsOf(each);
    const Eigen::Vector3d center = each.marker.center();
    std::array<char, 64> place{};
    std::snprintf(place.data(), place.size(), "%.3f %.3f %.3f", center.x(), center.y(), center.z());
    const std::string name = each.is_seed && each.marker.name.empty() ? "(seed)" : each.marker.name;
    std::printf("%6d  %-20s %24s", each.marker.id, name.c_str(), place.data());
    if (each.is_seed) {
      std::printf(" %10s %10s", "-", "-");
    } else {
      std::printf(" %10.2f %10.3f", 1e3 * position, degrees(orientation));
    }
    std::printf(" %6zu %9.3f\n", each.sightings, each.residual);
    if (each.size_variance > 0.0) {
      std::printf("%8s size %.4f m, standard deviation %.2f mm\n", "", each.marker.size,
                  1e3 * std::sqrt(each.size_variance));
    }
  }
  std::printf("\nworst residuals:\n");
  for (const WorstReading& each : built.worst) {
    std::printf("  %8.2f px  %s at %.2f s\n", each.residual, each.marker.c_str(), each.stamp);
  }
  if (!built.remarks.empty()) std::printf("\n");
  for (const std::string& remark : built.remarks) std::printf("note: %s\n", remark.c_str());
}

std::string mapText(const BuildOptions& options, const BuiltMap& built) {
  std::vector<MapEntry> entries;
  for (const BuiltMarker& each : built.markers) {
    if (each.is_seed) continue;
    entries.push_back(mappedEntry(each.marker, each.covariance));
  }
  if (options.seed.empty()) return newMapText("map", entries);
  return withEntries(readTextFile(options.seed), entries, options.seed);
}

void writeTrajectory(const BuiltMap& built, const std::string& path) {
  std::ofstream stream(path);
  for (std::size_t i = 0; i < built.trajectory.size(); ++i) {
    const Pose& pose = built.trajectory[i];
    const Eigen::Quaterniond rotation(pose.toIsometry().linear());
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  built.stamps[i], pose.x, pose.y, pose.z, rotation.x(), rotation.y(), rotation.z(),
                  rotation.w());
    stream << line.data();
  }
  stream.close();
  if (!stream) throw InputError("--trajectory: " + path + " cannot be written");
}

void run(const BuildOptions& options) {
  const MarkerMap seed = options.seed.empty() ? MarkerMap{} : loadMarkerMap(options.seed);
  const LocalizerParameters parameters = parametersOf(options);
  const MapBuilderConfig config = builderConfig(options, parameters, seed);
  const BagInput input(options.bag, options.image_topic);
  const DescribedCamera camera =
      options.camera.empty() ? input.describedCamera() : cameraFromFile(options.camera);
  const FrameAssembler assembler(camera.origin, camera.model->imageSize(), parameters.frames);
  const ReadRecording recording =
      readRecording(input, camera.model, assembler, parameters.localizer, familiesOf(options, seed),
                    static_cast<std::size_t>(options.max_images));
  if (options.estimates_sizes && options.seed.empty() && recording.with_odometry < 2) {
    throw InputError("--estimate-sizes: needs a seed or odometry, which tell the scale");
  }
  const auto panorama = [&](std::size_t frame) {
    return BagInput::grayImageOf(recording.messages[frame])->image;
  };
  const BuiltMap built = buildMap(camera.model, recording.frames, seed, config, panorama);
  // All is made before anything is written.
  const std::string text = mapText(options, built);
  drawMap(built, options.drawing);
  if (!options.trajectory.empty()) writeTrajectory(built, options.trajectory);
  replaceFile(options.output, text);
  print(built, recording);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    const std::optional<omnitag::BuildOptions> options = omnitag::parseBuildOptions(argc, argv);
    if (options) omnitag::run(*options);
  } catch (const std::exception& error) {
    std::cerr << "build_map: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
