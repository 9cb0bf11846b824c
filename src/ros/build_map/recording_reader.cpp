#include "recording_reader.h"

#include "../bag_tools/recorded_images.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/look_around.h"
#include "omnitag/view/view_warper.h"

namespace omnitag {

ReadRecording readRecording(const BagInput& input, const std::shared_ptr<const CameraModel>& camera,
                            const FrameAssembler& assembler, const LocalizerConfig& config,
                            const std::set<std::string>& families, std::size_t max_images) {
  const MarkerReader reader(camera, kWorkingDistance, config.detector, families);
  ReadRecording recording;
  double last_stamp = 0.0;
  useImages(input, assembler, max_images, "images",
            [&](const AssembledFrame& assembled, const rosbag::MessageInstance& message) {
              const Frame& frame = assembled.frame;
              if (!recording.frames.empty() && frame.stamp <= last_stamp) {
                throw InputError("stamp: expected later than the image before");
              }
              last_stamp = frame.stamp;
              const MountedCamera mounted(camera, frame.base_from_camera);
              recording.frames.push_back(
                  {frame.stamp, frame.base_from_camera, frame.odom_from_base,
                   readEverything(reader, mounted, frame.image, config.look_around)});
              recording.messages.push_back(message);
              recording.with_odometry += frame.odom_from_base ? 1 : 0;
            });
  return recording;
}

}  // namespace omnitag
