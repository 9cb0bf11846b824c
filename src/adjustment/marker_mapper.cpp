#include "adjustment/marker_mapper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "common/symmetric_matrix.h"
#include "marker/marker_reader.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// An id that was read at two places at once in this many images is not a single marker.
constexpr int kRepetitions = 2;

double edgeOf(const MarkerSighting& sighting) { return meanEdge(sighting.corners); }

double distance(const MarkerSighting& a, const MarkerSighting& b) {
  return difference(a.map_from_base.pose, b.map_from_base.pose).head<2>().norm();
}

/// How little a sighting contributes: the smaller, the better.
double vagueness(const MarkerSighting& sighting) {
  return positionDeviation(sighting.map_from_base) + 1.0 / edgeOf(sighting);
}

/// Of the two sightings nearest to each other, removes the one nearer to the others, so that the
/// rest stay as spread out as before.
void thin(std::vector<MarkerSighting>* sightings) {
  const std::vector<MarkerSighting>& all = *sightings;
  std::size_t first = 0;
  std::size_t second = 1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (distance(all[i], all[j]) >= distance(all[first], all[second])) continue;
      first = i;
      second = j;
    }
  }
  const auto toOthers = [&](std::size_t index) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i != first && i != second) nearest = std::min(nearest, distance(all[i], all[index]));
    }
    return nearest;
  };
  const std::size_t nearer = toOthers(first) < toOthers(second) ? first : second;
  sightings->erase(sightings->begin() + static_cast<std::ptrdiff_t>(nearer));
}

}  // namespace

MarkerMapperConfig readMarkerMapperConfig(const YamlReader& reader) {
  reader.allowOnly({"views_per_frame", "size", "estimate_sizes", "corner_noise",
                    "max_pose_deviation", "max_sightings", "min_step", "min_sightings",
                    "min_parallax", "min_agreement", "max_position_deviation",
                    "max_orientation_deviation"});
  MarkerMapperConfig config;
  reader.read("views_per_frame", &config.views_per_frame, Interval{1, 100});
  reader.read("size", &config.size, kNonNegative);
  reader.read("estimate_sizes", &config.estimate_sizes);
  reader.read("corner_noise", &config.corner_noise, kPositive);
  reader.read("max_pose_deviation", &config.max_pose_deviation, kPositive);
  reader.read("max_sightings", &config.max_sightings, Interval{3, 1000});
  reader.read("min_step", &config.min_step, kPositive);
  reader.read("min_sightings", &config.min_sightings, Interval{2, 1000});
  reader.read("min_parallax", &config.min_parallax, {0.0, kPi});
  reader.read("min_agreement", &config.min_agreement, {0.0, 1.0});
  reader.read("max_position_deviation", &config.max_position_deviation, kPositive);
  reader.read("max_orientation_deviation", &config.max_orientation_deviation, kPositive);
  return config;
}

MarkerMapper::MarkerMapper(CameraModels cameras, MarkerMap map, const MarkerMapperConfig& config)
    : cameras_(std::move(cameras)), map_(std::move(map)), config_(config) {
  if (config_.size == 0.0) config_.size = map_.default_size;
  if (config_.size == 0.0) {
    throw InputError(
        "mapping needs the size of unknown markers: the map's default size, or mapper/size");
  }
}

bool MarkerMapper::add(const Frame& frame, const FrameResult& result) {
  if (!result.map_from_base || result.acceptedMarkers() == 0) return false;
  const PoseEstimate pose = honestPose(result);
  const double variance = eigenPairs(pose.covariance.topLeftCorner<2, 2>()).values(1);
  if (std::sqrt(variance) > config_.max_pose_deviation) return false;

  bool has_changed = false;
  std::set<Key> seen;
  for (const MarkerReading& reading : unknownReadings(result)) {
    const Key key(reading.family, reading.id);
    Track& track = tracks_[key];
    if (!seen.insert(key).second) {
      ++track.repetitions;
      continue;
    }
    if (!keep({frame.stamp, frame.base_from_camera, pose, reading.corners, frame.camera}, &track))
      continue;
    Marker marker;
    marker.family = reading.family;
    marker.id = reading.id;
    marker.size = config_.size;
    const MarkerEstimateConfig estimate_config{config_.corner_noise, config_.estimate_sizes};
    auto estimate = estimateMarker(
        marker, cameras_, track.sightings,
        track.estimate ? std::optional(track.estimate->marker) : std::nullopt, estimate_config);
    if (!estimate) continue;
    estimate->marker.deviation = estimate->positionDeviation();
    estimate->marker.orientation_deviation = estimate->orientationDeviation();
    track.estimate = std::move(estimate);
    if (!isGoodEnough(track)) continue;
    has_changed = true;
    if (!track.entry) {
      track.entry = map_.markers.size();
      map_.markers.emplace_back();
    }
    map_.markers[*track.entry] = track.estimate->marker;
  }
  return has_changed;
}

