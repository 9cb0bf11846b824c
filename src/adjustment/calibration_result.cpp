#include "adjustment/calibration_result.h"

#include <algorithm>

#include "adjustment/calibration_report.h"
#include "adjustment/field_coverage.h"
#include "adjustment/observability.h"
#include "adjustment/outliers.h"
#include "adjustment/recording.h"
#include "adjustment/remaining_uncertainty.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

void refuseIfBad(const ResidualSummary& after, double max_residual) {
  constexpr double kMostCorners = 0.7;
  const auto all = static_cast<double>(after.counted + after.left_out);
  if (after.rms <= max_residual && static_cast<double>(after.counted) >= kMostCorners * all) return;
  throw InputError(
      "no camera of this kind explains the images: " + std::to_string(after.left_out) + " of " +
      std::to_string(after.counted + after.left_out) + " corners are far off, the others by " +
      decimals(after.rms, 2) +
      " px (RMS); look at the map (positions, sizes), at the guess's model and at the mounting");
}

std::vector<CalibratedParameter> parametersOf(const CalibrationOutcome& outcome,
                                              const ParameterUncertainty& uncertainty) {
  std::vector<CalibratedParameter> parameters;
  for (std::size_t i = 0; i < outcome.fit.model().parameters().size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    CalibratedParameter parameter{outcome.fit.model().parameters()[i],
                                  outcome.fit.bundle.values(index), 0.0, outcome.why_held[i]};
    const auto found = std::find(outcome.observed.begin(), outcome.observed.end(), index);
    if (found != outcome.observed.end()) {
      parameter.deviation = uncertainty.deviations(found - outcome.observed.begin());
    }
    parameters.push_back(parameter);
  }
  return parameters;
}

/// The camera's random uncertainty, given its mounting: the lean of the robot, and so of the
/// camera, is estimated in each image anyway. Without errors common to all corners, which do not
/// propagate through the parameters as random ones do.
ParameterUncertainty uncertaintyOfCameraAlone(const CalibrationModel& model,
                                              const std::vector<Eigen::Index>& observed,
                                              const Eigen::MatrixXd& information) {
  // The mounting's parameters are the last.
  const auto end = std::find_if(observed.begin(), observed.end(),
                                [&model](Eigen::Index index) { return model.isOfMounting(index); });
  const std::vector<Eigen::Index> camera(observed.begin(), end);
  const auto size = static_cast<Eigen::Index>(camera.size());
  return uncertaintyOf(model, camera, {information.topLeftCorner(size, size)});
}

/// Adds a line about each marker that hangs far from its place in the map.
void addMoved(const Bundle& bundle, std::vector<std::string>* remarks) {
  constexpr double kFar = 5.0;  // deviations
  for (const Bundle::Landmark& landmark : bundle.landmarks) {
    if (!landmark.prior || landmark.prior->isExact()) continue;
    const double way =
        (landmark.marker.center() - landmark.prior->map_from_marker.translation()).norm();
    if (!(way > kFar * landmark.prior->deviations.head<3>().maxCoeff())) continue;
    remarks->push_back(omnitag::nameOf(landmark.marker) + " hangs " + decimals(way, 3) +
                       " m from where the map has it, more than its deviation lets expect");
  }
}

}  // namespace

CameraInformation withCommonError(CameraInformation information) {
  // Pixels: apparent displacement of the edges of blurred markers.
  constexpr double kCommonError = 0.01;
  information.common_error = kCommonError;
  return information;
}

CalibrationResult resultOf(const CalibrationOutcome& outcome, const ResidualSummary& before,
                           const CalibrationConfig& config) {
  const Bundle& bundle = outcome.fit.bundle;
  const CalibrationModel& model = *bundle.model;
  const BundleInformation all = outcome.fit.information(outcome.observed);
  const CameraInformation information =
      withCommonError({all.camera, all.common_error_gradient, 0.0});
  const ParameterUncertainty uncertainty = uncertaintyOf(model, outcome.observed, information);

  CalibrationResult result;
  result.residuals = cornerResiduals(bundle);
  result.before = before;
  result.after = summarize(result.residuals);
  refuseIfBad(result.after, config.max_residual);
  result.parameters = parametersOf(outcome, uncertainty);
  result.camera_values = model.cameraValues(bundle.values);
  result.base_from_camera = model.baseFromCamera(bundle.values);
  result.uncertainty = remainingUncertainty(
      model, bundle.values, uncertaintyOfCameraAlone(model, outcome.observed, information.matrix),
      information.common_error);
  result.noise = all.noise;
  result.frames = bundle.frames.size();
  for (const Bundle::Frame& frame : bundle.frames) {
    result.trajectory.push_back(frame.map_from_base);
    result.stamps.push_back(frame.stamp);
  }
  std::vector<std::size_t> counts(bundle.landmarks.size());
  for (const Bundle::Observation& each : bundle.observations) ++counts[each.landmark];
  for (std::size_t i = 0; i < counts.size(); ++i) {
    result.markers += counts[i] > 0 ? 1 : 0;
    result.markers_found.push_back(bundle.landmarks[i].marker);
    result.marker_covariances.emplace_back(alikeFactor(counts[i]) * all.landmarks_within[i]);
  }
  result.placement = all.placement;
  result.rim_radius = rimOf(model.camera(), result);
  result.remarks = outcome.fit.remarks;
  std::vector<Eigen::Vector2d> corners;
  for (const CornerResidual& corner : result.residuals) corners.push_back(corner.pixel);
  result.remarks.push_back(describe(fieldCoverage(model.mounted(bundle.values).model(), corners)));
  addMoved(bundle, &result.remarks);
  for (const PlaceConstraint& constraint : bundle.constraints) {
    const auto words = contradiction(constraint, result.markers_found);
    if (words) result.remarks.push_back(*words);
  }
  addTradeOffs(model, uncertainty, &result.remarks);
  addLean(result.parameters, result.base_from_camera, &result.remarks);
  return result;
}

}  // namespace omnitag
