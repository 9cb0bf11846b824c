// What happens where a group of neighbouring markers, as on a shelf or a partition, hangs elsewhere
// than the map says, all by the same shift: drives through random rooms, with and without odometry.
// For comparison the same drives where the map is right, and where the robot is carried off.
//
//   group_study [ROOMS [SEED]] [-v]     600 rooms by default; -v: names rooms with wrong poses
//   group_study --room N [SEED]         all that is found in each frame of one room
//
// Poses are wrong that are more than 5 standard deviations and 2 cm off. Of these, `reckoned` stand
// on no marker, and `outvoted` are of images that show no fewer of the moved markers than of the
// others. `before`, not among them: wrong before any marker in its place had been in view. `rooms`:
// with a wrong pose. `missed`: without a pose though a marker in its place is in view.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "group_report.h"
#include "group_trial.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "program.h"
#include "statistics.h"

namespace omnitag {
namespace {

/// Sums over the drives of one row.
struct Tally {
  int rooms = 0;
  int frames = 0;
  int poses = 0;
  int wrong = 0;
  /// Before any marker that hangs where the map says had been in view.
  int wrong_before = 0;
  /// Of the wrong ones: those of odometry or the motion alone, and those that show no more markers
  /// that hang where the map says than others.
  int wrong_reckoned = 0;
  int wrong_outvoted = 0;
  int rooms_with_wrong = 0;
  /// Frames without a pose though such a marker is in view.
  int missed = 0;
  int right = 0;
  double squared_distance = 0.0;
  double seconds = 0.0;
  /// Frames from when the robot was carried off until a right pose, and how often there was none.
  std::vector<double> until_right;
  int never_right = 0;

  void add(const JudgedFrame& frame) {
    ++frames;
    seconds += frame.result.timings.total;
    if (!frame.has_pose) {
      missed += frame.right_in_view > 0 ? 1 : 0;
      return;
    }
    ++poses;
    if (frame.is_wrong) {
      addWrong(frame);
      return;
    }
    ++right;
    squared_distance += frame.distance * frame.distance;
  }

  void addWrong(const JudgedFrame& frame) {
    if (!frame.has_been_in_view) {
      ++wrong_before;
      return;
    }
    ++wrong;
    if (frame.result.mode == Mode::kDeadReckoning) ++wrong_reckoned;
    if (frame.isOutvoted()) ++wrong_outvoted;
  }

  void add(Case what, const std::vector<JudgedFrame>& drive) {
    ++rooms;
    const auto begin = drive.begin() + static_cast<std::ptrdiff_t>(firstFrame(what));
    std::for_each(begin, drive.end(), [this](const JudgedFrame& frame) { add(frame); });
    rooms_with_wrong += hasWrong(what, drive) ? 1 : 0;
    const auto found = std::find_if(begin, drive.end(), [](const JudgedFrame& frame) {
      return frame.has_pose && !frame.is_wrong;
    });
    never_right += found == drive.end() ? 1 : 0;
    until_right.push_back(static_cast<double>(found - begin));
  }
};

constexpr std::array<const char*, 4> kShifts = {"5-10 cm", "10-30 cm", "30 cm-1 m", "all"};
constexpr std::size_t kAllShifts = 3;

std::size_t classOf(double shift) { return shift < 0.1 ? 0 : shift < 0.3 ? 1 : 2; }

/// Everything that is summed up, each with odometry and without.
struct Tallies {
  std::array<std::array<Tally, kShifts.size()>, 2> moved;
  std::array<Tally, 2> unmoved;
  std::array<Tally, 2> carried_off;

