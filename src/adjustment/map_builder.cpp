#include "omnitag/adjustment/map_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "map_growth.h"
#include "marker_places.h"
#include "omnitag/adjustment/corner_alignment.h"
#include "omnitag/common/format.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/marker/tag_pattern.h"
#include "recording.h"
#include "recording_checks.h"

namespace omnitag {
namespace {

double rms(double sum_of_squares, std::size_t count) {
  return count > 0 ? std::sqrt(sum_of_squares / static_cast<double>(count)) : 0.0;
}

/// The marker that was read first of those that are placed; of several in one image the largest.
std::size_t referenceOf(const Recording& recording) {
  for (const RecordedFrame& frame : recording.frames) {
    std::optional<std::size_t> reference;
    double largest = 0.0;
    for (std::size_t r = 0; r < frame.markers.size(); ++r) {
      const auto& marker = frame.markers[r];
      const double edge = meanEdge(frame.input.readings[r].corners);
      if (!marker || !recording.markers[*marker].is_placed || edge <= largest) continue;
      largest = edge;
      reference = marker;
    }
    if (reference) return *reference;
  }
  throw DegenerateRecording("no marker could be placed: drive past the markers, slowly");
}

/// Where a marker has its map's frame: on the floor below its centre, x along its normal's heading.
Pose frameOn(const Marker& marker) {
  constexpr double kLying = 0.7;  // of the normal's height
  const bool is_lying = std::abs(marker.normal().z()) > kLying;
  const Eigen::Vector3d along = marker.map_from_marker.linear().col(is_lying ? 0 : 2);
  return {marker.center().x(), marker.center().y(), std::atan2(along.y(), along.x())};
}

/// Expresses all in the frame of one of its markers.
void transformTo(std::size_t reference, Recording* recording) {
  const Pose new_from_old = inverse(frameOn(recording->markers[reference].marker));
  for (RecordedFrame& frame : recording->frames) {
    if (frame.map_from_base) frame.map_from_base->pose = new_from_old * frame.map_from_base->pose;
  }
  for (RecordedMarker& marker : recording->markers) {
    if (!marker.is_placed) continue;
    marker.marker.map_from_marker = new_from_old.toIsometry() * marker.marker.map_from_marker;
  }
}

class MapBuilder {
 public:
  MapBuilder(Recording* recording, const MapBuilderConfig& config, const PanoramaSource& panoramas)
      : recording_(recording), config_(config), panoramas_(panoramas) {}

  BuiltMap build() {
    checkReadings(*recording_);
    const bool has_seed = recording_->markers.front().is_seed;
    std::optional<std::size_t> held_frame;
    if (!has_seed) held_frame = startFromOneFrame(recording_, config_);
    grow(recording_, held_frame, config_);
    checkPoses(*recording_, config_);
    lookForContradicted();
    if (!has_seed) {
      reference_ = referenceOf(*recording_);
      transformTo(*reference_, recording_);
    }
    refine();
    if (panoramas_) {
      alignReadings();
      refine();
    }
    return result();
  }

 private:
  /// Of each marker that many readings contradict, its size or where it hung when.
  void lookForContradicted() {
    for (std::size_t m = 0; m < recording_->markers.size(); ++m) {
      const std::vector<ReadingPlace> readings = readingsOfId(m);
      if (!isSuspect(m, readings)) continue;
      RecordedMarker& marker = recording_->markers[m];
      // One of another size seems to hang elsewhere from wherever it is seen.
      if (const auto sized = sizeContradicting(m, readings)) {
        remarks_.push_back(describeSize(marker, *sized));
        if (!marker.is_seed) leaveOut(m);
        continue;
      }
      const auto places = placesOf(*recording_, m, readings, config_);
      if (places.size() < 2) continue;
      constexpr std::size_t kMoves = 3;
      if (changesBetween(places) > kMoves) {
        throw DegenerateRecording(format(
            "%s hangs at %zu places, %.2f m apart: take one down, or give the seed map an entry "
            "for each",
            nameOf(marker.marker).c_str(), places.size(),
            (places[1].marker.center() - places[0].marker.center()).norm()));
      }
      remarks_.push_back(describeMove(*recording_, places) +
                         (marker.is_seed ? ": its entry in the seed map is kept"
                                         : ": left out, record again while it stays"));
      if (!marker.is_seed) leaveOut(m);
    }
  }

