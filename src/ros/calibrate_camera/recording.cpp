#include "recording.h"

#include <optional>
#include <set>
#include <utility>

#include "../bag_tools/recorded_images.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/look_around.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/ros/conversions.h"
#include "omnitag/ros/frame_assembler.h"

namespace omnitag {
namespace {

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
  if (!options.odom_frame.empty()) checkOdometry();
}

void Recording::checkOdometry() const {
  const std::string& base = parameters_.frames.base;
  std::string why;
  // At the last time that the bag has, whichever that is.
  if (input_.transforms().canTransform(options_.odom_frame, base, ros::Time(0), &why)) return;
  throw InputError(options_.bag + ": --odom-frame: expected odometry from '" + base + "' to '" +
                   options_.odom_frame + "' in tf, found none: " + why);
}

OdometryAt Recording::odometry() const {
  return [this](double time) -> std::optional<Pose> {
    if (!(time > 0.0 && time < kTimesEnd)) return std::nullopt;
    const auto odom_from_base = findTransform(input_.transforms(), options_.odom_frame,
                                              parameters_.frames.base, ros::Time(time));
    return odom_from_base ? std::optional(Pose::fromIsometry(*odom_from_base)) : std::nullopt;
  };
}

std::vector<FrameReadings> Recording::read(const std::shared_ptr<const CameraModel>& camera,
                                           const std::string& origin, const std::string& what,
                                           const Refinement& refine) {
  std::set<std::string> families;
  for (const Marker& marker : map_.markers) families.insert(marker.family);
  const MarkerReader reader(camera, kWorkingDistance, parameters_.localizer.detector, families);
  const FrameAssembler assembler(origin, camera->imageSize(), parameters_.frames);

  std::vector<FrameReadings> frames;
  useImages(
      input_, assembler, static_cast<std::size_t>(options_.images), what,
      [&](const AssembledFrame& assembled, const rosbag::MessageInstance& /*message*/) {
        FrameReadings frame;
        frame.stamp = assembled.frame.stamp;
        frame.base_from_camera = assembled.frame.base_from_camera;
        frame.readings = readEverything(reader, MountedCamera(camera, frame.base_from_camera),
                                        assembled.frame.image, parameters_.localizer.look_around);
        if (refine) {
          frame.readings = refine(assembled.frame.image, frame.stamp, std::move(frame.readings));
        }
        frames.push_back(std::move(frame));
        sample_image_ = assembled.frame.image.clone();
        camera_frame_ = assembled.header.frame_id;
      });
  return frames;
}

}  // namespace omnitag
