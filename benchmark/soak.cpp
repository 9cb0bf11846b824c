// Whether memory stays flat: the shipped frames over and over, with stamps that go on. The robot
// jumps back to its start after the last frame, so that searching has its share. Ends with an error
// where memory grew after the first thousand frames.
//
//   soak [FRAMES]     20000 by default

#include <cstdio>
#include <string>

#include "omnitag/localization/localizer.h"
#include "process_memory.h"
#include "program.h"
#include "recorded_sequence.h"

namespace omnitag {
namespace {

constexpr int kWarmUp = 1000;
/// What the heap may gain by being cut up.
constexpr double kMaxGrowth = 4.0;

bool run(int frames) {
  const RecordedSequence sequence = shippedSequence();
  Localizer localizer(sequence.camera, sequence.map, {});
  const double duration = sequence.frames.back().stamp - sequence.frames.front().stamp + 1.0;
  std::printf("frames   poses   VmRSS\n");
  std::printf("%6d %7d %7.1f MB\n", 0, 0, processMemory("VmRSS"));
  const int per_lap = static_cast<int>(sequence.frames.size());
  int poses = 0;
  double after_warm_up = 0.0;
  for (int i = 0; i < frames; ++i) {
    Frame frame = sequence.frames[static_cast<std::size_t>(i % per_lap)];
    frame.stamp += duration * (i / per_lap);
    if (localizer.process(frame).map_from_base) ++poses;
    if (i + 1 == kWarmUp) after_warm_up = processMemory("VmRSS");
    if ((i + 1) % kWarmUp == 0 || i + 1 == frames) {
      std::printf("%6d %7d %7.1f MB\n", i + 1, poses, processMemory("VmRSS"));
      std::fflush(stdout);
    }
  }
  const double growth = processMemory("VmRSS") - after_warm_up;
  std::printf("grew by %.1f MB after the first %d frames\n", growth, kWarmUp);
  return growth <= kMaxGrowth;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("soak", [&] {
    return omnitag::run(omnitag::countFrom(argc, argv, 20000, omnitag::kWarmUp + 1)) ? 0 : 1;
  });
}