  /// None where sizes are estimated anyway.
  std::optional<Marker> sizeContradicting(std::size_t index,
                                          const std::vector<ReadingPlace>& readings) const {
    if (config_.estimates_sizes && !recording_->markers[index].is_seed) return std::nullopt;
    return atAnotherSize(*recording_, index, readings, config_);
  }

  static std::string describeSize(const RecordedMarker& marker, const Marker& sized) {
    const std::string sizes =
        format("its readings tell a size of %.3f m, not %.3f m: ", sized.size, marker.marker.size);
    if (marker.is_seed)
      return nameOf(marker.marker) + ": " + sizes + "correct its size in the seed map";
    return nameOf(marker.marker) + " left out: " + sizes +
           "have sizes estimated (--estimate-sizes)";
  }

  /// A marker that is explained by then.
  void leaveOut(std::size_t index) {
    recording_->markers[index].is_placed = false;
    left_out_.push_back(index);
  }

  /// With those of a seed's readings that hang elsewhere than the seed says.
  std::vector<ReadingPlace> readingsOfId(std::size_t index) const {
    const Marker& marker = recording_->markers[index].marker;
    const auto twins = std::count_if(
        recording_->markers.begin(), recording_->markers.end(), [&](const RecordedMarker& other) {
          return other.marker.id == marker.id && other.marker.family == marker.family;
        });
    if (twins > 1) return recording_->readingsOf(index);
    std::vector<ReadingPlace> places;
    for (std::size_t f = 0; f < recording_->frames.size(); ++f) {
      const RecordedFrame& frame = recording_->frames[f];
      if (!frame.map_from_base) continue;
      for (std::size_t r = 0; r < frame.input.readings.size(); ++r) {
        const MarkerReading& reading = frame.input.readings[r];
        if (reading.id == marker.id && reading.family == marker.family) places.push_back({f, r});
      }
    }
    return places;
  }

  bool isSuspect(std::size_t index, const std::vector<ReadingPlace>& readings) const {
    const RecordedMarker& marker = recording_->markers[index];
    const auto few = static_cast<std::size_t>(config_.min_sightings);
    if (readings.size() < few) return false;
    if (!marker.is_placed) return true;
    std::size_t off = 0;
    for (const ReadingPlace& place : readings)
      off += residual(place, marker.marker) > limit() ? 1 : 0;
    return off >= few;
  }

  double limit() const { return config_.max_residual; }

  double residual(const ReadingPlace& place, const Marker& marker) const {
    const RecordedFrame& frame = recording_->frames[place.frame];
    const auto projection = projectMarker(marker, frame.camera, frame.map_from_base->pose);
    if (!projection) return std::numeric_limits<double>::infinity();
    const CornerPixels off =
        projection->pixels - stacked(frame.input.readings[place.reading].corners);
    return std::sqrt(off.squaredNorm() / 4.0);
  }

  /// The last adjustment, with covariances; markers that are not known well enough leave, until all
  /// are.
  void refine() {
    for (;;) {
      indexed_ = bundleOf(*recording_, std::nullopt, config_);
      std::optional<std::size_t> reference;
      for (std::size_t i = 0; i < indexed_.marker_indices.size(); ++i) {
        if (reference_ != indexed_.marker_indices[i]) continue;
        indexed_.bundle.landmarks[i].hold = Hold::kOnFloor;
        reference = i;
      }
      adjust(&indexed_, recording_, bundleConfig(config_));
      covariances_ = covariances(indexed_.bundle, bundleConfig(config_));
      if (!covariances_) {
        throw DegenerateRecording(
            "the recording leaves places undetermined: drive past all markers, and see that some "
            "are in sight together");
      }
      scaleCovariances();
      if (!dropUncertain()) return;
    }
  }

  /// Where readings are off by more than their noise, all is less certain. And what a marker errs
  /// by in all images alike, as in a shadow that stands still, does not become less by reading it
  /// often.
  void scaleCovariances() {
    // Robustly, as those that moved have no say.
    std::vector<double> squares;
    for (const ReadingMisfit& each : misfits(indexed_.bundle)) {
      if (std::isfinite(each.square)) squares.push_back(each.square);
    }
    if (squares.empty()) return;
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    constexpr double kMedian = 7.34;  // of chi-square with 8 degrees of freedom
    const double factor = std::max(1.0, *middle / kMedian);
    // So many readings have as much of that as of noise.
    constexpr double kAlike = 20.0;
    std::vector<double> counts(indexed_.bundle.landmarks.size());
    for (const Bundle::Observation& each : indexed_.bundle.observations) {
      counts[each.landmark] += 1.0;
    }
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double factor_of_marker = factor * (1.0 + counts[i] / kAlike);
      covariances_->landmarks[i] *= factor_of_marker;
      covariances_->sizes[i] *= factor_of_marker;
    }
  }

