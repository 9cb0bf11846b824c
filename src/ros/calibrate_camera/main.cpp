#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include "adjustment/camera_template.h"
#include "adjustment/map_picture.h"
#include "adjustment/residual_picture.h"
#include "common/file_replacement.h"
#include "marker/board_file.h"
#include "marker/map_constraint.h"
#include "marker/marker_families.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "ros/adjustment_tools/camera_output.h"
#include "ros/adjustment_tools/drive.h"
#include "ros/adjustment_tools/joint_run.h"
#include "ros/adjustment_tools/map_output.h"
#include "ros/calibrate_camera/options.h"
#include "ros/calibrate_camera/parameter_output.h"

namespace omnitag {
namespace {

LocalizerParameters parametersOf(const CalibrationOptions& options) {
  LocalizerParameters parameters;
  if (!options.params.empty()) parameters = readParameters(YamlReader::fromFile(options.params));
  parameters.frames.odom = options.odom_frame;
  return parameters;
}

MarkerFamilies familiesToRead(const CalibrationOptions& options, const MarkerMap& map) {
  MarkerFamilies families = familiesOf(map);
  if (!options.family.empty()) families.codes.insert(options.family);
  if (families.isEmpty()) families.codes.insert("tag36h11");
  return families;
}

JointRequest requestOf(const CalibrationOptions& options, const LocalizerParameters& parameters) {
  JointRequest request{
      CameraTemplate::fromFile(options.camera), {}, {}, {}, !options.odom_frame.empty()};
  if (!options.board.empty()) {
    request.seed = loadBoard(options.board);
    request.calibration.is_free = true;
  } else if (!options.map.empty()) {
    request.seed = loadMarkerMap(options.map);
    request.growth.constraints = loadConstraints(options.map);
  }
  request.growth.size = options.size;
  request.growth.relocalization = parameters.localizer.relocalization;
  request.growth.motion = parameters.localizer.motion;
  request.calibration.fixed = options.fixed;
  request.calibration.floor = parameters.localizer.motion.floor;
  return request;
}

void run(const CalibrationOptions& options) {
  const LocalizerParameters parameters = parametersOf(options);
  const JointRequest request = requestOf(options, parameters);
  const bool is_board = !options.board.empty();
  // In front of a board, the camera itself moves.
  const auto mounting = is_board ? Eigen::Isometry3d::Identity() : options.mounting;
  Drive drive({options.bags, options.image_topic, parameters, mounting,
               familiesToRead(options, request.seed), static_cast<std::size_t>(options.images)});
  std::optional<ParameterOutput> parameter_file;
  if (!options.output_params.empty()) parameter_file.emplace(options.output_params);

  JointResult found = runJointly(request, &drive);
  align(options.alignment, drive, &found.map);
  const auto camera = found.model(request.guess);
  const auto frames = is_board
                          ? std::nullopt
                          : std::optional(MountingFrames{drive.baseFrame(), drive.cameraFrame()});
  std::string text;
  if (!options.output_map.empty()) {
    const std::string& frame = options.alignment.frame;
    text = mapText(options.alignment.isNone() ? options.map : std::string(),
                   frame.empty() ? request.seed.frame_id : frame, found.map, options.output_map);
  }
  writePicture(options.picture, residualPicture({found.camera.residuals, found.camera.stamps,
                                                 found.camera.before.rms},
                                                *camera, drive.imageOf(0)));
  if (!options.drawing.empty()) writePicture(options.drawing, mapPicture(found.map));
  writeAtomically(options.output, calibratedFile(found.camera, request.guess, frames));
  if (!text.empty()) replaceFile(options.output_map, text);
  std::cout << calibrationReport(found.camera, frames);
  if (found.time) std::cout << '\n' << timeReport(*found.time, camera->imageSize().height);
  if (!text.empty()) {
    std::cout << '\n' << std::flush;
    printMap(found.map);
    std::fflush(stdout);
  }
  std::cout << "\nWritten: " << options.output << ", " << options.picture;
  if (!text.empty()) std::cout << ", " << options.output_map << ", " << options.drawing;
  if (parameter_file) {
    const std::string keys = parameter_file->write(*found.time);
    std::cout << (keys.empty() ? "\nNot written, as the drive tells no times: "
                               : ", " + keys + " in ")
              << options.output_params;
  }
  std::cout << '\n';
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    const auto options = omnitag::parseCalibrationOptions(argc, argv);
    if (options) omnitag::run(*options);
  } catch (const std::exception& error) {
    std::cerr << "calibrate_camera: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
