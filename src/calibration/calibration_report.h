#pragma once

#include <string>
#include <vector>

#include "omnitag/calibration/camera_calibration.h"
#include "omnitag/calibration/observability.h"

/// Numbers and words about a calibration.
namespace omnitag {

/// Pixels; infinity for a corner that should not be seen.
double lengthOf(const CornerResidual& corner);

/// 0 of none.
double medianOf(std::vector<double> sample);

/// Pixels: corners beyond say nothing about the camera; they are covered, misread or hang
/// elsewhere.
double farLimit(const std::vector<CornerResidual>& residuals);

ResidualSummary summarize(const std::vector<CornerResidual>& residuals);

/// A number with so many decimals, or so many significant digits.
std::string decimals(double number, int count);
std::string significant(double number, int count);

/// The names of all parameters, with commas.
std::string namesOf(const CalibrationModel& model);

/// A line about each pair of parameters of which the images hardly tell the one without the other.
void addTradeOffs(const CalibrationModel& model, const ParameterUncertainty& uncertainty,
                  std::vector<std::string>* remarks);

}  // namespace omnitag
