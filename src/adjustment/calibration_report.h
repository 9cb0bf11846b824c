#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adjustment/camera_calibration.h"
#include "adjustment/observability.h"

/// Numbers and words for reports on a calibration.
namespace omnitag {

/// A number with this many decimals, or this many significant digits.
std::string decimals(double number, int count);
std::string significant(double number, int count);

/// The names of all parameters, separated by commas.
std::string namesOf(const CalibrationModel& model);

/// Adds a line about each pair of parameters that the images hardly separate.
void addTradeOffs(const CalibrationModel& model, const ParameterUncertainty& uncertainty,
                  std::vector<std::string>* remarks);

/// If the camera leans, adds a line about how uncertain the mirror's distance makes the robot's
/// place.
void addLean(const std::vector<CalibratedParameter>& parameters,
             const Eigen::Isometry3d& base_from_camera, std::vector<std::string>* remarks);

/// The rim (m) to write; nothing to keep the guess's, which may have been measured. If the guess's
/// rim would image far from the guess's circle or hide corners that were seen, keeps the circle
/// instead.
std::optional<double> rimOf(const CameraTemplate& camera, const CalibrationResult& result);

}  // namespace omnitag
