#pragma once

#include <Eigen/Core>
#include <boost/program_options/options_description.hpp>
#include <string>
#include <vector>

namespace omnitag {

/// A point of a map on a command line: the name or id of a marker, and its x and y in another map.
struct AlignPoint {
  std::string marker;
  Eigen::Vector2d place;
};

/// The frame to put a map into that was built; none: it stays in its own.
struct AlignmentRequest {
  /// The frame of another localizer, in the bags' tf.
  std::string frame;
  std::vector<AlignPoint> points;

  bool isNone() const { return frame.empty() && points.empty(); }
};

/// Adds --align-to and --align-point. Bad values are refused.
void addAlignmentOptions(AlignmentRequest* request,
                         boost::program_options::options_description* description);

/// Throws InputError if a request has both, or a single point.
void checkAlignment(const AlignmentRequest& request);

}  // namespace omnitag
