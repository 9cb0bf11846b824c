#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../bag_tools/progress.h"
#include "camera_output.h"
#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/camera_template.h"
#include "omnitag/adjustment/reading_alignment.h"
#include "omnitag/adjustment/residual_picture.h"
#include "omnitag/adjustment/timed_calibration.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "options.h"
#include "parameter_output.h"
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

/// A calibration from what was read, and how the camera took an image.
class Run {
 public:
  explicit Run(const CalibrationOptions& options)
      : options_(options),
        guess_(CameraTemplate::fromFile(options.camera)),
        map_(loadMarkerMap(options.map)),
        recording_(options, map_) {
    config_.fixed = options.fixed;
    if (hasOdometry()) odometry_ = recording_.odometry();
    if (!options.output_params.empty()) parameters_.emplace(options.output_params);
  }

  void calibrate() {
    // A camera that is wrong bends the edges of markers in the views that they are read in.
    findRoughly();
    find("images again, with the camera found", {});
    // Known so well, all pixels of a marker tell where its corners are.
    const TagPatterns patterns(map_);
    const MountedCamera found(camera(), result_.base_from_camera);
    const std::optional<TimeCalibration> time = time_;
    // What is off by as much as decoded corners are is then an outlier: a shadow, something in the
    // way.
    constexpr double kAlignedWidth = 0.05;  // pixels
    config_.robust_width = kAlignedWidth;
    find("images once more, by all pixels",
         [&](const cv::Mat& image, double stamp, std::vector<MarkerReading> readings) {
           const MountedCamera then =
               time ? cameraAt(found, *time, odometry_, recording_.motion(), stamp) : found;
           return alignReadings(image, map_, patterns, then, std::move(readings));
         });
  }

  void write() const {
    const MountingFrames frames{recording_.baseFrame(), recording_.cameraFrame()};
    writePicture(options_.picture, residualPicture(result_, *camera(), recording_.sampleImage()));
    writeAtomically(options_.output, calibratedFile(result_, guess_, frames));
    std::cout << calibrationReport(result_, frames);
    if (time_) std::cout << '\n' << timeReport(*time_, camera()->imageSize().height);
    std::cout << "\nWritten: " << options_.output << ", " << options_.picture;
    if (parameters_) {
      const std::string keys = parameters_->write(*time_);
      std::cout << (keys.empty() ? "\nNot written, as the drive tells no times: "
                                 : ", " + keys + " in ")
                << options_.output_params;
    }
    std::cout << '\n';
  }

 private:
  bool hasOdometry() const { return !options_.odom_frame.empty(); }

  std::shared_ptr<const CameraModel> camera() const {
    return parseCamera(guess_.text(result_.camera_values, result_.rim_radius), options_.camera);
  }

  void findRoughly() {
    CalibrationConfig rough = config_;
    rough.is_rough = true;
    if (hasOdometry()) rough.max_residual = kMaxRollingResidual;
    const auto frames =
        recording_.read(loadCamera(options_.camera), options_.camera, "images, with the guess", {});
    result_ = calibrateCamera(guess_, map_, frames, rough, StepLog());
  }

  void find(const char* what, const Recording::Refinement& refine) {
    const auto frames = recording_.read(camera(), options_.camera, what, refine);
    if (!hasOdometry()) {
      result_ = calibrateCamera(guess_, map_, frames, config_, StepLog());
      return;
    }
    TimedCalibration found = calibrateCameraAndTime(guess_, map_, frames, config_, odometry_,
                                                    recording_.motion(), StepLog());
    result_ = std::move(found.camera);
    time_ = std::move(found.time);
  }

  const CalibrationOptions& options_;
  CameraTemplate guess_;
  MarkerMap map_;
  Recording recording_;
  CalibrationConfig config_;
  OdometryAt odometry_;
  std::optional<ParameterOutput> parameters_;
  CalibrationResult result_;
  std::optional<TimeCalibration> time_;
};

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    const auto options = omnitag::parseCalibrationOptions(argc, argv);
    if (!options) return 0;
    omnitag::Run run(*options);
    run.calibrate();
    run.write();
  } catch (const std::exception& error) {
    std::cerr << "calibrate_camera: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
