#include "ros/adjustment_tools/drive.h"

#include <algorithm>
#include <utility>

#include "common/format.h"
#include "localization/look_around.h"
#include "marker/marker_reader.h"
#include "omnitag/common/error.h"
#include "ros/bag_tools/recorded_images.h"
#include "ros/conversions.h"
#include "ros/frame_assembler.h"
#include "view/view_warper.h"

namespace omnitag {

Drive::Drive(DriveOptions options) : options_(std::move(options)) {
  for (const std::string& bag : options_.bags) {
    inputs_.push_back(std::make_unique<BagInput>(bag, options_.image_topic));
    if (options_.mounting) {
      inputs_.back()->replaceMounting(options_.parameters.frames.base, *options_.mounting);
    }
  }
}

std::vector<FrameReadings> Drive::read(const std::shared_ptr<const CameraModel>& camera,
                                       const std::string& origin, const std::string& what,
                                       const Refinement& refine) {
  const LocalizerConfig& config = options_.parameters.localizer;
  const MarkerReader reader(camera, kWorkingDistance, config.detector, options_.families);
  const FrameAssembler assembler(origin, camera->imageSize(), options_.parameters.frames);
  std::vector<FrameReadings> frames;
  messages_.clear();
  with_odometry_ = 0;
  const std::size_t each = (options_.images + inputs_.size() - 1) / inputs_.size();
  for (std::size_t recording = 0; recording < inputs_.size(); ++recording) {
    const std::string name = inputs_.size() == 1 ? what : what + " of " + options_.bags[recording];
    useImages(
        *inputs_[recording], assembler, each, name,
        [&](const AssembledFrame& assembled, const rosbag::MessageInstance& message) {
          FrameReadings frame;
          frame.stamp = assembled.frame.stamp;
          frame.base_from_camera = assembled.frame.base_from_camera;
          frame.odom_from_base = assembled.frame.odom_from_base;
          frame.recording = recording;
          const bool follows = !frames.empty() && frames.back().recording == recording;
          if (follows && frame.stamp <= frames.back().stamp) {
            throw InputError("stamp: expected later than the image before");
          }
          frame.readings = readEverything(reader, MountedCamera(camera, frame.base_from_camera),
                                          assembled.frame.image, config.look_around);
          if (refine) {
            frame.readings = refine(assembled.frame.image, frame.stamp, std::move(frame.readings));
          }
          with_odometry_ += frame.odom_from_base ? 1 : 0;
          frames.push_back(std::move(frame));
          messages_.push_back(message);
          camera_frame_ = assembled.header.frame_id;
        });
  }
  return frames;
}

cv::Mat Drive::imageOf(std::size_t frame) const {
  return BagInput::grayImageOf(messages_.at(frame))->image;
}

std::optional<Eigen::Isometry3d> Drive::transformAt(const std::string& frame, double time) const {
  if (!(time > 0.0 && time < kTimesEnd)) return std::nullopt;
  for (const auto& input : inputs_) {
    auto found =
        findTransform(input->transforms(), frame, options_.parameters.frames.base, ros::Time(time));
    if (found) return found;
  }
  return std::nullopt;
}

void Drive::check(const std::string& option, const std::string& frame,
                  const std::string& what) const {
  const std::string& base = options_.parameters.frames.base;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    std::string why;
    // At the latest time in the bag.
    if (inputs_[i]->transforms().canTransform(frame, base, ros::Time(0), &why)) continue;
    throw InputError(format("%s: %s: expected %s from '%s' to '%s' in tf, found none: %s",
                            options_.bags[i].c_str(), option.c_str(), what.c_str(), base.c_str(),
                            frame.c_str(), why.c_str()));
  }
}

OdometryAt Drive::odometry() const {
  const std::string& frame = options_.parameters.frames.odom;
  check("--odom-frame", frame, "odometry");
  return [this, frame](double time) -> std::optional<Pose> {
    const auto odom_from_base = transformAt(frame, time);
    return odom_from_base ? std::optional(Pose::fromIsometry(*odom_from_base)) : std::nullopt;
  };
}

std::vector<PosePair> Drive::posesIn(const std::string& frame, const std::vector<double>& stamps,
                                     const std::vector<Pose>& map_from_base) const {
  check("--align-to", frame, "another localizer's pose");
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto there = transformAt(frame, stamps[i]);
    if (there) pairs.push_back({map_from_base[i], Pose::fromIsometry(*there)});
  }
  return pairs;
}

}  // namespace omnitag
