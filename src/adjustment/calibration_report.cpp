#include "adjustment/calibration_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "adjustment/outliers.h"
#include "omnitag/common/error.h"

namespace omnitag {

std::string decimals(double number, int count) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(count) << number;
  return text.str();
}

std::string significant(double number, int count) {
  std::ostringstream text;
  text << std::setprecision(count) << number;
  return text.str();
}

std::string namesOf(const CalibrationModel& model) {
  std::string names;
  for (const CalibrationParameter& parameter : model.parameters()) {
    names += (names.empty() ? "" : ", ") + parameter.name;
  }
  return names;
}

void addTradeOffs(const CalibrationModel& model, const ParameterUncertainty& uncertainty,
                  std::vector<std::string>* remarks) {
  constexpr double kClose = 0.95;
  const auto nameOf = [&](Eigen::Index place) {
    const Eigen::Index index = uncertainty.free[static_cast<std::size_t>(place)];
    return model.parameters()[static_cast<std::size_t>(index)].name;
  };
  std::string pairs;
  const Eigen::Index size = uncertainty.correlations.rows();
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = i + 1; j < size; ++j) {
      const double correlation = uncertainty.correlations(i, j);
      if (std::abs(correlation) < kClose) continue;
      pairs += (pairs.empty() ? "" : ", ") + nameOf(i) + " and " + nameOf(j) + " (" +
               decimals(correlation, 3) + ")";
    }
  }
  if (pairs.empty()) return;
  remarks->push_back("trade off against each other (correlation): " + pairs +
                     "; each alone may be off by its deviation, together they image alike");
}

void addLean(const std::vector<CalibratedParameter>& parameters,
             const Eigen::Isometry3d& base_from_camera, std::vector<std::string>* remarks) {
  const auto distance = std::find_if(
      parameters.begin(), parameters.end(),
      [](const CalibratedParameter& parameter) { return parameter.guess.name == "apex_distance"; });
  if (distance == parameters.end()) return;
  const Eigen::Vector3d axis = base_from_camera.linear().col(2);
  const double displacement = axis.head<2>().norm() * distance->deviation;
  constexpr double kHardly = 1e-4;  // m
  if (displacement < kHardly) return;
  remarks->push_back(
      "the camera leans: what apex_distance is off displaces the robot everywhere by " +
      decimals(axis.head<2>().norm(), 2) + " of it, " + decimals(1e3 * displacement, 1) +
      " mm (standard deviation); measure it, and use --fix apex_distance");
}

std::optional<double> rimOf(const CameraTemplate& camera, const CalibrationResult& result) {
  if (!camera.hasMirror()) return std::nullopt;
  const auto radiusOf = [](const CameraModel& model) { return model.rimPixels(); };
  const Eigen::VectorXd& values = result.camera_values;
  const Eigen::Vector2d centre = camera.widened(values)->imagePlane().principalPoint();
  const double limit = farLimit(result.residuals);
  double farthest = 0.0;
  for (const CornerResidual& corner : result.residuals) {
    if (lengthOf(corner) > limit) continue;
    farthest = std::max(farthest, (corner.pixel - centre).norm());
  }
  const double guessed = camera.circle();
  constexpr double kMargin = 2.0;  // pixels
  constexpr double kFarOff = 0.25;
  try {
    const double now = radiusOf(*camera.camera(values));
    const bool is_well = now >= farthest + kMargin && std::abs(now / guessed - 1.0) <= kFarOff;
    if (is_well) return std::nullopt;
  } catch (const InputError&) {
    // The guess's rim is impossible on this mirror.
  }
  return camera.rimAt(values, std::max(guessed, farthest + kMargin));
}

}  // namespace omnitag
