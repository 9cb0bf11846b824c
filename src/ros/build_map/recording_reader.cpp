#include "recording_reader.h"

#include "../bag_tools/progress.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/look_around.h"

namespace omnitag {
namespace {

/// Lines about single images that could not be used; the rest is counted.
constexpr std::size_t kMaxWarnings = 5;

/// m, as the localizer has it.
constexpr double kWorkingDistance = 3.0;

}  // namespace

ReadRecording readRecording(const BagInput& input, const std::shared_ptr<const CameraModel>& camera,
                            const FrameAssembler& assembler, const LocalizerConfig& config,
                            const std::set<std::string>& families, std::size_t max_images) {
  const MarkerReader reader(camera, kWorkingDistance, config.detector, families);
  ReadRecording recording;
  recording.view =
      std::make_unique<rosbag::View>(input.bag(), rosbag::TopicQuery(input.imageTopic()));
  const std::size_t count = recording.view->size();
  if (count == 0) throw InputError(input.imageTopic() + ": has no images");
  const std::size_t stride = (count + max_images - 1) / max_images;
  Progress progress(count, "images");
  std::string first_problem;
  std::size_t index = 0;
  double last_stamp = 0.0;
  for (const rosbag::MessageInstance& message : *recording.view) {
    const bool is_used = index++ % stride == 0;
    if (is_used) {
      try {
        const AssembledFrame assembled =
            assembler.assemble(BagInput::grayImageOf(message), input.transforms());
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
      } catch (const InputError& error) {
        if (first_problem.empty()) first_problem = error.what();
        if (recording.unusable++ < kMaxWarnings) {
          progress.warn(input.imageTopic() + ": " + error.what());
        }
      }
    }
    progress.show(index);
  }
  if (recording.frames.empty()) {
    throw InputError(input.imageTopic() + ": no image could be used: " + first_problem);
  }
  return recording;
}

}  // namespace omnitag
