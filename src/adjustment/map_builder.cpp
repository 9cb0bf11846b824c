#include "adjustment/map_builder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "adjustment/contradicted_markers.h"
#include "adjustment/corner_alignment.h"
#include "adjustment/indexed_bundle.h"
#include "adjustment/map_growth.h"
#include "adjustment/recording.h"
#include "adjustment/recording_checks.h"
#include "adjustment/reference_frame.h"
#include "common/format.h"
#include "marker/tag_pattern.h"

namespace omnitag {
namespace {

double rms(double sum_of_squares, std::size_t count) {
  return count > 0 ? std::sqrt(sum_of_squares / static_cast<double>(count)) : 0.0;
}

class MapBuilder {
 public:
  MapBuilder(Recording* recording, const MapBuilderConfig& config, const PanoramaSource& panoramas,
             const BuildProgress& progress)
      : recording_(recording), config_(config), panoramas_(panoramas), progress_(progress) {}

  BuiltMap build() {
    checkReadings(*recording_);
    const bool has_seed = recording_->markers.front().is_seed;
    std::optional<std::size_t> held_frame;
    report("placing markers");
    if (!has_seed) held_frame = startFromOneFrame(recording_, config_);
    grow(recording_, held_frame, config_);
    checkPoses(*recording_, config_);
    if (config_.looks_for_contradictions) {
      ContradictedMarkers contradicted = contradictedMarkers(*recording_, config_);
      for (const std::size_t m : contradicted.left_out) recording_->markers[m].is_placed = false;
      remarks_ = std::move(contradicted.remarks);
      left_out_ = std::move(contradicted.left_out);
    }
    if (!has_seed) {
      reference_ = referenceOf(*recording_);
      transformTo(*reference_, recording_);
      RecordedMarker& reference = recording_->markers[*reference_];
      reference.prior = PlacePrior::gauge(reference.marker);
    }
    refine();
    if (panoramas_) {
      alignReadings();
      refine();
    }
    return result();
  }

 private:
  void report(const char* step, std::size_t done = 0, std::size_t total = 0) const {
    if (progress_) progress_(step, done, total);
  }

  /// The last adjustment, with covariances; repeats it without the markers that are not known well
  /// enough.
  void refine() {
    report("adjusting poses and markers");
    for (;;) {
      indexed_ = bundleOf(*recording_, std::nullopt, config_);
      adjust(&indexed_, recording_, bundleConfig(config_));
      Undetermined undetermined;
      information_ = information(indexed_.bundle, bundleConfig(config_), &undetermined);
      if (!information_) {
        throw DegenerateRecording("the recording does not tell " + undetermined.direction +
                                  ": drive past all markers, and see that some are in sight "
                                  "together");
      }
      scaleCovariances();
      if (!dropUncertain()) return;
    }
  }

  /// Enlarges covariances if readings are off by more than their noise, and for errors of a marker
  /// that are the same in all images, as in a shadow that stands still, and do not average out.
  void scaleCovariances() {
    // By the median, so that markers that moved do not matter.
    std::vector<double> squares;
    for (const ReadingResidual& each : misfits(indexed_.bundle, 1.0)) {
      if (std::isfinite(each.square)) squares.push_back(each.square);
    }
    if (squares.empty()) return;
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    constexpr double kMedian = 7.34;  // of chi-square with 8 degrees of freedom
    const double factor = std::max(1.0, *middle / kMedian);
    std::vector<std::size_t> counts(indexed_.bundle.landmarks.size());
    for (const Bundle::Observation& each : indexed_.bundle.observations) ++counts[each.landmark];
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double factor_of_marker = factor * alikeFactor(counts[i]);
      information_->landmarks[i] *= factor_of_marker;
      information_->landmarks_within[i] *= factor_of_marker;
      information_->sizes[i] *= factor_of_marker;
    }
  }

