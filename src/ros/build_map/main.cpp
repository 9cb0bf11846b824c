#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adjustment/map_builder.h"
#include "adjustment/map_picture.h"
#include "adjustment/residual_picture.h"
#include "common/file_replacement.h"
#include "marker/map_constraint.h"
#include "marker/marker_families.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "ros/adjustment_tools/camera_output.h"
#include "ros/adjustment_tools/drive.h"
#include "ros/adjustment_tools/joint_run.h"
#include "ros/adjustment_tools/map_output.h"
#include "ros/adjustment_tools/step_log.h"
#include "ros/build_map/options.h"

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
  if (!options.seed.empty()) config.constraints = loadConstraints(options.seed);
  return config;
}

MarkerFamilies familiesToRead(const BuildOptions& options, const MarkerMap& seed) {
  MarkerFamilies families = familiesOf(seed);
  if (!options.family.empty()) families.codes.insert(options.family);
  if (families.isEmpty()) families.codes.insert("tag36h11");
  return families;
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

/// What is to be written and printed.
struct BuildResult {
  BuiltMap map;
  /// The camera that the map's residuals are relative to.
  std::shared_ptr<const CameraModel> camera;
  /// How far corners were off before, in pixels (RMS), if the camera was found, too; its file, and
  /// what to tell about it.
  std::optional<double> rms_before = {};
  std::string camera_text = {};
  std::string report = {};
};

BuildResult mapWithCameraHeld(const BuildOptions& options, const MarkerMap& seed,
                              const MapBuilderConfig& config, Drive* drive) {
  const DescribedCamera camera = drive->cameraOf(options.camera);
  const std::vector<FrameReadings> frames = drive->read(camera.model, camera.origin, "images");
  if (options.estimates_sizes && options.seed.empty() && drive->withOdometry() < 2) {
    throw InputError("--estimate-sizes: needs a seed or odometry, which tell the scale");
  }
  StepLog log("building the map");
  const auto panoramas = [drive](std::size_t frame) { return drive->imageOf(frame); };
  const auto progress = [&log](const std::string& step, std::size_t done, std::size_t total) {
    log.show(step, done, total);
  };
  return {buildMap(camera.model, frames, seed, config, panoramas, progress), camera.model};
}

BuildResult mapAndCamera(const BuildOptions& options, const MarkerMap& seed,
                         const MapBuilderConfig& config, Drive* drive) {
  JointRequest request{CameraTemplate::fromFile(options.camera), seed, config, {}, false};
  request.calibration.floor = drive->parameters().localizer.motion.floor;
  JointResult found = runJointly(request, drive);
  const MountingFrames frames{drive->baseFrame(), drive->cameraFrame()};
  return {std::move(found.map), found.model(request.guess), found.camera.before.rms,
          calibratedFile(found.camera, request.guess, frames),
          calibrationReport(found.camera, frames) + "\n"};
}

void run(const BuildOptions& options) {
  const MarkerMap seed = options.seed.empty() ? MarkerMap{} : loadMarkerMap(options.seed);
  const LocalizerParameters parameters = parametersOf(options);
  const MapBuilderConfig config = builderConfig(options, parameters, seed);
  Drive drive({options.bags,
               options.image_topic,
               parameters,
               {},
               familiesToRead(options, seed),
               static_cast<std::size_t>(options.max_images)});
  BuildResult result = options.output_camera.empty()
                           ? mapWithCameraHeld(options, seed, config, &drive)
                           : mapAndCamera(options, seed, config, &drive);
  BuiltMap& built = result.map;
  align(options.alignment, drive, &built);

  // Makes every result before writing any.
  const std::string frame =
      options.alignment.frame.empty() ? seed.frame_id : options.alignment.frame;
  const std::string text = mapText(options.alignment.isNone() ? options.seed : std::string(), frame,
                                   built, options.output);
  const cv::Mat residuals = residualPicture({built.residuals, built.stamps, result.rms_before},
                                            *result.camera, drive.imageOf(0));
  writePicture(options.drawing, mapPicture(built));
  writePicture(options.picture, residuals);
  if (!options.trajectory.empty()) writeTrajectory(built, options.trajectory);
  if (!result.camera_text.empty()) writeAtomically(options.output_camera, result.camera_text);
  replaceFile(options.output, text);
  std::printf("%simages:           %zu, %zu of them with a pose, %zu with odometry\n\n",
              result.report.c_str(), built.images, built.trajectory.size(), drive.withOdometry());
  printMap(built);
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
