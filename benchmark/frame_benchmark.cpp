// Milliseconds of each step of a frame, on the shipped sequence: predict, warp, decode, solve and
// their total, as means over all frames, with the median and 99th percentile of the total.
//
//   frame_benchmark [Google Benchmark's options]

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"
#include "recorded_sequence.h"
#include "statistics.h"

namespace omnitag {
namespace {

const std::string kPackage = PACKAGE_DIR;

void localizeSequence(benchmark::State& state, EstimatorKind kind) {
  const RecordedSequence sequence = shippedSequence();
  LocalizerConfig config;
  config.estimation.kind = kind;
  Timings sum;
  std::vector<double> totals;
  int markers = 0;
  for ([[maybe_unused]] auto _ : state) {
    Localizer localizer(sequence.camera, sequence.map, config);
    localizer.setPose(sequence.truth.front());
    for (const Frame& frame : sequence.frames) {
      const FrameResult result = localizer.process(frame);
      sum.predict += result.timings.predict;
      sum.recognize += result.timings.recognize;
      sum.warp += result.timings.warp;
      sum.decode += result.timings.decode;
      sum.solve += result.timings.solve;
      totals.push_back(result.timings.total);
      markers += result.acceptedMarkers();
    }
  }
  const auto count = static_cast<double>(totals.size());
  state.counters["predict_ms"] = 1e3 * sum.predict / count;
  state.counters["recognize_ms"] = 1e3 * sum.recognize / count;
  state.counters["warp_ms"] = 1e3 * sum.warp / count;
  state.counters["decode_ms"] = 1e3 * sum.decode / count;
  state.counters["solve_ms"] = 1e3 * sum.solve / count;
  state.counters["total_ms_median"] = 1e3 * quantile(totals, 0.5);
  state.counters["total_ms_99th"] = 1e3 * quantile(totals, 0.99);
  state.counters["markers"] = markers / count;
}

void loadFiles(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) {
    Localizer localizer(loadCamera(kPackage + "/config/cameras/paper.yaml"),
                        loadMarkerMap(kPackage + "/maps/paper.yaml"), {});
    benchmark::DoNotOptimize(&localizer);
  }
}

BENCHMARK_CAPTURE(localizeSequence, photometric, EstimatorKind::kPhotometric)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(localizeSequence, reprojection, EstimatorKind::kReprojection)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(localizeSequence, triangulation, EstimatorKind::kTriangulation)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(loadFiles)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace omnitag

BENCHMARK_MAIN();