  /// Locates the corners of all readings of the map's markers by these markers' pixels.
  void alignReadings() {
    std::vector<std::size_t> ignored;
    const TagPatterns patterns(recording_->placedMap(&ignored));
    const std::size_t total = recording_->framesWithPose();
    std::size_t done = 0;
    for (std::size_t f = 0; f < recording_->frames.size(); ++f) {
      RecordedFrame& frame = recording_->frames[f];
      if (!frame.map_from_base) continue;
      report("images aligned", ++done, total);
      const cv::Mat panorama = panoramas_(f);
      const MountedCamera camera = frame.camera.withBlur({config_.blur * config_.blur});
      frame.aligned.resize(frame.markers.size());
      for (std::size_t r = 0; r < frame.markers.size(); ++r) {
        if (!frame.markers[r] || !recording_->markers[*frame.markers[r]].is_placed) continue;
        const Marker& marker = recording_->markers[*frame.markers[r]].marker;
        if (residualOf(*recording_, {f, r}, marker) > config_.max_residual) continue;
        frame.aligned[r] =
            alignCorners(panorama, marker, patterns.of(marker), camera, frame.map_from_base->pose);
      }
    }
  }

  /// Relative to markers that are exactly known; within the map if there are none.
  const MarkerCovariance& covarianceOf(std::size_t landmark) const {
    const auto& landmarks = indexed_.bundle.landmarks;
    const bool is_tied = std::any_of(landmarks.begin(), landmarks.end(), [](const auto& each) {
      return each.prior && each.prior->isExact();
    });
    return is_tied ? information_->landmarks[landmark] : information_->landmarks_within[landmark];
  }

  bool dropUncertain() {
    bool has_dropped = false;
    for (std::size_t i = 0; i < indexed_.marker_indices.size(); ++i) {
      const std::size_t m = indexed_.marker_indices[i];
      RecordedMarker& marker = recording_->markers[m];
      if (marker.is_seed || reference_ == m) continue;
      const std::string reason = whyUncertain(m, covarianceOf(i));
      if (reason.empty()) continue;
      remarks_.push_back(nameOf(marker.marker) + " left out: " + reason);
      uncertain_.push_back(builtMarker(i));
      marker.is_placed = false;
      has_dropped = true;
      dropped_.push_back(m);
    }
    return has_dropped;
  }

  std::string whyUncertain(std::size_t index, const MarkerCovariance& covariance) const {
    const auto readings = recording_->readingsOf(index);
    const auto sightings = recording_->sightings(readings);
    if (readings.size() < static_cast<std::size_t>(config_.min_sightings)) {
      return format("read in %zu images, %d are needed", readings.size(), config_.min_sightings);
    }
    const double angle = parallax(recording_->markers[index].marker.center(), sightings);
    if (angle < config_.min_parallax) {
      return format("seen from directions only %.1f degrees apart, %.0f are needed: drive past it",
                    degrees(angle), degrees(config_.min_parallax));
    }
    MarkerEstimate estimate;
    estimate.covariance = covariance;
    if (estimate.positionDeviation() > config_.max_position_deviation ||
        estimate.orientationDeviation() > config_.max_orientation_deviation) {
      return format("known to %.3f m and %.2f degrees only: drive past it, and nearer",
                    estimate.positionDeviation(), degrees(estimate.orientationDeviation()));
    }
    return "";
  }

  /// By its index in the bundle; without its residual.
  BuiltMarker builtMarker(std::size_t landmark) const {
    const std::size_t m = indexed_.marker_indices[landmark];
    const RecordedMarker& marker = recording_->markers[m];
    const auto sightings = recording_->sightings(recording_->readingsOf(m));
    BuiltMarker built;
    built.marker = marker.marker;
    built.is_seed = marker.is_seed;
    built.is_exact = marker.prior && marker.prior->isExact();
    built.covariance = covarianceOf(landmark);
    built.size_variance = information_->sizes[landmark];
    built.sightings = sightings.size();
    if (marker.is_seed) built.survey = marker.prior;
    built.seen = seenFrom(marker.marker.center(), sightings);
    return built;
  }

