#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "recorded_sequence.h"

namespace omnitag {

/// Panoramas without any marker of the map, but with much that could be taken for one.
class Clutter {
 public:
  /// The map's markers must be of one family whose data is a square within a black border within a
  /// white one (tag16h5, tag25h9, tag36h10, tag36h11).
  explicit Clutter(const RecordedSequence& sequence);

  enum Kind {
    kNoise,
    kLines,
    kShapes,
    kCheckerboards,
    kText,
    /// Squares like tags, with random modules.
    kRandomTags,
    /// Tags of the map's family with ids that the map has not.
    kUnmappedTags,
    /// A frame of the sequence, all its markers painted over, with shapes before it.
    kRoom,
    kMixture,
    kKinds
  };
  static const char* name(Kind kind);

  /// CV_8UC1, of the camera's size; the same seed gives the same image.
  cv::Mat image(Kind kind, std::uint64_t seed) const;

 private:
  void draw(Kind kind, cv::RNG* random, cv::Mat* image) const;
  void drawTag(const cv::Mat& modules, cv::RNG* random, cv::Mat* image) const;
  cv::Mat randomModules(cv::RNG* random) const;

  std::vector<cv::Mat> rooms_;
  /// One pixel per module, white border included.
  std::vector<cv::Mat> unmapped_tags_;
};

}  // namespace omnitag