  void add(const std::vector<JudgedFrame>& drive, const Trial& trial, Case what,
           bool has_odometry) {
    const std::size_t row = has_odometry ? 0 : 1;
    if (what == Case::kUnmoved) unmoved.at(row).add(what, drive);
    if (what == Case::kCarriedOff) carried_off.at(row).add(what, drive);
    if (what != Case::kMoved) return;
    moved.at(row).at(classOf(trial.group.shift)).add(what, drive);
    moved.at(row).at(kAllShifts).add(what, drive);
  }
};

const char* nameOf(std::size_t row) { return row == 0 ? "odometry" : "none"; }

void show(std::size_t row, const char* shift, const Tally& tally) {
  std::printf("%-9s %-10s %6d %7d %7d %6d %9d %9d %7d %6d %7d %8.2f mm %9.1f\n", nameOf(row), shift,
              tally.rooms, tally.frames, tally.poses, tally.wrong, tally.wrong_reckoned,
              tally.wrong_outvoted, tally.wrong_before, tally.rooms_with_wrong, tally.missed,
              1e3 * std::sqrt(tally.squared_distance / std::max(tally.right, 1)),
              1e3 * tally.seconds / std::max(tally.frames, 1));
}

void show(const Tallies& tallies) {
  std::printf(
      "\nodometry  shift       rooms  frames   poses  wrong  reckoned  outvoted  before  rooms  "
      "missed"
      "  RMSE right   ms/frame\n");
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t shift = 0; shift < kShifts.size(); ++shift) {
      show(row, kShifts.at(shift), tallies.moved.at(row).at(shift));
    }
  }
  for (std::size_t row = 0; row < 2; ++row) show(row, "none", tallies.unmoved.at(row));
  for (std::size_t row = 0; row < 2; ++row) {
    show(row, "carried", tallies.carried_off.at(row));
  }
  std::printf(
      "\ncarried off: frames until a right pose\nodometry  median  95 %%  never of rooms\n");
  for (std::size_t row = 0; row < 2; ++row) {
    const Tally& tally = tallies.carried_off.at(row);
    std::printf("%-9s %6.0f %5.0f %6d %8d\n", nameOf(row), quantile(tally.until_right, 0.5),
                quantile(tally.until_right, 0.95), tally.never_right, tally.rooms);
  }
}

struct Arguments {
  unsigned rooms = 600;
  unsigned seed = 1;
  bool is_verbose = false;
  bool is_one_room = false;
  unsigned room = 0;
};

unsigned numberFrom(const std::string& text) {
  char* end = nullptr;
  const unsigned long number = std::strtoul(text.c_str(), &end, 10);
  constexpr unsigned long kMost = 100000000;
  if (text.empty() || *end != '\0' || number > kMost) {
    throw InputError("expected [ROOMS [SEED]] [-v], or --room N [SEED]");
  }
  return static_cast<unsigned>(number);
}

Arguments argumentsFrom(int argc, char** argv) {
  std::vector<std::string> texts(argv + 1, argv + argc);
  Arguments arguments;
  if (!texts.empty() && texts.back() == "-v") {
    arguments.is_verbose = true;
    texts.pop_back();
  }
  if (!texts.empty() && texts.front() == "--room") {
    arguments.is_one_room = true;
    texts.erase(texts.begin());
  }
  if (texts.size() > 2 || (arguments.is_one_room && texts.empty())) numberFrom("");
  if (!texts.empty()) {
    (arguments.is_one_room ? arguments.room : arguments.rooms) = numberFrom(texts.front());
  }
  if (texts.size() > 1) arguments.seed = numberFrom(texts.back());
  return arguments;
}

constexpr std::array<Case, 3> kCases = {Case::kMoved, Case::kUnmoved, Case::kCarriedOff};

void studyRooms(const Arguments& arguments, Trials* trials) {
  Tallies tallies;
  for (unsigned room = 0; room < arguments.rooms; ++room) {
    const Trial trial = trials->make(room, arguments.seed);
    for (const Case what : kCases) {
      for (const bool has_odometry : {true, false}) {
        const std::vector<JudgedFrame> drive = trials->follow(trial, what, has_odometry);
        tallies.add(drive, trial, what, has_odometry);
        if (arguments.is_verbose) showWrong(room, trial, what, has_odometry, drive);
      }
    }
  }
  show(tallies);
  std::printf("%.1f ms to draw an image\n", 1e3 * trials->imageTime());
}

void studyOneRoom(const Arguments& arguments, Trials* trials) {
  const Trial trial = trials->make(arguments.room, arguments.seed);
  showRoom(trial);
  for (const Case what : kCases) {
    for (const bool has_odometry : {true, false}) {
      showDrive(trial, what, has_odometry, trials->follow(trial, what, has_odometry));
    }
  }
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("group_study", [&] {
    const omnitag::Arguments arguments = omnitag::argumentsFrom(argc, argv);
    omnitag::Trials trials(
        omnitag::loadCamera(std::string(PACKAGE_DIR) + "/config/cameras/paper.yaml"));
    if (arguments.is_one_room) {
      omnitag::studyOneRoom(arguments, &trials);
    } else {
      omnitag::studyRooms(arguments, &trials);
    }
    return 0;
  });
}