  BuiltMap result() {
    BuiltMap built;
    const std::vector<ReadingResidual> off = misfits(indexed_.bundle, 1.0);
    std::vector<std::size_t> counts(recording_->markers.size());
    std::vector<double> squares(recording_->markers.size());
    for (std::size_t i = 0; i < off.size(); ++i) {
      const ReadingIndex& place = indexed_.readings[i];
      const std::size_t m = *recording_->frames[place.frame].markers[place.reading];
      built.worst.push_back({recording_->frames[place.frame].input.stamp,
                             nameOf(recording_->markers[m].marker), off[i].pixels});
      if (off[i].pixels > config_.max_residual) continue;
      ++counts[m];
      squares[m] += off[i].pixels * off[i].pixels;
    }
    std::sort(built.worst.begin(), built.worst.end(),
              [](const WorstReading& a, const WorstReading& b) { return a.residual > b.residual; });
    constexpr std::size_t kWorst = 10;
    if (built.worst.size() > kWorst) built.worst.resize(kWorst);
    std::size_t added = 0;
    for (std::size_t i = 0; i < indexed_.marker_indices.size(); ++i) {
      const std::size_t m = indexed_.marker_indices[i];
      if (reference_ == m) built.reference = built.markers.size();
      BuiltMarker marker = builtMarker(i);
      marker.sightings = counts[m];
      marker.residual = rms(squares[m], counts[m]);
      added += marker.is_exact ? 0 : 1;
      built.markers.push_back(std::move(marker));
    }
    built.uncertain = std::move(uncertain_);
    built.residuals = cornerResiduals(indexed_.bundle);
    for (std::size_t m = 0; m < recording_->markers.size(); ++m) {
      if (!recording_->markers[m].is_placed) explainMissing(m);
    }
    std::vector<Marker> markers;
    for (const Bundle::Landmark& each : indexed_.bundle.landmarks) markers.push_back(each.marker);
    for (const PlaceConstraint& constraint : indexed_.bundle.constraints) {
      const auto words = contradiction(constraint, markers);
      if (words) remarks_.push_back(*words);
    }
    built.remarks = remarks_;
    if (added == 0 || (reference_ && added < 2)) {
      throw DegenerateRecording("no marker could be added" +
                                (remarks_.empty() ? "" : ": " + remarks_.front()));
    }
    for (const RecordedFrame& frame : recording_->frames) {
      if (!frame.map_from_base) continue;
      built.stamps.push_back(frame.input.stamp);
      built.trajectory.push_back(frame.map_from_base->pose);
    }
    built.images = recording_->frames.size();
    return built;
  }

  void explainMissing(std::size_t index) {
    const auto isIn = [index](const std::vector<std::size_t>& list) {
      return std::find(list.begin(), list.end(), index) != list.end();
    };
    if (isIn(dropped_) || isIn(left_out_)) return;
    const std::size_t with_pose = recording_->readingsOf(index).size();
    const std::size_t all = recording_->readingsOf(index, false).size();
    const auto sightings = recording_->sightings(recording_->readingsOf(index));
    const std::string name = nameOf(recording_->markers[index].marker);
    if (with_pose < static_cast<std::size_t>(config_.min_sightings)) {
      remarks_.push_back(
          name + format(" left out: read in %zu images, of which %zu tell where the robot was; %d "
                        "are needed",
                        all, with_pose, config_.min_sightings));
    } else {
      remarks_.push_back(name + format(" left out: its %zu readings do not tell one place: drive "
                                       "past it, and nearer",
                                       with_pose));
    }
  }

  Recording* recording_;
  const MapBuilderConfig& config_;
  const PanoramaSource& panoramas_;
  const BuildProgress& progress_;
  /// Without a seed, the marker that defines the map's frame.
  std::optional<std::size_t> reference_;
  IndexedBundle indexed_;
  std::optional<BundleInformation> information_;
  std::vector<std::string> remarks_;
  std::vector<std::size_t> left_out_;
  std::vector<std::size_t> dropped_;
  /// The dropped markers, as they were when they were dropped.
  std::vector<BuiltMarker> uncertain_;
};

}  // namespace

BuiltMap buildMap(const std::shared_ptr<const CameraModel>& camera,
                  const std::vector<FrameReadings>& frames, const MarkerMap& seed,
                  const MapBuilderConfig& config, const PanoramaSource& panoramas,
                  const BuildProgress& progress) {
  if (seed.markers.empty() && !config.motion.isOnFloor()) {
    throw DegenerateRecording(
        "pose_model: free needs a seed map, of one marker at least: nothing else tells which way "
        "is up");
  }
  Recording recording(camera, frames, seed, config.size);
  if (recording.markers.empty()) checkReadings(recording);
  return MapBuilder(&recording, config, panoramas, progress).build();
}

}  // namespace omnitag
