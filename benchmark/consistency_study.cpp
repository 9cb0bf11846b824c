// Whether the covariance is true: the normalised estimation error squared (NEES) over independent
// frames in good and in bad geometry. Each frame starts from a prediction that is as wrong as its
// own covariance says; markers that a row does not ask for are painted over. In the last table the
// world differs from the files, anew in each frame: the robot leans, markers hang elsewhere, the
// camera is another.
//
// Beside the errors of the last table stands their limit, the Cramer-Rao bound of the position (RMS
// over the row's frames), and by how many times the errors exceed it. It is that of the pixels of
// all markers in sight, as limit_study has them, and of those that the localizer used besides
// though a shadow runs across them, with the noise that the renderer puts on edges. Unknown are the
// six numbers of the pose, the six modes of the camera, each marker's place and orientation, and
// the light on each marker. Of these is known beforehand what the estimator is told, whatever the
// world is in that row:
//
//   x, y, yaw        the prediction, with the deviations that it is drawn with
//   z, roll, pitch   upright on the floor, with the deviations of a LocalizerConfig at the start
//   camera           the deviations that its file states, in all six modes
//   markers          the deviations that the map states, along and about each axis
//
// So the limit is that of worlds that are drawn as stated. Errors may be smaller where a row's
// world is off by less (a camera whose mirror and lens stand straight has no error in the modes
// tilt and rim) and exceed it by any amount where it is off by more. The estimator's own allowances
// for what displaces single markers (alignment_deviation, the camera's uncertainty beside its
// modes) do not occur in rendered worlds, and are no part of the limit.
//
//   consistency_study [BAG CAMERA MAP [NOISE SAMPLES]]
//
// a bag of render_sequence, the shipped one by default, with the NOISE and SAMPLES that it was
// rendered with (see limit_study; 3 and 4 by default).

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "disturbances.h"
#include "frame_limit.h"
#include "localization/motion_model.h"
#include "masking.h"
#include "omnitag/localization/localizer.h"
#include "prediction.h"
#include "program.h"
#include "recorded_sequence.h"

namespace omnitag {
namespace {

/// Chooses among the markers that were read in a frame (indices of FrameResult::predicted).
using Choice = std::function<std::vector<std::size_t>(
    const RecordedSequence&, const FrameResult&, const Pose&, const std::vector<std::size_t>&)>;

double bearingOf(const RecordedSequence& sequence, const FrameResult& seen, const Pose& truth,
                 std::size_t index) {
  const Eigen::Vector3d center = sequence.map.markers[seen.predicted[index].map_entry].center();
  return std::atan2(center.y() - truth.y, center.x() - truth.x);
}

std::vector<std::size_t> all(const RecordedSequence& /*sequence*/, const FrameResult& /*seen*/,
                             const Pose& /*truth*/, const std::vector<std::size_t>& readable) {
  return readable.size() >= 4 ? readable : std::vector<std::size_t>();
}

/// Those within 100 degrees, three at least.
std::vector<std::size_t> onOneSide(const RecordedSequence& sequence, const FrameResult& seen,
                                   const Pose& truth, const std::vector<std::size_t>& readable) {
  for (const std::size_t first : readable) {
    std::vector<std::size_t> side;
    for (const std::size_t index : readable) {
      const double offset = normalizeAngle(bearingOf(sequence, seen, truth, index) -
                                           bearingOf(sequence, seen, truth, first));
      if (offset >= 0.0 && offset < radians(100.0)) side.push_back(index);
    }
    if (side.size() >= 3) return side;
  }
  return {};
}

/// The three markers whose circle the robot is nearest to, where bearings alone tell least.
std::vector<std::size_t> onACircle(const RecordedSequence& sequence, const FrameResult& seen,
                                   const Pose& truth, const std::vector<std::size_t>& readable) {
  const auto place = [&](std::size_t i) -> Eigen::Vector2d {
    return sequence.map.markers[seen.predicted[i].map_entry].center().head<2>();
  };
  std::vector<std::size_t> best;
  double nearest = 0.1;  // of the circle's radius
  for (std::size_t i = 0; i < readable.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const Eigen::Vector2d a = place(readable[i]);
        const Eigen::Vector2d b = place(readable[j]) - a;
        const Eigen::Vector2d c = place(readable[k]) - a;
        const double cross = 2.0 * (b.x() * c.y() - b.y() * c.x());
        if (std::abs(cross) < 1e-3) continue;
        const Eigen::Vector2d center(
            a.x() + (c.y() * b.squaredNorm() - b.y() * c.squaredNorm()) / cross,
            a.y() + (b.x() * c.squaredNorm() - c.x() * b.squaredNorm()) / cross);
        const double radius = (center - a).norm();
        const double off =
            std::abs((center - Eigen::Vector2d(truth.x, truth.y)).norm() / radius - 1.0);
        if (off >= nearest) continue;
        nearest = off;
        best = {readable[i], readable[j], readable[k]};
      }
    }
  }
  return best;
}