std::vector<MarkerReading> MarkerMapper::unknownReadings(const FrameResult& result) const {
  const auto isUnknown = [this](const std::string& family, int id) {
    const auto track = tracks_.find({family, id});
    const bool is_ours = track != tracks_.end() && track->second.entry.has_value();
    return is_ours || entriesOf(map_, family, id).empty();
  };
  std::vector<MarkerReading> readings;
  const auto add = [&](const MarkerReading& reading) {
    if (!isUnknown(reading.family, reading.id)) return;
    const bool is_known =
        std::any_of(readings.begin(), readings.end(), [&](const MarkerReading& other) {
          return other.id == reading.id && other.family == reading.family &&
                 (other.center - reading.center).norm() < 0.5 * meanEdge(reading.corners);
        });
    if (!is_known) readings.push_back(reading);
  };
  for (const MarkerReading& reading : result.explored) add(reading);
  return readings;
}

PoseEstimate MarkerMapper::honestPose(const FrameResult& result) const {
  PoseEstimate pose = *result.map_from_base;
  PoseVector own = PoseVector::Zero();
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted || !detection.map_entry) continue;
    const Marker& marker = map_.markers[*detection.map_entry];
    const double variance = marker.deviation * marker.deviation;
    const double range = std::max(0.1, std::isfinite(detection.range) ? detection.range : 0.1);
    const double turn_variance = variance / (range * range);
    own.head<3>() += Eigen::Vector3d(variance, variance, turn_variance);
    if (!result.is_on_floor)
      own.tail<3>() += Eigen::Vector3d(variance, turn_variance, turn_variance);
  }
  pose.covariance.diagonal() += own / std::max(1, result.acceptedMarkers());
  return pose;
}

bool MarkerMapper::keep(const MarkerSighting& sighting, Track* track) const {
  std::vector<MarkerSighting>& kept = track->sightings;
  const auto near = std::find_if(kept.begin(), kept.end(), [&](const MarkerSighting& other) {
    return distance(sighting, other) < config_.min_step;
  });
  if (near != kept.end()) {
    constexpr double kClearly = 0.7;
    if (vagueness(sighting) > kClearly * vagueness(*near)) return false;
    *near = sighting;
    return true;
  }
  kept.push_back(sighting);
  if (kept.size() > static_cast<std::size_t>(config_.max_sightings)) thin(&kept);
  return true;
}

bool MarkerMapper::isGoodEnough(const Track& track) const {
  const MarkerEstimate& estimate = *track.estimate;
  return track.repetitions < kRepetitions &&
         track.sightings.size() >= static_cast<std::size_t>(config_.min_sightings) &&
         parallax(estimate.marker.center(), track.sightings) >= config_.min_parallax &&
         estimate.agreement() >= config_.min_agreement && estimate.isUnambiguous() &&
         estimate.positionDeviation() <= config_.max_position_deviation &&
         estimate.orientationDeviation() <= config_.max_orientation_deviation;
}

std::vector<ProvisionalMarker> MarkerMapper::provisional() const {
  std::vector<ProvisionalMarker> markers;
  for (const auto& [key, track] : tracks_) {
    if (!track.estimate) continue;
    ProvisionalMarker marker;
    marker.estimate = *track.estimate;
    if (track.entry) marker.estimate.marker = map_.markers[*track.entry];
    marker.sightings = track.sightings.size();
    marker.parallax = parallax(marker.estimate.marker.center(), track.sightings);
    marker.is_used = track.entry.has_value();
    markers.push_back(std::move(marker));
  }
  return markers;
}

std::vector<Marker> MarkerMapper::unfinished() const {
  std::vector<Marker> markers;
  for (const auto& [key, track] : tracks_) {
    if (track.estimate && !track.entry && track.repetitions < kRepetitions) {
      markers.push_back(track.estimate->marker);
    }
  }
  return markers;
}

void MarkerMapper::setOwn(MarkerMap own) {
  for (auto track = tracks_.begin(); track != tracks_.end();) {
    const bool is_own = !entriesOf(own, track->first.first, track->first.second).empty();
    track = is_own ? tracks_.erase(track) : std::next(track);
  }
  // In the order that they had: others know them by their entries.
  std::vector<Track*> mapped;
  for (auto& [key, track] : tracks_) {
    if (track.entry) mapped.push_back(&track);
  }
  std::sort(mapped.begin(), mapped.end(),
            [](const Track* a, const Track* b) { return *a->entry < *b->entry; });
  for (Track* const track : mapped) {
    own.markers.push_back(map_.markers[*track->entry]);
    track->entry = own.markers.size() - 1;
  }
  map_ = std::move(own);
}

}  // namespace omnitag
