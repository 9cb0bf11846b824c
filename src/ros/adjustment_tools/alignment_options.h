#pragma once

#include <Eigen/Core>
#include <boost/program_options/options_description.hpp>
#include <string>
#include <vector>

namespace omnitag {

/// A point of a map on a command line: a marker's name or id, and its x and y in another
/// map.
struct AlignPoint {
  std::string marker;
  Eigen::Vector2d place;
};

/// Into which frame a map that was built is to be put; none where it stays in its own.
struct AlignmentRequest {
  /// Of another localizer in the bags' tf.
  std::string frame;
  std::vector<AlignPoint> points;

  bool isNone() const { return frame.empty() && points.empty(); }
};

/// Adds --align-to and --align-point. Their values are refused where they are bad.
void addAlignmentOptions(AlignmentRequest* request,
                         boost::program_options::options_description* description);

/// Throws InputError where a request is for both, or for a single point.
void checkAlignment(const AlignmentRequest& request);

}  // namespace omnitag
