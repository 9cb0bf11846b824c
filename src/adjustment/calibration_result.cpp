#include "calibration_result.h"

#include <algorithm>
#include <map>

#include "calibration_report.h"
#include "omnitag/adjustment/observability.h"
#include "omnitag/common/error.h"
#include "outliers.h"
#include "remaining_uncertainty.h"

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
  for (std::size_t i = 0; i < outcome.model.parameters().size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    CalibratedParameter parameter{outcome.model.parameters()[i], outcome.state.values(index), 0.0,
                                  outcome.why_held[i]};
    const auto found = std::find(outcome.observed.begin(), outcome.observed.end(), index);
    if (found != outcome.observed.end()) {
      parameter.deviation = uncertainty.deviations(found - outcome.observed.begin());
    }
    parameters.push_back(parameter);
  }
  return parameters;
}

}  // namespace

AdjustmentInformation informationAt(const BundleAdjustment& adjustment,
                                    const CalibrationState& state, const AdjustmentConfig& config) {
  // Pixels: where the edges of blurred markers seem to be.
  constexpr double kCommonError = 0.01;
  AdjustmentInformation information = adjustment.information(state, config);
  information.common_error = kCommonError;
  return information;
}

CalibrationResult resultOf(const CalibrationOutcome& outcome, const ResidualSummary& before,
                           const CalibrationConfig& config) {
  AdjustmentConfig adjustment;
  adjustment.robust_width = config.robust_width;
  adjustment.free = outcome.observed;
  const AdjustmentInformation information =
      informationAt(outcome.adjustment, outcome.state, adjustment);
  const ParameterUncertainty uncertainty =
      uncertaintyOf(outcome.model, outcome.observed, information);

  CalibrationResult result;
  result.residuals = outcome.adjustment.residuals(outcome.state);
  result.before = before;
  result.after = summarize(result.residuals);
  refuseIfBad(result.after, config.max_residual);
  result.parameters = parametersOf(outcome, uncertainty);
  result.camera_values = outcome.model.cameraValues(outcome.state.values);
  result.base_from_camera = outcome.model.baseFromCamera(outcome.state.values);
  // What all corners err by alike, parameters do not pass on as they do what chance gives each.
  const ParameterUncertainty by_chance = uncertaintyOf(
      outcome.model, outcome.observed, {information.matrix, information.noise, {}, 0.0});
  result.uncertainty = remainingUncertainty(outcome.model, outcome.state.values, by_chance,
                                            information.common_error);
  result.noise = information.noise;
  result.frames = outcome.data.frames.size();
  std::map<std::size_t, int> markers;
  for (const CornerResidual& corner : result.residuals) ++markers[corner.map_entry];
  result.markers = markers.size();
  result.rim_radius = rimOf(outcome.model.camera(), result);
  result.remarks = outcome.data.remarks;
  addTradeOffs(outcome.model, uncertainty, &result.remarks);
  addLean(result.parameters, result.base_from_camera, &result.remarks);
  return result;
}

}  // namespace omnitag
