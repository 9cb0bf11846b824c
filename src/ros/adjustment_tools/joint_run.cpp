#include "ros/adjustment_tools/joint_run.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <utility>

#include "adjustment/place_constraint.h"
#include "adjustment/reading_alignment.h"
#include "adjustment/timed_calibration.h"
#include "marker/tag_pattern.h"
#include "omnitag/camera/camera_file.h"
#include "ros/adjustment_tools/step_log.h"

namespace omnitag {
namespace {

/// Of a marker; their residuals follow each other.
constexpr std::size_t kCorners = 4;

/// Prints a line for every step of a calibration.
CalibrationProgress calibrationLog() {
  return [log = std::make_shared<StepLog>("calibrating")](const std::string& step,
                                                          int /*iteration*/) { log->show(step); };
}

/// The configuration for placing markers with a camera that is only roughly known.
MapBuilderConfig roughly(MapBuilderConfig config) {
  config.corner_noise = 3.0;
  config.looks_for_contradictions = false;
  config.max_residual = 15.0;
  config.max_position_deviation = 0.5;
  config.max_orientation_deviation = radians(20.0);
  config.min_parallax = radians(5.0);
  return config;
}

class JointRun {
 public:
  JointRun(const JointRequest& request, Drive* drive)
      : request_(request), drive_(*drive), config_(request.calibration), map_(request.seed) {
    if (request.estimates_times) odometry_ = drive_.odometry();
  }

  JointResult run() {
    // In the views, a wrong camera bends the edges of markers.
    findRoughly();
    find("images again, with the camera found", {});
    // With the camera known this well, all pixels of a marker determine its corners.
    const TagPatterns patterns(map_);
    const MountedCamera found(result_.model(request_.guess), result_.camera.base_from_camera);
    const std::optional<TimeCalibration> time = result_.time;
    const MarkerMap map = map_;
    // Then, a corner that is off by as much as decoded ones is an outlier: a shadow, something in
    // the way.
    constexpr double kAlignedWidth = 0.05;  // pixels
    config_.robust_width = kAlignedWidth;
    find("images once more, by all pixels", [&](const cv::Mat& image, double stamp,
                                                std::vector<MarkerReading> readings) {
      const MountedCamera then = time ? cameraAt(found, *time, odometry_, motion(), stamp) : found;
      const PosePrior standing = config_.is_free ? PosePrior{} : PosePrior::upright();
      return alignReadings(image, map, patterns, then, standing, std::move(readings));
    });
    fillMap();
    return std::move(result_);
  }

 private:
  const MotionModelConfig& motion() const { return drive_.parameters().localizer.motion; }

  void findRoughly() {
    CalibrationConfig rough = config_;
    rough.is_rough = true;
    if (request_.estimates_times) rough.max_residual = kMaxRollingResidual;
    const std::string& origin = request_.guess.origin();
    const auto camera = request_.guess.camera(valuesOf(request_.guess.parameters()));
    const auto frames = drive_.read(camera, origin, "images, with the guess");
    for (const Marker& marker : map_.markers) {
      config_.priors.emplace_back(PlacePrior::surveyed(marker));
    }
    placeUnknown(camera, frames, roughly(request_.growth), map_);
    rough.priors = config_.priors;
    rough.constraints = config_.constraints;
    result_.camera = calibrateCamera(request_.guess, map_, frames, rough, calibrationLog());
    takeMap();
  }

  bool hasUnknown(const std::vector<FrameReadings>& frames) const {
    return std::any_of(frames.begin(), frames.end(), [this](const FrameReadings& frame) {
      return std::any_of(frame.readings.begin(), frame.readings.end(),
                         [this](const MarkerReading& reading) {
                           return entriesOf(map_, reading.family, reading.id).empty();
                         });
    });
  }

  /// Gives a first place to markers that were read but are not in the map. Without a map, one of
  /// them is the reference.
  void placeUnknown(const std::shared_ptr<const CameraModel>& camera,
                    const std::vector<FrameReadings>& frames, const MapBuilderConfig& growth,
                    const MarkerMap& seed) {
    if (growth.size > 0.0 && hasUnknown(frames)) {
      std::cerr << "placing unknown markers\n";
      const BuiltMap built = buildMap(camera, frames, seed, growth);
      result_.map.remarks = built.remarks;
      for (std::size_t i = seed.markers.size(); i < built.markers.size(); ++i) {
        const Marker& marker = built.markers[i].marker;
        map_.markers.push_back(marker);
        config_.priors.push_back(built.reference == i ? std::optional(PlacePrior::gauge(marker))
                                                      : std::nullopt);
      }
    }
    config_.constraints.clear();
    for (const MapConstraint& constraint : request_.growth.constraints) {
      const auto of_these = resolved(constraint, map_.markers);
      if (of_these) config_.constraints.push_back(*of_these);
    }
  }

