#include "recording.h"

#include <rosbag/view.h>

#include <algorithm>
#include <set>
#include <utility>

#include "../bag_tools/progress.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/look_around.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/ros/frame_assembler.h"

namespace omnitag {
namespace {

/// m, of the look-up table that views go through.
constexpr double kWorkingDistance = 3.0;

/// Lines about single images that could not be used.
constexpr std::size_t kMaxWarnings = 5;

LocalizerParameters parametersOf(const CalibrationOptions& options) {
  LocalizerParameters parameters;
  if (!options.params.empty()) {
    parameters = readParameters(YamlReader::fromFile(options.params));
  }
  parameters.frames.odom.clear();
  return parameters;
}

}  // namespace

Recording::Recording(const CalibrationOptions& options, const MarkerMap& map)
    : options_(options),
      map_(map),
      parameters_(parametersOf(options)),
      input_(options.bag, options.image_topic) {
  if (options.mounting) input_.replaceMounting(parameters_.frames.base, *options.mounting);
}

std::vector<FrameReadings> Recording::read(const std::shared_ptr<const CameraModel>& camera,
                                           const std::string& origin, const std::string& what,
                                           const Refinement& refine) {
  std::set<std::string> families;
  for (const Marker& marker : map_.markers) families.insert(marker.family);
  const MarkerReader reader(camera, kWorkingDistance, parameters_.localizer.detector, families);
  const FrameAssembler assembler(origin, camera->imageSize(), parameters_.frames);

  rosbag::View view(input_.bag(), rosbag::TopicQuery(input_.imageTopic()));
  const std::size_t all = view.size();
  const std::size_t wanted = std::min(all, static_cast<std::size_t>(options_.images));
  Progress progress(wanted, what);
  std::vector<FrameReadings> frames;
  std::string first_problem;
  std::size_t problems = 0;
  std::size_t index = 0;
  std::size_t done = 0;
  for (const rosbag::MessageInstance& message : view) {
    const bool is_wanted = done < wanted && index++ == done * all / wanted;
    if (!is_wanted) continue;
    try {
      const AssembledFrame assembled =
          assembler.assemble(BagInput::grayImageOf(message), input_.transforms());
      FrameReadings frame;
      frame.stamp = assembled.frame.stamp;
      frame.base_from_camera = assembled.frame.base_from_camera;
      frame.readings = readEverything(reader, MountedCamera(camera, frame.base_from_camera),
                                      assembled.frame.image, parameters_.localizer.look_around);
      if (refine) frame.readings = refine(assembled.frame.image, std::move(frame.readings));
      frames.push_back(std::move(frame));
      sample_image_ = assembled.frame.image.clone();
      camera_frame_ = assembled.header.frame_id;
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
      if (problems++ < kMaxWarnings) progress.warn(input_.imageTopic() + ": " + error.what());
    }
    progress.show(++done);
  }
  if (frames.empty()) {
    throw InputError(options_.bag + ": no image could be used: " + first_problem);
  }
  return frames;
}

}  // namespace omnitag
