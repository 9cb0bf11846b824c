// Milliseconds of each step of a frame, on the shipped sequence: predict, warp, decode, solve and
// their total, as means over all frames, with the median and 99th percentile of the total.
//
//   frame_benchmark [Google Benchmark's options]

#include <benchmark/benchmark.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

const std::string kPackage = PACKAGE_DIR;

/// As worlds/paper.yaml mounts the camera.
Eigen::Isometry3d mounting() {
  return Eigen::Translation3d(0.10, 0.02, 1.1) *
         Eigen::Quaterniond(0.0, 0.9659258262953346, 0.25881904507913467, 0.0);
}

std::vector<Frame> shippedFrames() {
  rosbag::Bag bag(kPackage + "/bags/paper.bag");
  rosbag::View view(bag, rosbag::TopicQuery("/camera/image/compressed"));
  std::vector<Frame> frames;
  for (const rosbag::MessageInstance& message : view) {
    const auto image = message.instantiate<sensor_msgs::CompressedImage>();
    frames.push_back({image->header.stamp.toSec(), cv::imdecode(image->data, cv::IMREAD_GRAYSCALE),
                      mounting(), std::nullopt});
  }
  return frames;
}

Pose2 firstPose() {
  std::ifstream file(kPackage + "/bags/paper.tum");
  double stamp = 0.0;
  double z = 0.0;
  Eigen::Quaterniond q;
  Pose2 pose;
  file >> stamp >> pose.x >> pose.y >> z >> q.x() >> q.y() >> q.z() >> q.w();
  pose.yaw = 2.0 * std::atan2(q.z(), q.w());
  return pose;
}

void localizeSequence(benchmark::State& state, EstimatorKind kind) {
  const std::vector<Frame> frames = shippedFrames();
  const auto camera = loadCamera(kPackage + "/config/cameras/paper.yaml");
  const MarkerMap map = loadMarkerMap(kPackage + "/maps/paper.yaml");
  LocalizerConfig config;
  config.estimation.kind = kind;
  Timings sum;
  std::vector<double> totals;
  int markers = 0;
  for ([[maybe_unused]] auto _ : state) {
    Localizer localizer(camera, map, config);
    localizer.setPose(firstPose());
    for (const Frame& frame : frames) {
      const FrameResult result = localizer.process(frame);
      sum.predict += result.timings.predict;
      sum.warp += result.timings.warp;
      sum.decode += result.timings.decode;
      sum.solve += result.timings.solve;
      totals.push_back(result.timings.total);
      markers += result.acceptedMarkers();
    }
  }
  std::sort(totals.begin(), totals.end());
  const auto count = static_cast<double>(totals.size());
  const auto quantile = [&totals, count](double share) {
    return 1e3 * totals[static_cast<std::size_t>(share * (count - 1.0))];
  };
  state.counters["predict_ms"] = 1e3 * sum.predict / count;
  state.counters["warp_ms"] = 1e3 * sum.warp / count;
  state.counters["decode_ms"] = 1e3 * sum.decode / count;
  state.counters["solve_ms"] = 1e3 * sum.solve / count;
  state.counters["total_ms_median"] = quantile(0.5);
  state.counters["total_ms_99th"] = quantile(0.99);
  state.counters["markers"] = markers / count;
}

void loadFiles(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) {
    Localizer localizer(loadCamera(kPackage + "/config/cameras/paper.yaml"),
                        loadMarkerMap(kPackage + "/maps/paper.yaml"), {});
    benchmark::DoNotOptimize(&localizer);
  }
}

BENCHMARK_CAPTURE(localizeSequence, reprojection, EstimatorKind::kReprojection)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(localizeSequence, triangulation, EstimatorKind::kTriangulation)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(loadFiles)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace omnitag

BENCHMARK_MAIN();
