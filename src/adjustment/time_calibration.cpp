#include "adjustment/time_calibration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "adjustment/calibration_data.h"
#include "adjustment/calibration_report.h"
#include "adjustment/moving_frame.h"
#include "adjustment/offset_fit.h"
#include "adjustment/pose_from_bearings.h"
#include "adjustment/readout_fit.h"
#include "localization/reprojection.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// s: a time that the drive does not determine this exactly is held.
constexpr double kTolerable = 0.005;

class TimeCalibrator {
 public:
  TimeCalibrator(const MarkerMap& map, const MountedCamera& camera, const OdometryAt& odometry,
                 const MotionModelConfig& config)
      : map_(map), camera_(camera), odometry_(odometry), config_(config) {}

  TimeCalibration run(const std::vector<FrameReadings>& readings) {
    findPoses(readings);
    fit();
    const EstimatedTime readout = judgedReadout();
    if (!readout.held.empty()) {
      readout_.row_readout_time = 0.0;
      holds_readout_ = true;
      fit();
    }
    TimeCalibration time;
    time.row_readout_time = readout;
    time.image_time_offset = judgedOffset(readout);
    time.middle_row_offset = time.image_time_offset.value + middleRow() * readout.value;
    time.motions = offset_.motions;
    for (const FrameReadings& frame : readings) addAtMiddleRow(frame, &time.at_middle_row);
    return time;
  }

 private:
  double rows() const { return camera_.model().imageSize().height; }
  double middleRow() const { return 0.5 * rows(); }
  bool isOffsetObserved() const { return offset_.deviation <= kTolerable; }

  void findPoses(const std::vector<FrameReadings>& readings) {
    for (CalibrationFrame& seen : selectObservations(map_, readings).frames) {
      const std::optional<Pose> start = poseFromBearings(map_, camera_, seen);
      if (!start) continue;
      // The rows' times are not known yet: the displacements they cause count as the camera's
      // error.
      const auto pose = refineFromAfar(map_, camera_, seen.observations, *start,
                                       PosePrior::upright(), ReprojectionConfig());
      if (!pose) continue;
      MovingFrame frame;
      frame.map_from_base = pose->map_from_base.pose;
      frame.seen = std::move(seen);
      frames_.push_back(std::move(frame));
    }
    if (frames_.empty()) throw InputError("no pose explains what was read in any image");
  }

  void fit() {
    // The velocity at an image depends slightly on the offset.
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      for (MovingFrame& frame : frames_) {
        frame.motion = baseMotionAt(odometry_, frame.seen.stamp + offset_.offset, config_)
                           .value_or(MotionModel(config_).unknownMotion());
      }
      readout_ = fitReadout(map_, camera_, config_, readout_, holds_readout_, &frames_);
      offset_ = fitOffset(frames_, odometry_, config_);
      if (!isOffsetObserved()) offset_.offset = 0.0;
    }
  }

  EstimatedTime judgedReadout() const {
    constexpr double kAgrees = 2.0;  // deviations
    EstimatedTime readout{readout_.row_readout_time, readout_.deviation, "", true};
    if (rows() * readout.deviation > kTolerable) {
      readout.is_observed = false;
      readout.held = "the robot hardly moves while images are taken, +- " +
                     significant(1e3 * rows() * readout.deviation, 2) +
                     " ms of the whole image: turn faster";
    } else if (std::abs(readout.value) <= kAgrees * readout.deviation) {
      readout.held = "as of a global shutter, which fits";
    }
    if (!readout.held.empty()) readout.value = 0.0;
    return readout;
  }

  EstimatedTime judgedOffset(const EstimatedTime& readout) const {
    if (!isOffsetObserved()) return {0.0, offset_.deviation, whyOffsetIsHeld(), false};
    const double by_readout = readout.held.empty() ? middleRow() * readout.deviation : 0.0;
    return {offset_.offset - middleRow() * readout.value, std::hypot(offset_.deviation, by_readout),
            "", true};
  }

  std::string whyOffsetIsHeld() const {
    if (offset_.motions < OffsetFit::kFewestMotions) {
      return "odometry has " + std::to_string(offset_.motions) +
             " motions from image to image, expected at least " +
             std::to_string(OffsetFit::kFewestMotions);
    }
    const std::string deviation = std::isfinite(offset_.deviation)
                                      ? ", +- " + significant(1e3 * offset_.deviation, 2) + " ms"
                                      : "";
    return "the robot hardly changes how it moves" + deviation +
           ": turn left and right, stop and start";
  }

  /// Adds the readings of a frame as if all rows had been exposed at once.
  void addAtMiddleRow(const FrameReadings& readings, std::vector<FrameReadings>* all) const {
    const auto frame = std::find_if(
        frames_.begin(), frames_.end(),
        [&](const MovingFrame& candidate) { return candidate.seen.stamp == readings.stamp; });
    if (frame == frames_.end()) return;
    const MountedCamera rolling =
        cameraInFrame(camera_, *frame, readout_.camera_error, readout_.row_readout_time);
    const MountedCamera global = cameraInFrame(camera_, *frame, readout_.camera_error, 0.0);
    FrameReadings moved = readings;
    moved.readings.clear();
    for (MarkerReading reading : readings.readings) {
      const std::vector<std::size_t> entries = entriesOf(map_, reading.family, reading.id);
      if (entries.size() != 1) continue;
      const Marker& marker = map_.markers[entries.front()];
      const auto move = [&](const Eigen::Vector3d& point, Eigen::Vector2d* pixel) {
        const auto then = rolling.pixelFromMap(frame->map_from_base, point);
        const auto at_once = global.pixelFromMap(frame->map_from_base, point);
        if (!then || !at_once) return false;
        *pixel += *at_once - *then;
        return true;
      };
      const Corners<Eigen::Vector3d> corners = marker.corners();
      bool is_moved = move(marker.center(), &reading.center);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        is_moved = is_moved && move(corners[k], &reading.corners[k]);
      }
      if (is_moved) moved.readings.push_back(std::move(reading));
    }
    all->push_back(std::move(moved));
  }

  const MarkerMap& map_;
  const MountedCamera& camera_;
  const OdometryAt& odometry_;
  const MotionModelConfig& config_;
  std::vector<MovingFrame> frames_;
  bool holds_readout_ = false;
  ReadoutFit readout_;
  OffsetFit offset_;
};

}  // namespace

TimeCalibration calibrateTime(const MarkerMap& map, const MountedCamera& camera,
                              const std::vector<FrameReadings>& frames, const OdometryAt& odometry,
                              const MotionModelConfig& config) {
  return TimeCalibrator(map, camera, odometry, config).run(frames);
}

MountedCamera cameraAt(const MountedCamera& camera, const TimeCalibration& time,
                       const OdometryAt& odometry, const MotionModelConfig& config, double stamp) {
  MovingFrame frame;
  frame.motion = baseMotionAt(odometry, stamp + time.middle_row_offset, config)
                     .value_or(MotionModel(config).unknownMotion());
  return cameraInFrame(camera, frame, ImagingError::Zero(), time.row_readout_time.value);
}

}  // namespace omnitag
