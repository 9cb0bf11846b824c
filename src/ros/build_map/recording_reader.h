#pragma once

#include <rosbag/message_instance.h>

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "../bag_tools/bag_input.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/ros/frame_assembler.h"

namespace omnitag {

/// What the images of a bag show.
struct ReadRecording {
  std::vector<FrameReadings> frames;
  /// Of each frame, its image in the bag, which must outlive this.
  std::vector<rosbag::MessageInstance> messages;
  std::size_t with_odometry = 0;
};

/// Reads every marker in the images of a bag, `max_images` of them at most, wherever the panorama
/// shows it. Shows its progress. Throws InputError where no image could be used.
ReadRecording readRecording(const BagInput& input, const std::shared_ptr<const CameraModel>& camera,
                            const FrameAssembler& assembler, const LocalizerConfig& config,
                            const std::set<std::string>& families, std::size_t max_images);

}  // namespace omnitag