  /// Places the corners of all readings of the map's markers by these markers' pixels.
  void alignReadings() {
    std::vector<std::size_t> ignored;
    const TagPatterns patterns(recording_->placedMap(&ignored));
    for (std::size_t f = 0; f < recording_->frames.size(); ++f) {
      RecordedFrame& frame = recording_->frames[f];
      if (!frame.map_from_base) continue;
      const cv::Mat panorama = panoramas_(f);
      const MountedCamera camera = frame.camera.withBlur({config_.blur * config_.blur});
      frame.aligned.resize(frame.markers.size());
      for (std::size_t r = 0; r < frame.markers.size(); ++r) {
        if (!frame.markers[r] || !recording_->markers[*frame.markers[r]].is_placed) continue;
        const Marker& marker = recording_->markers[*frame.markers[r]].marker;
        if (residual({f, r}, marker) > limit()) continue;
        frame.aligned[r] =
            alignCorners(panorama, marker, patterns.of(marker), camera, frame.map_from_base->pose);
      }
    }
  }

  bool dropUncertain() {
    bool has_dropped = false;
    for (std::size_t i = 0; i < indexed_.marker_indices.size(); ++i) {
      const std::size_t m = indexed_.marker_indices[i];
      RecordedMarker& marker = recording_->markers[m];
      if (marker.is_seed || reference_ == m) continue;
      const std::string reason = whyUncertain(m, covariances_->landmarks[i]);
      if (reason.empty()) continue;
      remarks_.push_back(nameOf(marker.marker) + " left out: " + reason);
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

  BuiltMap result() {
    BuiltMap built;
    const std::vector<ReadingMisfit> off = misfits(indexed_.bundle);
    std::vector<std::size_t> counts(recording_->markers.size());
    std::vector<double> squares(recording_->markers.size());
    for (std::size_t i = 0; i < off.size(); ++i) {
      const ReadingPlace& place = indexed_.readings[i];
      const std::size_t m = *recording_->frames[place.frame].markers[place.reading];
      built.worst.push_back({recording_->frames[place.frame].input.stamp,
                             nameOf(recording_->markers[m].marker), off[i].pixels});
      if (off[i].pixels > limit()) continue;
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
      const RecordedMarker& marker = recording_->markers[m];
      added += marker.is_seed ? 0 : 1;
      built.markers.push_back({marker.marker, marker.is_seed, covariances_->landmarks[i],
                               covariances_->sizes[i], counts[m], rms(squares[m], counts[m])});
    }
    for (std::size_t m = 0; m < recording_->markers.size(); ++m) {
      if (!recording_->markers[m].is_placed) explainMissing(m);
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
  /// Without a seed, the marker that the map's frame stands on.
  std::optional<std::size_t> reference_;
  IndexedBundle indexed_;
  std::optional<BundleCovariances> covariances_;
  std::vector<std::string> remarks_;
  std::vector<std::size_t> left_out_;
  std::vector<std::size_t> dropped_;
};

}  // namespace

MarkerMap BuiltMap::map(const std::string& frame_id) const {
  MarkerMap map;
  map.frame_id = frame_id;
  for (const BuiltMarker& marker : markers) map.markers.push_back(marker.marker);
  return map;
}

BuiltMap buildMap(const std::shared_ptr<const CameraModel>& camera,
                  const std::vector<FrameReadings>& frames, const MarkerMap& seed,
                  const MapBuilderConfig& config, const PanoramaSource& panoramas) {
  if (seed.markers.empty() && !config.motion.isOnFloor()) {
    throw DegenerateRecording(
        "pose_model: free needs a seed map, of one marker at least: nothing else tells which way "
        "is up");
  }
  Recording recording(camera, frames, seed, config.size);
  if (recording.markers.empty()) checkReadings(recording);
  return MapBuilder(&recording, config, panoramas).build();
}

}  // namespace omnitag
