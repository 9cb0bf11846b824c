#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "../bag_tools/bag_input.h"
#include "omnitag/adjustment/odometry_at.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/ros/parameters.h"
#include "options.h"

namespace omnitag {

/// The bag of a drive, whose images can be looked at as often as the camera gets better.
class Recording {
 public:
  /// `stamp`: the image's, in s.
  using Refinement = std::function<std::vector<MarkerReading>(const cv::Mat& image, double stamp,
                                                              std::vector<MarkerReading> readings)>;

  /// Throws InputError where the bag cannot be read, or has not the odometry that it should have.
  Recording(const CalibrationOptions& options, const MarkerMap& map);

  /// What is read all around in some of its images, evenly spread. `origin` describes the camera in
  /// errors, `what` the images in the progress; `refine` betters what was read in an image. Images
  /// that cannot be used are warned about; throws InputError where none can.
  std::vector<FrameReadings> read(const std::shared_ptr<const CameraModel>& camera,
                                  const std::string& origin, const std::string& what,
                                  const Refinement& refine = {});

  /// One of the images that were read last.
  const cv::Mat& sampleImage() const { return sample_image_; }
  /// Of the images, and what they are mounted on.
  const std::string& cameraFrame() const { return camera_frame_; }
  const std::string& baseFrame() const { return parameters_.frames.base; }

  /// Of the options' odometry frame; lives no longer than the recording.
  OdometryAt odometry() const;
  /// What it errs by, and how the robot stands.
  const MotionModelConfig& motion() const { return parameters_.localizer.motion; }

 private:
  void checkOdometry() const;

  const CalibrationOptions& options_;
  const MarkerMap& map_;
  LocalizerParameters parameters_;
  BagInput input_;
  cv::Mat sample_image_;
  std::string camera_frame_;
};

}  // namespace omnitag
