#include "outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "calibration_report.h"

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
  lengths.reserve(residuals.size());
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

void leaveOutFrames(const std::vector<CornerResidual>& residuals, CalibrationData* data,
                    CalibrationState* state) {
  const double limit = farLimit(residuals);
  std::vector<std::vector<double>> lengths(data->frames.size());
  for (const CornerResidual& corner : residuals) lengths[corner.frame].push_back(lengthOf(corner));
  std::vector<CalibrationFrame> frames;
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (medianOf(std::move(lengths[i])) > limit) continue;
    frames.push_back(std::move(data->frames[i]));
    poses.push_back(state->poses[i]);
  }
  const std::size_t left_out = data->frames.size() - frames.size();
  data->frames = std::move(frames);
  state->poses = std::move(poses);
  if (left_out == 0) return;
  data->remarks.push_back("left out, as no pose explains what was read in them: " +
                          std::to_string(left_out) + (left_out == 1 ? " image" : " images"));
}

void leaveOutMarkers(const std::vector<CornerResidual>& residuals, const MarkerMap& map,
                     CalibrationData* data) {
  const double limit = farLimit(residuals);
  std::map<std::size_t, std::vector<double>> lengths;
  for (const CornerResidual& corner : residuals) {
    lengths[corner.map_entry].push_back(lengthOf(corner));
  }
  for (auto& [entry, of_entry] : lengths) {
    const double median = medianOf(std::move(of_entry));
    if (median <= limit) continue;
    const std::size_t displaced = entry;
    for (CalibrationFrame& frame : data->frames) {
      auto& observations = frame.observations;
      observations.erase(std::remove_if(observations.begin(), observations.end(),
                                        [displaced](const MarkerObservation& observation) {
                                          return observation.map_entry == displaced;
                                        }),
                         observations.end());
    }
    data->remarks.push_back("left out: marker " + std::to_string(map.markers[displaced].id) +
                            ", which is not where the map has it (" + decimals(median, 1) +
                            " px off)");
  }
}

}  // namespace omnitag
