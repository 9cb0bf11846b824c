#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <random>
#include <vector>

#include "camera/mounted_camera.h"
#include "omnitag/localization/frame_result.h"
#include "room.h"
#include "room_renderer.h"

namespace omnitag {

/// What is done to the robot in a room.
enum class Case {
  kMoved,       ///< a group of markers hangs elsewhere than the map says
  kUnmoved,     ///< nothing
  kCarriedOff,  ///< it is put elsewhere, and odometry does not tell
};

/// "moved", "unmoved" or "carried off".
const char* toString(Case what);

/// One frame of a drive, and what it shows.
struct TrialFrame {
  Pose truth;
  Pose odometry;
  cv::Mat image;
  /// Entries of the room's markers that are well in view: unhidden, facing the camera by less than
  /// 65 degrees, their edge longer than 8 pixels.
  std::vector<std::size_t> in_view;
};

/// A room, a drive through it and another one, on which the robot is carried off half-way.
struct Trial {
  Room room;
  MovedGroup group;
  std::vector<TrialFrame> drive;
  std::vector<TrialFrame> carried_off;
};

constexpr std::size_t kFrames = 40;
constexpr std::size_t kCarriedAt = 20;

/// What a frame gave, and how good that is.
struct JudgedFrame {
  FrameResult result;
  Pose truth;
  bool has_pose = false;
  double distance = 0.0;    // m, from the truth
  double deviations = 0.0;  // the same in standard deviations of x and y
  /// More than 5 deviations and 2 cm off.
  bool is_wrong = false;
  /// How many markers are in view that hang where the map says and that do not, and whether one
  /// that does has been, since the start or since the robot was carried off.
  int right_in_view = 0;
  int moved_in_view = 0;
  bool has_been_in_view = false;

  /// Whether markers do not tell by their number which of them hang where the map says.
  bool isOutvoted() const { return moved_in_view >= right_in_view && moved_in_view > 0; }
};

/// Makes trials for one camera, and localizes in them.
class Trials {
 public:
  explicit Trials(std::shared_ptr<const CameraModel> camera);

  /// The same for the same numbers, whatever was made before.
  Trial make(unsigned room, unsigned seed);

  /// Follows the robot through a trial from its true first pose.
  std::vector<JudgedFrame> follow(const Trial& trial, Case what, bool has_odometry) const;

  /// s that an image took on average.
  double imageTime() const;

 private:
  std::vector<TrialFrame> shoot(const Room& room, const std::vector<Pose>& route,
                                std::mt19937* generator);

  std::shared_ptr<const CameraModel> model_;
  MountedCamera camera_;
  RoomRenderer renderer_;
  double image_seconds_ = 0.0;
  int images_ = 0;
};

}  // namespace omnitag
