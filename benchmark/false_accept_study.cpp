// How often something else is taken for a marker that is predicted somewhere: every marker in view
// of a sequence is taken for each other id of its family, or each other picture of the map in each
// of four turns, and the map's markers are looked for where a random pose predicts them, amid
// clutter and plain walls. Prints, for the markers as they are, how many are recognized, by the
// width of their modules.
//
//   false_accept_study [BAG CAMERA MAP]     a bag of render_sequence; the shipped one by default

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "marker/marker_families.h"
#include "marker/tag_family.h"
#include "omnitag/common/angle.h"
#include "photometry/recognition.h"
#include "program.h"
#include "recorded_sequence.h"
#include "visible_markers.h"

namespace omnitag {
namespace {

/// Of all trials, those that were accepted; and the nearest that any came to its threshold.
struct Count {
  long trials = 0;
  long untested = 0;
  long accepted = 0;
  double nearest = -1.0;

  void add(const std::optional<Recognition>& recognition) {
    ++trials;
    if (!recognition) {
      ++untested;
      return;
    }
    nearest = std::max(nearest, recognition->correlation - recognition->threshold);
    if (recognition->is_accepted) ++accepted;
  }

  void print(const char* name) const {
    std::printf("%-32s %9ld trials %9ld untested %6ld accepted   nearest %+.3f\n", name, trials,
                untested, accepted, nearest);
  }
};

/// What a marker may be taken for.
struct Member {
  int id;
  int quarters;
  TagPattern pattern;
};

/// All ids of the family of a map's first marker, or all pictures of the map, in four turns.
std::vector<Member> membersLike(const MarkerMap& map) {
  std::vector<Member> members;
  const Marker& first = map.markers.front();
  if (!first.picture) {
    for (int id = 0; id < tagCount(first.family); ++id) {
      members.push_back({id, 0, TagPattern(first.family, id)});
    }
    return members;
  }
  for (const auto& [id, picture] : familiesOf(map).pictures) {
    for (int quarters = 0; quarters < 4; ++quarters) {
      members.push_back({id, quarters, TagPattern(*picture)});
    }
  }
  return members;
}

/// The marker, turned counter-clockwise.
Marker turned(Marker marker, int quarters) {
  marker.map_from_marker.rotate(
      Eigen::AngleAxisd(radians(90.0) * quarters, Eigen::Vector3d::UnitZ()));
  return marker;
}

constexpr std::array<double, 10> kWidths = {0.0, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0};

void run(const RecordedSequence& sequence) {
  VisibilityConfig visibility;
  visibility.max_incidence = radians(60.0);
  visibility.min_edge_pixels = 6.0;
  const RecognitionConfig config;
  PoseEstimate belief;
  constexpr double kPositionDeviation = 0.01;
  const double heading_deviation = radians(0.3);
  belief.covariance.diagonal().head<3>() << kPositionDeviation * kPositionDeviation,
      kPositionDeviation * kPositionDeviation, heading_deviation * heading_deviation;
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  const std::vector<Member> members = membersLike(sequence.map);
  const TagPatterns patterns(sequence.map);

  std::array<Count, kWidths.size()> right;
  Count other_id;
  Count elsewhere;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const Frame& frame = sequence.frames[i];
    const MountedCamera camera(sequence.camera, frame.base_from_camera);
    const Pose& truth = sequence.truth[i];
    belief.pose = {truth.x + kPositionDeviation * normal(generator),
                   truth.y + kPositionDeviation * normal(generator),
                   truth.yaw + heading_deviation * normal(generator)};
    const auto lookFor = [&](const PoseEstimate& pose, const PredictedMarker& marker) {
      const Marker& mapped = sequence.map.markers[marker.map_entry];
      return recognize(frame.image, mapped, patterns.of(mapped), camera, pose.pose, marker, config);
    };
    for (const PredictedMarker& marker : predictMarkers(sequence.map, camera, belief, visibility)) {
      const Marker& mapped = sequence.map.markers[marker.map_entry];
      const double width = tangentialWidth(marker, sequence);
      const auto bin = std::upper_bound(kWidths.begin(), kWidths.end(), width) - kWidths.begin();
      right[static_cast<std::size_t>(bin - 1)].add(lookFor(belief, marker));
      for (const Member& member : members) {
        if (member.id == mapped.id && member.quarters == 0) continue;
        other_id.add(recognize(frame.image, turned(mapped, member.quarters), member.pattern, camera,
                               belief.pose, marker, config));
      }
    }
    constexpr int kWrongPoses = 60;
    constexpr double kClear = 40.0;  // pixels
    for (int k = 0; k < kWrongPoses; ++k) {
      PoseEstimate wrong = belief;
      wrong.pose.x += 0.5 * normal(generator);
      wrong.pose.y += 0.5 * normal(generator);
      wrong.pose.yaw = std::uniform_real_distribution<double>(-kPi, kPi)(generator);
      for (const PredictedMarker& marker :
           predictMarkers(sequence.map, camera, wrong, visibility)) {
        const Marker& mapped = sequence.map.markers[marker.map_entry];
        const auto true_place = camera.pixelFromMap(truth, mapped.center());
        if (true_place && (*true_place - marker.center).norm() < kClear) continue;
        elsewhere.add(lookFor(wrong, marker));
      }
    }
  }
  other_id.print("another marker of the family");
  elsewhere.print("predicted by a random pose");
  std::printf("markers as they are, by pixels per module along the tangent\n");
  for (std::size_t bin = 0; bin < kWidths.size(); ++bin) {
    char name[32];
    std::snprintf(name, sizeof(name), "  from %.2f", kWidths[bin]);
    right[bin].print(name);
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("false_accept_study", [&] {
    omnitag::run(omnitag::sequenceFrom(argc, argv));
    return 0;
  });
}
