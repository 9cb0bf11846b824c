#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/mapped_entries.h"
#include "common/file_replacement.h"
#include "common/quantile.h"
#include "omnitag/common/error.h"
#include "ros/bag_tools/bag_input.h"
#include "ros/bag_tools/progress.h"
#include "ros/image_conversion.h"
#include "ros/image_localizer.h"
#include "ros/localize_bag/options.h"
#include "ros/localize_bag/result_bag.h"
#include "ros/localize_bag/result_files.h"

namespace omnitag {
namespace {

/// This many images that could not be used get a warning; the rest are only counted.
constexpr std::size_t kMaxWarnings = 5;

/// What the final lines of a run report.
struct Summary {
  std::size_t frames = 0;
  std::size_t frames_with_pose = 0;
  std::size_t unusable = 0;
  std::size_t without_odometry = 0;
  std::size_t markers = 0;
  std::vector<double> milliseconds;
  std::string first_problem;
  /// As of the last frame of each camera.
  std::map<std::string, std::vector<std::string>> advice;

  void add(const LocalizedImage& localized) {
    ++frames;
    frames_with_pose += localized.result.map_from_base ? 1 : 0;
    without_odometry += localized.input.odometry_problem.empty() ? 0 : 1;
    markers += static_cast<std::size_t>(localized.result.acceptedMarkers());
    milliseconds.push_back(1e3 * localized.result.timings.total);
    advice[localized.camera_name] = localized.result.advice;
  }
};

void print(const Summary& summary, std::uint64_t late) {
  const std::size_t processed = summary.milliseconds.size();
  std::printf("frames:            %zu\n", summary.frames);
  std::printf("frames with pose:  %zu\n", summary.frames_with_pose);
  std::printf("markers per frame: %.2f\n",
              static_cast<double>(summary.markers) /
                  static_cast<double>(std::max<std::size_t>(processed, 1)));
  std::printf("ms per frame:      median %.1f, 99th percentile %.1f\n",
              quantile(summary.milliseconds, 0.5), quantile(summary.milliseconds, 0.99));
  if (summary.unusable > 0) std::printf("unusable frames:   %zu\n", summary.unusable);
  if (summary.without_odometry > 0) {
    std::printf("without odometry:  %zu\n", summary.without_odometry);
  }
  for (const auto& [camera, lines] : summary.advice) {
    for (const std::string& line : lines) {
      std::printf("advice:            %s%s\n", camera.empty() ? "" : (camera + ": ").c_str(),
                  line.c_str());
    }
  }
  if (late > 0) std::printf("late, left out:    %llu\n", static_cast<unsigned long long>(late));
}

std::string stampText(const ros::Time& stamp) {
  return std::to_string(stamp.sec) + "." + std::to_string(stamp.nsec + 1000000000U).substr(1);
}

/// If asked for, writes the map file's text with what images have shown of its markers and of
/// others.
void saveMap(const BagOptions& options, const ImageLocalizer& localizer) {
  if (options.mapped.empty()) return;
  const std::vector<ProvisionalMarker> provisional = localizer.provisional();
  const std::vector<MapEntry> entries = usedEntries(provisional);
  std::printf("markers mapped:    %zu, %zu more are not known well enough\n", entries.size(),
              provisional.size() - entries.size());
  const LearntMap learnt =
      withLearnt(readTextFile(options.map), localizer.refined(), entries, options.map);
  if (learnt.refined > 0) std::printf("markers refined:   %zu\n", learnt.refined);
  replaceFile(options.mapped, movedMapText(learnt.text, options.map, options.mapped));
}

/// Replaces the bag's own transform if the options give another.
void mountCamera(const BagOptions& options, const LocalizerParameters& parameters,
                 BagInput* input) {
  if (options.mounting) input->replaceMounting(parameters.frames.base, *options.mounting);
}

/// Whether the bag's tf has a place for the robot's transform; if not, says why.
bool hasPlaceForTransform(const BagOptions& options, const BagInput& input,
                          const FrameNames& frames) {
  const std::optional<std::string> conflict = input.parentConflict(frames);
  if (conflict) std::cerr << "localize_bag: " << options.output << ": " << *conflict << '\n';
  return !conflict;
}

/// Opens the result bag if one is asked for.
void openOutput(const BagOptions& options, const LocalizerParameters& parameters,
                const BagInput& input, const ImageLocalizer& localizer,
                std::optional<ResultBag>* output) {
  if (options.output.empty()) return;
  const bool sends_tf =
      parameters.publish_tf && hasPlaceForTransform(options, input, localizer.frames());
  output->emplace(options.output, parameters, localizer, sends_tf);
}

/// Throws InputError if the chosen part has no images.
void checkSpan(const BagOptions& options, const BagInput& input) {
  const bool is_part = options.span.from > 0.0 || std::isfinite(options.span.until);
  if (!is_part || input.imageCount() > 0) return;
  throw InputError("--from, --until: expected a part of the recording with images, found none in " +
                   boost::algorithm::join(options.bags, ", "));
}

/// Counts a frame, and warns about anything odd in it.
void note(const LocalizedImage& localized, const std::string& stamp, const Progress& progress,
          Summary* summary) {
  if (localized.went_back > 0.0) progress.warn(stamp + ": stamps went back: started anew");
  const std::string& odometry_problem = localized.input.odometry_problem;
  if (!odometry_problem.empty() && summary->without_odometry < kMaxWarnings) {
    progress.warn(stamp + ": " + odometry_problem);
  }
  summary->add(localized);
}

std::vector<std::string> topicsOf(const LocalizerParameters& parameters) {
  std::vector<std::string> topics;
  for (const CameraParameters& camera : parameters.cameras) topics.push_back(camera.image);
  return topics;
}

std::vector<DescribedCamera> camerasOf(const LocalizerParameters& parameters,
                                       const BagInput& input) {
  std::vector<DescribedCamera> cameras;
  for (std::size_t i = 0; i < parameters.cameras.size(); ++i) {
    cameras.push_back(input.cameraOf(parameters.cameras[i].camera_file, i));
  }
  return cameras;
}

void run(const BagOptions& options) {
  const LocalizerParameters parameters = parametersOf(options);
  const std::vector<std::string> topics = topicsOf(parameters);
  BagInput input(options.bags, topics, options.span);
  checkSpan(options, input);
  mountCamera(options, parameters, &input);
  ImageLocalizer localizer(parameters, camerasOf(parameters, input));
  ResultFiles files(options.trajectory, options.poses, options.detections);
  std::optional<ResultBag> output;
  openOutput(options, parameters, input, localizer, &output);

  Progress progress(input.imageCount(), "images");
  Summary summary;
  std::size_t done = 0;
  const auto localizeWith = [&](std::size_t camera, const rosbag::MessageInstance& message) {
    ros::Time stamp = message.getTime();
    try {
      const cv_bridge::CvImageConstPtr image =
          inFrame(BagInput::grayImageOf(message), parameters.cameras[camera].frame);
      stamp = image->header.stamp;
      const std::optional<LocalizedImage> localized = localizer.localize(
          image, input.transforms(), {output.has_value(), output.has_value()}, camera);
      if (localized) {
        note(*localized, stampText(stamp), progress, &summary);
        files.add(stamp, *localized, localizer.map());
        if (output) output->add(message.getTime(), *localized, localizer);
      }
    } catch (const InputError& error) {
      const std::string problem =
          message.getTopic() + " at " + stampText(stamp) + ": " + error.what();
      if (summary.first_problem.empty()) summary.first_problem = problem;
      if (summary.unusable < kMaxWarnings) progress.warn(problem);
      ++summary.frames;
      ++summary.unusable;
      files.addUnusable(stamp);
    }
  };
  const auto localize = [&](const rosbag::MessageInstance& message) {
    for (std::size_t i = 0; i < topics.size(); ++i) {
      if (input.imageTopic(i) == message.getTopic()) localizeWith(i, message);
    }
    progress.show(++done);
  };

  if (output) {
    input.forEachEarlierStatic(
        [&](const rosbag::MessageInstance& message) { output->copy(message, input.begin()); });
    input.forEachMessage([&](const rosbag::MessageInstance& message) {
      output->copy(message, message.getTime());
      if (input.isImage(message)) localize(message);
    });
  } else {
    input.forEachImage(localize);
  }
  files.close();
  if (output) output->close();
  if (summary.milliseconds.empty()) {
    throw InputError(boost::algorithm::join(options.bags, ", ") +
                     ": no image could be used: " + summary.first_problem);
  }
  print(summary, localizer.lateImages());
  saveMap(options, localizer);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    const std::optional<omnitag::BagOptions> options = omnitag::parseOptions(argc, argv);
    if (options) omnitag::run(*options);
  } catch (const std::exception& error) {
    std::cerr << "localize_bag: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
