#pragma once

#include <rosbag/message_instance.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../bag_tools/bag_input.h"
#include "omnitag/adjustment/map_alignment.h"
#include "omnitag/adjustment/odometry_at.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/ros/parameters.h"

namespace omnitag {

/// Where a drive is recorded, and how it is read.
struct DriveOptions {
  /// Read in this order.
  std::vector<std::string> bags;
  std::string image_topic;
  LocalizerParameters parameters;
  /// base_from_camera, in place of the bags'.
  std::optional<Eigen::Isometry3d> mounting;
  /// Families of the markers that are looked for.
  std::set<std::string> families;
  /// How many images are looked at, spread over all bags.
  std::size_t images = 0;
};

/// The bags of a drive, whose images can be looked at as often as the camera gets better.
class Drive {
 public:
  /// `stamp`: the image's, in s.
  using Refinement = std::function<std::vector<MarkerReading>(const cv::Mat& image, double stamp,
                                                              std::vector<MarkerReading> readings)>;

  /// Throws InputError where a bag cannot be read.
  explicit Drive(DriveOptions options);

  /// What is read all around in some of its images, evenly spread. `origin` describes the camera in
  /// errors, `what` the images in the progress; `refine` betters what was read in an image. Images
  /// that cannot be used are warned about; throws InputError where none can, and where stamps of a
  /// bag do not increase.
  std::vector<FrameReadings> read(const std::shared_ptr<const CameraModel>& camera,
                                  const std::string& origin, const std::string& what,
                                  const Refinement& refine = {});

  /// An image (CV_8UC1) that was read last, by its index.
  cv::Mat imageOf(std::size_t frame) const;
  /// How many of the images that were read last have odometry.
  std::size_t withOdometry() const { return with_odometry_; }
  /// Of the images, and what they are mounted on.
  const std::string& cameraFrame() const { return camera_frame_; }
  const std::string& baseFrame() const { return options_.parameters.frames.base; }
  const LocalizerParameters& parameters() const { return options_.parameters; }
  /// The camera of a file, or that of the first bag's camera_info where `file` is empty; as
  /// BagInput has it.
  DescribedCamera cameraOf(const std::string& file) const {
    return inputs_.front()->cameraOf(file);
  }

  /// Of the parameters' odometry frame; lives no longer than the drive. Throws InputError where a
  /// bag has none.
  OdometryAt odometry() const;
  /// The robot as another localizer had it in its frame, at those of these times at which tf says
  /// so. Throws InputError where no bag has it.
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
