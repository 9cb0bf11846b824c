#pragma once

#include <rosbag/message_instance.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/map_alignment.h"
#include "adjustment/odometry_at.h"
#include "localization/frame_readings.h"
#include "marker/marker_families.h"
#include "omnitag/camera/camera_model.h"
#include "ros/bag_tools/bag_input.h"
#include "ros/parameters.h"

namespace omnitag {

/// Where a drive is recorded, and how to read it.
struct DriveOptions {
  /// Read in this order.
  std::vector<std::string> bags;
  std::string image_topic;
  LocalizerParameters parameters;
  /// base_from_camera, in place of the bags'.
  std::optional<Eigen::Isometry3d> mounting;
  /// Families of the markers that are looked for.
  MarkerFamilies families;
  /// How many images are read, spread over all bags.
  std::size_t images = 0;
};

/// The bags of a drive, whose images can be read again as the camera gets better.
class Drive {
 public:
  /// `stamp`: the image's, in s.
  using Refinement = std::function<std::vector<MarkerReading>(const cv::Mat& image, double stamp,
                                                              std::vector<MarkerReading> readings)>;

  /// Throws InputError if a bag cannot be read.
  explicit Drive(DriveOptions options);

  /// The readings all around in some of the images, evenly spread. `origin` names the camera in
  /// errors, `what` the images in the progress; `refine` improves the readings of an image. Images
  /// that cannot be used cause warnings, as do stamps that do not increase. Throws InputError if no
  /// image of a bag can be used.
  std::vector<FrameReadings> read(const std::shared_ptr<const CameraModel>& camera,
                                  const std::string& origin, const std::string& what,
                                  const Refinement& refine = {});

  /// An image (CV_8UC1) that was read last, by its index.
  cv::Mat imageOf(std::size_t frame) const;
  /// How many of the images read last have odometry.
  std::size_t withOdometry() const { return with_odometry_; }
  /// The frame of the images, and the frame that the camera is mounted on.
  const std::string& cameraFrame() const { return camera_frame_; }
  const std::string& baseFrame() const { return options_.parameters.frames.base; }
  const LocalizerParameters& parameters() const { return options_.parameters; }
  /// The camera of a file, or of the first bag's camera_info if `file` is empty; see BagInput.
  DescribedCamera cameraOf(const std::string& file) const {
    return inputs_.front()->cameraOf(file);
  }

  /// Odometry in the odometry frame of the parameters; must not outlive the drive. Throws
  /// InputError if a bag has no odometry.
  OdometryAt odometry() const;
  /// The robot's poses by another localizer, in its frame, paired with these poses at the times for
  /// which tf has them. Throws InputError if a bag has none.
  std::vector<PosePair> posesIn(const std::string& frame, const std::vector<double>& stamps,
                                const std::vector<Pose>& map_from_base) const;

 private:
  std::optional<Eigen::Isometry3d> transformAt(const std::string& frame, double time) const;
  void check(const std::string& option, const std::string& frame, const std::string& what) const;

  DriveOptions options_;
  std::vector<std::unique_ptr<BagInput>> inputs_;
  std::vector<rosbag::MessageInstance> messages_;
  std::size_t with_odometry_ = 0;
  std::string camera_frame_;
};

}  // namespace omnitag