  /// Places markers that were not found with the guess, using the camera and the markers found.
  void placeMissing(std::vector<FrameReadings> frames) {
    if (!(request_.growth.size > 0.0)) return;
    for (FrameReadings& frame : frames) frame.base_from_camera = result_.camera.base_from_camera;
    MarkerMap seed = map_;
    for (Marker& marker : seed.markers) {
      marker.deviation = 0.0;
      marker.orientation_deviation = 0.0;
    }
    try {
      placeUnknown(result_.model(request_.guess), frames, request_.growth, seed);
    } catch (const DegenerateRecording& error) {
      result_.map.remarks = {error.what()};
    }
  }

  void find(const char* what, const Drive::Refinement& refine) {
    const auto frames =
        drive_.read(result_.model(request_.guess), request_.guess.origin(), what, refine);
    if (!refine) placeMissing(frames);
    if (request_.estimates_times) {
      TimedCalibration found = calibrateCameraAndTime(request_.guess, map_, frames, config_,
                                                      odometry_, motion(), calibrationLog());
      result_.camera = std::move(found.camera);
      result_.time = std::move(found.time);
    } else {
      result_.camera = calibrateCamera(request_.guess, map_, frames, config_, calibrationLog());
    }
    takeMap();
  }

  /// The next step looks for the markers where they were found; their priors stay.
  void takeMap() { map_.markers = result_.camera.markers_found; }

  /// For each marker, the images in which it was read and is in sight; without corners.
  std::vector<std::vector<MarkerSighting>> sightingsOfMarkers() const {
    const CalibrationResult& camera = result_.camera;
    std::vector<std::vector<MarkerSighting>> sightings(map_.markers.size());
    for (std::size_t i = 0; i < camera.residuals.size(); i += kCorners) {
      const CornerResidual& first = camera.residuals[i];
      if (!first.residual) continue;
      MarkerSighting sighting;
      sighting.corners.fill(Eigen::Vector2d::Zero());
      sighting.stamp = camera.stamps[first.frame];
      sighting.base_from_camera = camera.base_from_camera;
      sighting.map_from_base.pose = camera.trajectory[first.frame];
      sightings[first.landmark].push_back(sighting);
    }
    return sightings;
  }

  void fillMap() {
    const CalibrationResult& camera = result_.camera;
    const auto sightings = sightingsOfMarkers();
    std::vector<std::size_t> corners(map_.markers.size());
    std::vector<double> squares(map_.markers.size());
    for (const CornerResidual& corner : camera.residuals) {
      if (!corner.residual) continue;
      ++corners[corner.landmark];
      squares[corner.landmark] += corner.residual->squaredNorm();
    }
    for (std::size_t i = 0; i < map_.markers.size(); ++i) {
      BuiltMarker built;
      built.marker = map_.markers[i];
      built.is_seed = i < request_.seed.markers.size();
      built.is_exact = config_.priors[i] && config_.priors[i]->isExact();
      built.covariance = camera.marker_covariances[i];
      built.sightings = corners[i] / kCorners;
      if (built.is_seed) built.survey = config_.priors[i];
      built.seen = seenFrom(built.marker.center(), sightings[i]);
      if (corners[i] > 0) built.residual = std::sqrt(squares[i] / static_cast<double>(corners[i]));
      result_.map.markers.push_back(built);
    }
    result_.map.trajectory = camera.trajectory;
    result_.map.stamps = camera.stamps;
    result_.map.residuals = camera.residuals;
    result_.map.images = camera.frames;
  }

  const JointRequest& request_;
  Drive& drive_;
  CalibrationConfig config_;
  MarkerMap map_;
  OdometryAt odometry_;
  JointResult result_;
};

}  // namespace

std::shared_ptr<const CameraModel> JointResult::model(const CameraTemplate& guess) const {
  return parseCamera(guess.text(camera.camera_values, camera.rim_radius), guess.origin());
}

JointResult runJointly(const JointRequest& request, Drive* drive) {
  return JointRun(request, drive).run();
}

}  // namespace omnitag