template <std::size_t kCount>
std::vector<std::size_t> some(const RecordedSequence& /*sequence*/, const FrameResult& /*seen*/,
                              const Pose& truth, std::vector<std::size_t> readable) {
  if (readable.size() < kCount) return {};
  std::mt19937 generator(static_cast<unsigned>(std::abs(truth.x) * 1e6));
  std::shuffle(readable.begin(), readable.end(), generator);
  readable.resize(kCount);
  return readable;
}

/// m and rad, standard deviations of a rough prediction.
constexpr double kPositionDeviation = 0.1;
constexpr double kHeadingDeviation = radians(4.0);

/// A rough prediction, as wrong as it says.
PoseEstimate roughPrediction(const Pose& truth, std::mt19937* generator) {
  return drawnPrediction(truth, kPositionDeviation, kHeadingDeviation, generator);
}

/// What a localizer with such a prediction knows of a frame's pose, about the truth.
PosePrior knownOf(const Pose& truth) {
  const Eigen::Vector3d deviations(kPositionDeviation, kPositionDeviation, kHeadingDeviation);
  return MotionModel(LocalizerConfig().motion)
      .standing(std::nullopt)
      .withPlace(truth, deviations.cwiseAbs2().cwiseInverse().asDiagonal());
}

/// Entries of the map.
std::set<std::size_t> usedIn(const FrameResult& result) {
  std::set<std::size_t> used;
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) used.insert(*detection.map_entry);
  }
  return used;
}

/// What a row of the tables sums up.
class Row {
 public:
  /// `limit`: m^2, the least variance that the position may have, where it is known.
  void add(const FrameResult& result, const Pose& truth, double limit = 0.0) {
    markers_ += result.acceptedMarkers();
    if (!result.map_from_base || result.mode != Mode::kTracking) {
      ++without_;
      return;
    }
    const Eigen::Vector3d error = difference(result.map_from_base->pose, truth).head<3>();
    const Eigen::Matrix3d covariance = floorCovariance(*result.map_from_base);
    const double nees = error.dot(covariance.inverse() * error);
    nees_ += nees;
    squares_ += error.head<2>().squaredNorm();
    stated_ += covariance.topLeftCorner<2, 2>().trace();
    limit_ += limit;
    outside_ += nees > 16.27 ? 1 : 0;
    ++count_;
  }

  static void printTitle(const char* kind, bool has_limit) {
    std::printf("%-32s %6s %9s %8s %7s   %12s %10s %13s %12s", kind, "frames", "untracked",
                "markers", "NEES", "95 % bounds", "beyond .999", "RMSE", "stated");
    if (has_limit) std::printf(" %12s %12s", "limit", "RMSE / limit");
    std::printf("\n");
  }

  void print(const std::string& name) const {
    const int count = std::max(count_, 1);
    const double bound = 1.96 * std::sqrt(6.0 / count);
    std::printf("%-32s %6d %9d %8.2f %7.2f   %.2f to %.2f %10d %10.3f mm %9.3f mm", name.c_str(),
                count_, without_, 1.0 * markers_ / std::max(count_ + without_, 1), nees_ / count,
                3.0 - bound, 3.0 + bound, outside_, 1e3 * std::sqrt(squares_ / count),
                1e3 * std::sqrt(stated_ / count));
    if (limit_ > 0.0) {
      std::printf(" %9.3f mm %12.2f", 1e3 * std::sqrt(limit_ / count),
                  std::sqrt(squares_ / limit_));
    }
    std::printf("\n");
    std::fflush(stdout);
  }

