#include "cylinder_settings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <sstream>

#include "omnitag/common/angle.h"
#include "processor_time.h"

namespace omnitag {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

/// m, radius of the cylinder: where most markers hang.
constexpr double kDistance = 4.0;

std::vector<CylinderSettings> alternatives(const CylinderSettings& current) {
  std::vector<CylinderSettings> all;
  const auto add = [&](const auto& values, const auto& set) {
    for (const auto& value : values) {
      CylinderSettings settings = current;
      set(&settings, value);
      all.push_back(settings);
    }
  };
  using Settings = CylinderSettings*;
  const std::vector<double> decimations{1.0, 1.5, 2.0, 3.0};
  add(decimations, [](Settings s, double value) { s->detector.quad_decimate = value; });
  const std::vector<int> differences{5, 15, 25, 40, 60, 80, 100};
  add(differences, [](Settings s, int value) { s->detector.min_white_black_diff = value; });
  const std::vector<RowSpacing> rows{RowSpacing::kSquare, RowSpacing::kDensest};
  add(rows, [](Settings s, RowSpacing value) { s->rows = value; });
  const std::vector<int> interpolations{cv::INTER_NEAREST, cv::INTER_LINEAR, cv::INTER_CUBIC};
  add(interpolations, [](Settings s, int value) { s->interpolation = value; });
  const std::vector<double> blurs{-0.8, 0.0, 0.5, 0.8};
  add(blurs, [](Settings s, double value) { s->detector.quad_sigma = value; });
  const std::vector<bool> refinements{true, false};
  add(refinements, [](Settings s, bool value) { s->detector.refine_edges = value; });
  const std::vector<int> clusters{5, 25, 50, 100};
  add(clusters, [](Settings s, int value) { s->detector.min_cluster_pixels = value; });
  const std::vector<int> maxima{5, 10, 20};
  add(maxima, [](Settings s, int value) { s->detector.max_nmaxima = value; });
  const std::vector<double> errors{3.0, 10.0, 30.0};
  add(errors, [](Settings s, double value) { s->detector.max_line_fit_mse = value; });
  const std::vector<double> angles{10.0, 30.0, 45.0};
  add(angles, [](Settings s, double value) { s->detector.critical_angle = radians(value); });
  const std::vector<double> sharpenings{0.0, 0.25, 0.5, 1.0};
  add(sharpenings, [](Settings s, double value) { s->detector.decode_sharpening = value; });
  const std::vector<double> margins{0.0, 10.0};
  add(margins, [](Settings s, double value) { s->detector.min_decision_margin = value; });
  return all;
}

/// Walks from alternative to better alternative until none is better.
CylinderSettings improve(
    const CylinderTrial& trial,
    const std::function<bool(const CylinderTrial::Outcome&, const CylinderTrial::Outcome&)>& better,
    bool stops_early) {
  constexpr int kPasses = 3;
  CylinderSettings best;
  CylinderTrial::Outcome reached = trial.of(best, kForever);
  for (int pass = 0; pass < kPasses; ++pass) {
    bool has_improved = false;
    const std::size_t count = alternatives(best).size();
    for (std::size_t i = 0; i < count; ++i) {
      const CylinderSettings candidate = alternatives(best)[i];
      if (describe(candidate) == describe(best)) continue;
      const CylinderTrial::Outcome outcome =
          trial.of(candidate, stops_early ? reached.time : kForever);
      if (!better(outcome, reached)) continue;
      best = candidate;
      reached = outcome;
      has_improved = true;
    }
    if (!has_improved) break;
  }
  return best;
}

/// Less time than that is chance.
constexpr double kFaster = 0.98;

}  // namespace

std::string describe(const CylinderSettings& settings) {
  const CylinderSettings standard;
  const TagDetectorConfig& is = settings.detector;
  const TagDetectorConfig& was = standard.detector;
  std::ostringstream text;
  const auto tell = [&text](const char* name, auto value, auto usual) {
    if (value != usual) text << (text.tellp() > 0 ? ", " : "") << name << ' ' << value;
  };
  if (settings.rows == RowSpacing::kDensest) text << "fewer rows";
  if (settings.interpolation == cv::INTER_NEAREST) tell("interpolation", "nearest", "");
  if (settings.interpolation == cv::INTER_CUBIC) tell("interpolation", "cubic", "");
  tell("quad_decimate", is.quad_decimate, was.quad_decimate);
  tell("quad_sigma", is.quad_sigma, was.quad_sigma);
  tell("refine_edges", is.refine_edges, was.refine_edges);
  tell("decode_sharpening", is.decode_sharpening, was.decode_sharpening);
  tell("min_cluster_pixels", is.min_cluster_pixels, was.min_cluster_pixels);
  tell("max_nmaxima", is.max_nmaxima, was.max_nmaxima);
  tell("critical_angle", std::round(degrees(is.critical_angle)),
       std::round(degrees(was.critical_angle)));
  tell("max_line_fit_mse", is.max_line_fit_mse, was.max_line_fit_mse);
  tell("min_white_black_diff", is.min_white_black_diff, was.min_white_black_diff);
  tell("min_decision_margin", is.min_decision_margin, was.min_decision_margin);
  return text.tellp() > 0 ? text.str() : "the same";
}

CylinderReader::CylinderReader(const RecordedSequence& sequence, const CylinderSettings& settings)
    : sequence_(sequence),
      interpolation_(settings.interpolation),
      panorama_({sequence.camera, sequence.frames.front().base_from_camera}, sequence.map,
                kDistance, settings.rows),
      detector_(settings.detector, familiesOf(sequence.map)) {}

std::vector<FoundMarker> CylinderReader::read(std::size_t frame) const {
  cv::Mat cylinder;
  panorama_.unwrap(sequence_.frames[frame].image, interpolation_, &cylinder);
  std::vector<FoundMarker> found;
  for (const TagDetection& tag : detector_.detect(cylinder)) {
    found.push_back({tag.family, tag.id, panorama_.panoramaPixel(tag.center)});
  }
  return found;
}

CylinderTrial::CylinderTrial(const RecordedSequence& sequence, double max_incidence)
    : sequence_(sequence) {
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    visible_.push_back(visibleMarkers(sequence, i, max_incidence));
  }
}

CylinderTrial::Outcome CylinderTrial::of(const CylinderSettings& settings, double patience) const {
  const CylinderReader reader(sequence_, settings);
  reader.read(0);
  Outcome outcome;
  for (std::size_t i = 0; i < visible_.size() && outcome.time <= patience; ++i) {
    const double start = processorTime();
    const std::vector<FoundMarker> found = reader.read(i);
    outcome.time += processorTime() - start;
    outcome.found += countFound(visible_[i], sequence_.map, found);
  }
  return outcome;
}

CylinderSettings settingsThatFindMost(const CylinderTrial& trial) {
  const auto better = [](const CylinderTrial::Outcome& a, const CylinderTrial::Outcome& b) {
    return a.found > b.found || (a.found == b.found && a.time < kFaster * b.time);
  };
  return improve(trial, better, false);
}

CylinderSettings fastestSettings(const CylinderTrial& trial) {
  const int enough = trial.of({}, kForever).found;
  const auto better = [enough](const CylinderTrial::Outcome& a, const CylinderTrial::Outcome& b) {
    return a.found >= enough && a.time < kFaster * b.time;
  };
  return improve(trial, better, true);
}

}  // namespace omnitag
