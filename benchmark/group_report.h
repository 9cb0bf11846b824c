#pragma once

#include <cstddef>
#include <vector>

#include "group_trial.h"

namespace omnitag {

/// The first frame that counts: of one that is carried off, the first after that.
std::size_t firstFrame(Case what);

/// Whether a pose of a drive is wrong, from its first frame that counts on, though a marker that
/// hangs where the map says had been in view.
bool hasWrong(Case what, const std::vector<JudgedFrame>& drive);

/// Prints a line with the wrong poses of a drive, where it has some: for each the frame, how far it
/// is off, in mm and standard deviations, and how many markers are in view that hang where the map
/// says and that do not.
void showWrong(unsigned room, const Trial& trial, Case what, bool has_odometry,
               const std::vector<JudgedFrame>& drive);

/// Prints a room and its markers.
void showRoom(const Trial& trial);

/// Prints a line for each frame of a drive and one for each of its detections.
void showDrive(const Trial& trial, Case what, bool has_odometry,
               const std::vector<JudgedFrame>& drive);

}  // namespace omnitag