 private:
  double nees_ = 0.0;
  double squares_ = 0.0;
  double stated_ = 0.0;
  double limit_ = 0.0;
  int count_ = 0;
  int outside_ = 0;
  int without_ = 0;
  int markers_ = 0;
};

void studyGeometry(const char* name, const RecordedSequence& sequence,
                   const std::vector<FrameResult>& at_truth, const Choice& choose,
                   EstimatorKind kind) {
  std::mt19937 generator(3);
  LocalizerConfig config;
  config.estimation.kind = kind;
  Row row;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const Pose& truth = sequence.truth[i];
    const FrameResult& seen = at_truth[i];
    const std::vector<std::size_t> chosen = choose(sequence, seen, truth, readableMarkers(seen));
    if (chosen.empty()) continue;
    Frame frame = sequence.frames[i];
    frame.image = withOnly(chosen, seen, frame.image);
    Localizer localizer(sequence.camera, sequence.map, config);
    localizer.setPose(roughPrediction(truth, &generator));
    row.add(localizer.process(frame), truth);
  }
  row.print(name);
}

void studyDisturbance(const Disturbance& disturbance, const RecordedSequence& sequence,
                      const std::string& camera_file, const Rendering& rendering) {
  const auto true_camera = trueCamera(disturbance, *sequence.camera, camera_file);
  constexpr std::size_t kFrames = 200;
  std::mt19937 generator(5);
  Row row;
  for (std::size_t i = 0; i < std::max(kFrames, sequence.frames.size()); ++i) {
    const DisturbedFrame drawn =
        disturbed(disturbance, sequence, camera_file, i % sequence.frames.size(), &generator);
    Localizer localizer(drawn.camera, drawn.map, LocalizerConfig());
    localizer.setPose(roughPrediction(drawn.truth, &generator));
    const FrameResult result = localizer.process(drawn.frame);
    const MountedCamera camera(true_camera, drawn.frame.base_from_camera);
    const Informations in_sight = markersInSight(drawn.frame.image, camera, sequence.map,
                                                 drawn.truth, rendering, usedIn(result));
    const FrameMatrix least =
        leastCovariance(in_sight, drawn.map, drawn.truth, knownOf(drawn.truth));
    row.add(result, drawn.truth, least.topLeftCorner<2, 2>().trace());
  }
  row.print(disturbance.name);
}

void run(const RecordedSequence& sequence, const std::string& camera_file,
         const Rendering& rendering) {
  std::vector<FrameResult> at_truth;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    at_truth.push_back(lookAtTruth(sequence, i));
  }
  for (const EstimatorKind kind : {EstimatorKind::kPhotometric, EstimatorKind::kReprojection}) {
    Row::printTitle(kind == EstimatorKind::kPhotometric ? "photometric" : "reprojection", false);
    studyGeometry("four or more", sequence, at_truth, all, kind);
    studyGeometry("three, one side", sequence, at_truth, onOneSide, kind);
    studyGeometry("three, near a circle", sequence, at_truth, onACircle, kind);
    studyGeometry("two", sequence, at_truth, some<2>, kind);
    studyGeometry("one", sequence, at_truth, some<1>, kind);
  }
  Row::printTitle("disturbed", true);
  for (const Disturbance& disturbance : disturbances()) {
    studyDisturbance(disturbance, sequence, camera_file, rendering);
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("consistency_study", [&] {
    constexpr int kWithRendering = 6;
    const bool says_rendering = argc == kWithRendering;
    omnitag::run(omnitag::sequenceFrom(says_rendering ? argc - 2 : argc, argv),
                 omnitag::cameraFileFrom(argc, argv),
                 says_rendering ? omnitag::renderingFrom(argv[argc - 2], argv[argc - 1])
                                : omnitag::Rendering());
    return 0;
  });
}
