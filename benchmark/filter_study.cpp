// What a filter of (x, y, yaw) makes of the localizer's poses and of odometry: its NEES, which is 3
// where it is as certain as it may be, in drives among markers that are hidden half of the time
// (FilteredDrive). It fuses FrameResult::measured, which is what pose_measured publishes, or,
// wrongly, the pose itself. The last rows: a map whose markers hang off their places, in every
// image by the same.

#include <cstdio>
#include <vector>

#include "../test/support/filtered_drive.h"

int main() {
  using omnitag::test::FilterInput;
  constexpr std::size_t kFrames = 48;
  constexpr unsigned kDrives = 16;
  const omnitag::test::FilteredDrive drive(kFrames);
  std::printf(
      "fuses     map off by   NEES, mean   after 1 frame   7 more in sight   8 hidden   at the "
      "end\n");
  for (const double deviation : {0.0, 0.001, 0.005}) {
    for (const FilterInput input : {FilterInput::kMeasured, FilterInput::kPose}) {
      std::vector<double> all;
      std::vector<double> first;
      std::vector<double> seen;
      std::vector<double> hidden;
      std::vector<double> last;
      for (unsigned seed = 1; seed <= kDrives; ++seed) {
        const std::vector<double> nees = drive.nees(input, deviation, seed);
        all.insert(all.end(), nees.begin(), nees.end());
        first.push_back(nees.front());
        seen.push_back(nees[7]);
        hidden.push_back(nees[15]);
        last.push_back(nees.back());
      }
      std::printf("%-9s %7.0f mm %12.1f %15.1f %17.1f %10.1f %12.1f\n",
                  input == FilterInput::kMeasured ? "measured" : "pose", 1e3 * deviation,
                  omnitag::test::mean(all), omnitag::test::mean(first), omnitag::test::mean(seen),
                  omnitag::test::mean(hidden), omnitag::test::mean(last));
    }
  }
}
