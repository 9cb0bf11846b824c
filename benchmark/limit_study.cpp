// How near the estimators come to the limit that the noise of the pixels sets. Beside the errors of
// each estimator:
//
//   limit    the Cramer-Rao bound of all mapped markers in sight that the tracker would look for
//            (VisibilityConfig): (x, y, yaw) from their pixels, the light on each being unknown,
//            the map, the camera and how the robot stands being exact.
//            Markers that something hides, so that their pixels do not correlate with the pattern,
//            do not count.
//   of used  the same of the markers that the estimator used
//   sampled  the limit with the noise that the renderer puts on edges, as it takes the mean of
//            SAMPLES x SAMPLES rays for a pixel on an edge (see render_sequence --samples)
//   Eqn 15   the paper's, for corners that are off by a pixel: sqrt(2) / horizon radius *
//            mean range
//
// `from the truth` is what knows the truth and takes one step from there to the pose that the exact
// model of the pixels makes most likely; it leaves out markers whose pixels contradict the truth.
// On images that are nothing but that model and noise its error is the limit; what it has more is
// what the images are off: sampling, shadows across a marker, saturated pixels.
//
// The position error is the RMS of its length; limits are their RMS over the same frames. Each
// frame starts from a prediction that is off by 2 cm and 0.5 degrees (standard deviations).
//
//   limit_study NOISE SAMPLES [BAG CAMERA MAP] [--frames]
//
// NOISE is the standard deviation of the image noise in grey levels, before rounding, which adds
// its 1/12; the bag is one of render_sequence, the shipped one (3 4) by default. --frames prints
// every frame, too.

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "frame_limit.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "prediction.h"
#include "program.h"
#include "recorded_sequence.h"
#include "visible_markers.h"

namespace omnitag {
namespace {

struct Options {
  Rendering rendering;
  bool prints_frames = false;
};

/// Squares: of the position's error and of the heading's, m^2 and rad^2.
struct Squares {
  double position = 0.0;
  double heading = 0.0;

