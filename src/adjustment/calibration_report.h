#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/observability.h"

/// Numbers and words about a calibration.
namespace omnitag {

/// A number with this many decimals, or this many significant digits.
std::string decimals(double number, int count);
std::string significant(double number, int count);

/// The names of all parameters, with commas.
std::string namesOf(const CalibrationModel& model);

/// A line about each pair of parameters of which the images hardly tell the one without the other.
void addTradeOffs(const CalibrationModel& model, const ParameterUncertainty& uncertainty,
                  std::vector<std::string>* remarks);

/// Where the camera leans, a line about how far the mirror's distance, as exactly as it is known,
/// leaves the robot's place open.
void addLean(const std::vector<CalibratedParameter>& parameters,
             const Eigen::Isometry3d& base_from_camera, std::vector<std::string>* remarks);

/// The rim (m) to write. The guess's in metres stays (nothing), as somebody may have measured it,
/// unless it then images elsewhere than the guess's circle by far, or hides corners that were seen:
/// then the circle stays.
std::optional<double> rimOf(const CameraTemplate& camera, const CalibrationResult& result);

}  // namespace omnitag
