#include "adjustment/outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "adjustment/calibration_report.h"

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

std::vector<CornerResidual> cornerResiduals(const Bundle& bundle) {
  const std::vector<std::optional<CornerPixels>> predicted = predictions(bundle);
  std::vector<CornerResidual> residuals;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const Bundle::Observation& observation = bundle.observations[i];
    for (Eigen::Index k = 0; k < 4; ++k) {
      const Eigen::Vector2d pixel = observation.pixels.segment<2>(2 * k);
      std::optional<Eigen::Vector2d> residual;
      if (predicted[i]) residual = predicted[i]->segment<2>(2 * k) - pixel;
      residuals.push_back({observation.frame, observation.landmark, pixel, residual});
    }
  }
  return residuals;
}

void leaveOutFrames(Bundle* bundle, std::vector<std::string>* remarks) {
  const std::vector<CornerResidual> residuals = cornerResiduals(*bundle);
  const double limit = farLimit(residuals);
  std::vector<std::vector<double>> lengths(bundle->frames.size());
  for (const CornerResidual& corner : residuals) lengths[corner.frame].push_back(lengthOf(corner));
  std::vector<Bundle::Frame> frames;
  std::vector<std::optional<std::size_t>> new_index(lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (medianOf(std::move(lengths[i])) > limit) continue;
    new_index[i] = frames.size();
    frames.push_back(bundle->frames[i]);
  }
  const std::size_t left_out = bundle->frames.size() - frames.size();
  bundle->frames = std::move(frames);
  std::vector<Bundle::Observation> observations;
  for (Bundle::Observation& observation : bundle->observations) {
    if (!new_index[observation.frame]) continue;
    observation.frame = *new_index[observation.frame];
    observations.push_back(observation);
  }
  bundle->observations = std::move(observations);
  if (left_out == 0) return;
  remarks->push_back("left out, as no pose explains what was read in them: " +
                     std::to_string(left_out) + (left_out == 1 ? " image" : " images"));
}

void leaveOutMarkers(Bundle* bundle, std::vector<std::string>* remarks) {
  const std::vector<CornerResidual> residuals = cornerResiduals(*bundle);
  const double limit = farLimit(residuals);
  std::map<std::size_t, std::vector<double>> lengths;
  for (const CornerResidual& corner : residuals) {
    lengths[corner.landmark].push_back(lengthOf(corner));
  }
  for (auto& [landmark, of_landmark] : lengths) {
    const double median = medianOf(std::move(of_landmark));
    if (median <= limit) continue;
    const std::size_t displaced = landmark;
    auto& observations = bundle->observations;
    observations.erase(std::remove_if(observations.begin(), observations.end(),
                                      [displaced](const Bundle::Observation& observation) {
                                        return observation.landmark == displaced;
                                      }),
                       observations.end());
    remarks->push_back("left out: marker " +
                       std::to_string(bundle->landmarks[displaced].marker.id) +
                       ", which is not where the map has it (" + decimals(median, 1) + " px off)");
  }
}

}  // namespace omnitag