  void operator+=(const Squares& other) {
    position += other.position;
    heading += other.heading;
  }
};

Squares squaresOf(const Eigen::Matrix3d& covariance) {
  return {covariance.topLeftCorner<2, 2>().trace(), covariance(2, 2)};
}

Squares squaresOf(const Eigen::Vector3d& error) {
  return {error.head<2>().squaredNorm(), error.z() * error.z()};
}

/// Nothing where the markers do not determine the pose.
std::optional<Squares> limitOf(const Eigen::Matrix3d& information) {
  const Eigen::FullPivLU<Eigen::Matrix3d> decomposition(information);
  if (!decomposition.isInvertible()) return std::nullopt;
  return squaresOf(Eigen::Matrix3d(decomposition.inverse()));
}

struct Row {
  int frames = 0;
  int without = 0;
  double used = 0.0;
  double in_sight = 0.0;
  double range = 0.0;
  Squares error;
  Squares limit;
  Squares limit_of_used;
  Squares sampled_limit;
};

/// Of (x, y, yaw), all else of the frame's unknowns being known.
Eigen::Matrix3d ofPose(const FrameEquations& equations) {
  return equations.information.topLeftCorner<3, 3>();
}

struct Sums {
  Eigen::Matrix3d exact = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sampled_times_step = Eigen::Vector3d::Zero();
};

Sums sumOf(const Informations& in_sight) {
  Sums sums;
  for (const auto& [entry, information] : in_sight) {
    sums.exact += ofPose(information.exact);
    sums.sampled += ofPose(information.sampled);
    sums.sampled_times_step += information.sampled.gradient.head<3>();
  }
  return sums;
}

/// What knows the truth and steps from there to what the pixels of the markers in sight make most
/// likely. Markers that contradict the truth are left out, as something must be wrong with them.
Row rowAtTruth(const Informations& in_sight) {
  // Of 250,000 that are right it leaves one out (chi-square with 3 degrees of freedom).
  constexpr double kChiSquareLimit = 27.9;
  const Sums all = sumOf(in_sight);
  Informations right;
  for (const auto& [entry, information] : in_sight) {
    const Eigen::Vector3d times_step = information.sampled.gradient.head<3>();
    const Eigen::Vector3d step = ofPose(information.sampled).ldlt().solve(times_step);
    if (step.dot(times_step) < kChiSquareLimit) right[entry] = information;
  }
  const Sums used = sumOf(right);
  Row row;
  row.without = 1;
  const std::optional<Squares> limit = limitOf(all.exact);
  const std::optional<Squares> limit_of_used = limitOf(used.exact);
  const std::optional<Squares> sampled_limit = limitOf(all.sampled);
  if (!limit || !limit_of_used || !sampled_limit) return row;
  row.without = 0;
  row.frames = 1;
  row.used = static_cast<double>(right.size());
  row.in_sight = static_cast<double>(in_sight.size());
  row.error = squaresOf(Eigen::Vector3d(used.sampled.ldlt().solve(used.sampled_times_step)));
  row.limit = *limit;
  row.limit_of_used = *limit_of_used;
  row.sampled_limit = *sampled_limit;
  return row;
}

/// One frame's share; counts as `without` where the estimator or a limit has no pose.
Row rowOf(const FrameResult& result, const Pose& truth, const Informations& in_sight) {
  Row row;
  row.without = 1;
  Eigen::Matrix3d used = Eigen::Matrix3d::Zero();
  double ranges = 0.0;
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    row.used += 1.0;
    ranges += detection.range;
    const auto known = in_sight.find(*detection.map_entry);
    if (known != in_sight.end()) used += ofPose(known->second.exact);
  }
  const Sums all = sumOf(in_sight);
  const std::optional<Squares> limit = limitOf(all.exact);
  const std::optional<Squares> limit_of_used = limitOf(used);
  const std::optional<Squares> sampled_limit = limitOf(all.sampled);
  if (!result.map_from_base || result.mode != Mode::kTracking || !limit || !limit_of_used ||
      !sampled_limit) {
    return row;
  }
  row.without = 0;
  row.frames = 1;
  row.in_sight = static_cast<double>(in_sight.size());
  row.range = ranges / row.used;
  row.error = squaresOf(Eigen::Vector3d(difference(result.map_from_base->pose, truth).head<3>()));
  row.limit = *limit;
  row.limit_of_used = *limit_of_used;
  row.sampled_limit = *sampled_limit;
  return row;
}

void add(const Row& row, Row* sum) {
  sum->without += row.without;
  if (row.frames == 0) return;
  sum->frames += row.frames;
  sum->used += row.used;
  sum->in_sight += row.in_sight;
  sum->range += row.range;
  sum->error += row.error;
  sum->limit += row.limit;
  sum->limit_of_used += row.limit_of_used;
  sum->sampled_limit += row.sampled_limit;
}

/// Radius in pixels at which the horizon images.
double horizonRadius(const CameraModel& camera) {
  constexpr double kFar = 1e4;
  const std::optional<RadialImage> image = camera.imageFromPoint(kFar, 0.0);
  if (!image) throw InputError("the camera does not see the horizon");
  return image->radius * camera.imagePlane().scale();
}

void print(const std::string& name, const Row& row, double horizon) {
  const double count = std::max(row.frames, 1);
  const auto position = [count](const Squares& squares) {
    return 1e3 * std::sqrt(squares.position / count);
  };
  const auto heading = [count](const Squares& squares) {
    return degrees(std::sqrt(squares.heading / count));
  };
  const double range = row.range / count;
  std::printf("%-14s %6d %7d %5.1f %5.1f | %8.4f %8.5f | %8.4f %8.4f %8.4f %8.2f | %6.2f %7.2f",
              name.c_str(), row.frames, row.without, row.used / count, row.in_sight / count,
              position(row.error), range > 0.0 ? 1e-1 * position(row.error) / range : 0.0,
              position(row.limit), position(row.limit_of_used), position(row.sampled_limit),
              1e3 * std::sqrt(2.0) / horizon * range, position(row.error) / position(row.limit),
              position(row.error) / position(row.sampled_limit));
  std::printf(" | %8.5f %8.5f %8.5f | %6.2f %7.2f\n", heading(row.error), heading(row.limit),
              heading(row.sampled_limit), heading(row.error) / heading(row.limit),
              heading(row.error) / heading(row.sampled_limit));
}

void printHeader() {
  std::printf("%-41s | %-17s | %-35s | %-14s | %-26s | %s\n", "", "position error",
              "limits of the position (mm)", "error over", "heading (deg)", "error over");
  std::printf(
      "%-14s %6s %7s %5s %5s | %8s %8s | %8s %8s %8s %8s | %6s %7s | %8s %8s %8s | %6s %7s\n",
      "estimator", "frames", "without", "used", "seen", "mm", "% range", "limit", "of used",
      "sampled", "Eqn 15", "limit", "sampled", "error", "limit", "sampled", "limit", "sampled");
}

void run(const RecordedSequence& sequence, const Options& options) {
  std::vector<Informations> in_sight;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const Frame& frame = sequence.frames[i];
    const MountedCamera camera(sequence.camera, frame.base_from_camera);
    in_sight.push_back(
        markersInSight(frame.image, camera, sequence.map, sequence.truth[i], options.rendering));
  }
  const double horizon = horizonRadius(*sequence.camera);
  printHeader();
  Row at_truth;
  for (const Informations& markers : in_sight) add(rowAtTruth(markers), &at_truth);
  print("from the truth", at_truth, horizon);
  const std::vector<std::pair<const char*, EstimatorKind>> kinds{
      {"triangulation", EstimatorKind::kTriangulation},
      {"reprojection", EstimatorKind::kReprojection},
      {"photometric", EstimatorKind::kPhotometric}};
  for (const auto& [name, kind] : kinds) {
    LocalizerConfig config;
    config.estimation.kind = kind;
    Localizer localizer(sequence.camera, sequence.map, config);
    std::mt19937 generator(1);
    Row sum;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      localizer.setPose(goodPrediction(sequence.truth[i], &generator));
      const Row row = rowOf(localizer.process(sequence.frames[i]), sequence.truth[i], in_sight[i]);
      if (options.prints_frames) print("  " + std::to_string(i), row, horizon);
      add(row, &sum);
    }
    print(name, sum, horizon);
  }
}

int runWith(int argc, char** argv) {
  Options options;
  std::vector<char*> files{argv[0]};
  std::vector<std::string> numbers;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--frames") == 0) {
      options.prints_frames = true;
    } else if (numbers.size() < 2) {
      numbers.emplace_back(argv[i]);
    } else {
      files.push_back(argv[i]);
    }
  }
  if (numbers.size() < 2) throw InputError("expected NOISE SAMPLES [BAG CAMERA MAP] [--frames]");
  options.rendering = renderingFrom(numbers[0], numbers[1]);
  run(sequenceFrom(static_cast<int>(files.size()), files.data()), options);
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("limit_study", [&] { return omnitag::runWith(argc, argv); });
}
