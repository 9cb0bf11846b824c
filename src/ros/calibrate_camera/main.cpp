#include <exception>
#include <iostream>
#include <optional>
#include <string>

#include "../bag_tools/progress.h"
#include "camera_output.h"
#include "omnitag/calibration/camera_calibration.h"
#include "omnitag/calibration/camera_template.h"
#include "omnitag/calibration/reading_alignment.h"
#include "omnitag/calibration/residual_picture.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "options.h"
#include "recording.h"

namespace omnitag {
namespace {

/// A line for every step of a calibration.
class StepLog {
 public:
  void operator()(const std::string& step, int /*iteration*/) {
    if (step == last_) return;
    last_ = step;
    std::cerr << "calibrating: " << step << '\n';
  }

 private:
  std::string last_;
};

void run(const CalibrationOptions& options) {
  const CameraTemplate guess = CameraTemplate::fromFile(options.camera);
  const MarkerMap map = loadMarkerMap(options.map);
  Recording recording(options, map);
  CalibrationConfig config;
  config.fixed = options.fixed;

  const auto calibrate = [&](const std::shared_ptr<const CameraModel>& camera, const char* what,
                             bool is_rough, const Recording::Refinement& refine) {
    config.is_rough = is_rough;
    const auto frames = recording.read(camera, options.camera, what, refine);
    return calibrateCamera(guess, map, frames, config, StepLog());
  };
  const auto cameraOf = [&](const CalibrationResult& result) {
    return parseCamera(guess.text(result.camera_values, result.rim_radius), options.camera);
  };
  // A camera that is wrong bends the edges of markers in the views that they are read in.
  const CalibrationResult rough =
      calibrate(loadCamera(options.camera), "images, with the guess", true, {});
  const CalibrationResult better =
      calibrate(cameraOf(rough), "images again, with the camera found", false, {});
  // Known so well, all pixels of a marker tell where its corners are.
  const TagPatterns patterns(map);
  const MountedCamera found(cameraOf(better), better.base_from_camera);
  // What is off by as much as decoded corners are is then an outlier: a shadow, something in the
  // way.
  constexpr double kAlignedWidth = 0.05;  // pixels
  config.robust_width = kAlignedWidth;
  const CalibrationResult result =
      calibrate(cameraOf(better), "images once more, by all pixels", false,
                [&](const cv::Mat& image, std::vector<MarkerReading> readings) {
                  return alignReadings(image, map, patterns, found, std::move(readings));
                });

  const MountingFrames frames{recording.baseFrame(), recording.cameraFrame()};
  writePicture(options.picture,
               residualPicture(result, *cameraOf(result), recording.sampleImage()));
  writeAtomically(options.output, calibratedFile(result, guess, frames));
  std::cout << calibrationReport(result, frames) << "\nWritten: " << options.output << ", "
            << options.picture << '\n';
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
