#include "calibration_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace omnitag {

double lengthOf(const CornerResidual& corner) {
  return corner.residual ? corner.residual->norm() : std::numeric_limits<double>::infinity();
}

double medianOf(std::vector<double> sample) {
  if (sample.empty()) return 0.0;
  const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
  std::nth_element(sample.begin(), middle, sample.end());
  return *middle;
}

double farLimit(const std::vector<CornerResidual>& residuals) {
  constexpr double kMedians = 8.0;
  constexpr double kLeast = 1.0;
  std::vector<double> lengths;
  for (const CornerResidual& corner : residuals) lengths.push_back(lengthOf(corner));
  return std::max(kLeast, kMedians * medianOf(std::move(lengths)));
}

ResidualSummary summarize(const std::vector<CornerResidual>& residuals) {
  const double limit = farLimit(residuals);
  ResidualSummary summary;
  double squares = 0.0;
  for (const CornerResidual& corner : residuals) {
    const double length = lengthOf(corner);
    if (std::isfinite(length) && length <= limit) {
      ++summary.counted;
      squares += length * length;
    } else {
      ++summary.left_out;
    }
  }
  if (summary.counted > 0) summary.rms = std::sqrt(squares / static_cast<double>(summary.counted));
  return summary;
}

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

}  // namespace omnitag
