// Whether the localizer finds a pose where there is none to be found: panoramas full of clutter,
// but without a marker of the map, are shown to a localizer that searches. Ends with an error where
// a map of tag36h11 gave a pose; the smaller families, whose codes chance hits more often, are
// shown a tenth as many for comparison.
//
//   clutter_study [IMAGES]     10000 by default

#include <array>
#include <cstdio>
#include <string>

#include "clutter.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "program.h"
#include "recorded_sequence.h"

namespace omnitag {
namespace {

struct Tally {
  int images = 0;
  int with_detections = 0;
  int with_mapped_ids = 0;
  int poses = 0;
  double seconds = 0.0;
};

bool hasMappedId(const FrameResult& result, const MarkerMap& map) {
  for (const MarkerDetection& detection : result.detections) {
    if (!entriesOf(map, detection.family, detection.id).empty()) return true;
  }
  return false;
}

void show(const char* kind, const Tally& tally) {
  std::printf("%-15s %7d %9d %11d %6d %9.1f\n", kind, tally.images, tally.with_detections,
              tally.with_mapped_ids, tally.poses, 1e3 * tally.seconds / std::max(tally.images, 1));
}

/// The number of poses.
int study(const RecordedSequence& sequence, int images) {
  const Clutter clutter(sequence);
  Localizer localizer(sequence.camera, sequence.map, {});
  Frame frame = sequence.frames.front();
  std::printf("\n%-15s  images  with tags  mapped ids  poses  ms/image\n",
              sequence.map.markers.front().family.c_str());
  std::array<Tally, Clutter::kKinds> tallies;
  for (int i = 0; i < images; ++i) {
    const auto kind = static_cast<Clutter::Kind>(i % Clutter::kKinds);
    frame.image = clutter.image(kind, static_cast<std::uint64_t>(i));
    frame.stamp = i + 1.0;
    localizer.forgetPose();
    const FrameResult result = localizer.process(frame);
    Tally& tally = tallies.at(kind);
    ++tally.images;
    tally.with_detections += result.detections.empty() ? 0 : 1;
    tally.with_mapped_ids += hasMappedId(result, sequence.map) ? 1 : 0;
    tally.seconds += result.timings.total;
    if (!result.map_from_base) continue;
    ++tally.poses;
    std::printf("a pose from image %d, from %d markers\n", i, result.acceptedMarkers());
    std::fflush(stdout);
  }
  Tally sum;
  for (std::size_t kind = 0; kind < tallies.size(); ++kind) {
    const Tally& tally = tallies[kind];
    show(Clutter::name(static_cast<Clutter::Kind>(kind)), tally);
    sum.images += tally.images;
    sum.with_detections += tally.with_detections;
    sum.with_mapped_ids += tally.with_mapped_ids;
    sum.poses += tally.poses;
    sum.seconds += tally.seconds;
  }
  show("all", sum);
  return sum.poses;
}

bool run(int images) {
  RecordedSequence sequence = shippedSequence();
  const bool is_sound = study(sequence, images) == 0;
  for (const char* family : {"tag25h9", "tag16h5"}) {
    RecordedSequence other = sequence;
    for (Marker& marker : other.map.markers) marker.family = family;
    study(other, images / 10);
  }
  return is_sound;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("clutter_study", [&] {
    return omnitag::run(omnitag::countFrom(argc, argv, 10000, 1)) ? 0 : 1;
  });
}
