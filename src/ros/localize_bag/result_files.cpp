#include "ros/localize_bag/result_files.h"

#include <cmath>
#include <optional>

#include "common/format.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

std::string number(double value) { return std::isfinite(value) ? format("%.9f", value) : ""; }

std::string stampOf(const ros::Time& stamp) { return format("%u.%09u", stamp.sec, stamp.nsec); }

/// A field of a CSV file, in quotes if it needs them.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

void ResultFiles::File::open(const std::string& file_path) {
  if (file_path.empty()) return;
  path = file_path;
  stream.open(path);
  if (!stream) throw InputError(path + ": cannot be written");
}

void ResultFiles::File::close() {
  if (!stream.is_open()) return;
  stream.close();
  if (!stream) throw InputError(path + ": cannot be written to its end");
}

ResultFiles::ResultFiles(const std::string& trajectory, const std::string& poses,
                         const std::string& detections) {
  trajectory_.open(trajectory);
  poses_.open(poses);
  detections_.open(detections);
  poses_.stream << "stamp,x,y,yaw,cov_xx,cov_xy,cov_xyaw,cov_yy,cov_yyaw,cov_yawyaw,mode,"
                   "markers_used,z,roll,pitch,cov_zz,cov_rollroll,cov_pitchpitch\n";
  detections_.stream << "stamp,id,family,name,map_entry,accepted,reason,bearing,range,residual,"
                        "u0,v0,u1,v1,u2,v2,u3,v3\n";
}

void ResultFiles::writePose() {
  trajectory_.stream << last_line_;
  last_line_.clear();
}

void ResultFiles::add(const ros::Time& stamp, const LocalizedImage& localized,
                      const MarkerMap& map) {
  const FrameResult& result = localized.result;
  for (const MarkerDetection& detection : result.detections) addDetection(stamp, detection, map);
  poses_.stream << stampOf(stamp);
  if (localized.is_newest) {
    writePose();
    last_stamp_ = stamp;
  }
  const auto estimate = result.map_from_base ? std::optional(result.publishedPose()) : std::nullopt;
  if (estimate) {
    const Pose& pose = estimate->pose;
    const Eigen::Quaterniond rotation(pose.toIsometry().linear());
    if (stamp == last_stamp_) {
      last_line_ = stampOf(stamp);
      for (const double value :
           {pose.x, pose.y, pose.z, rotation.x(), rotation.y(), rotation.z(), rotation.w()}) {
        last_line_ += ' ' + number(value);
      }
      last_line_ += '\n';
    }
    poses_.stream << ',' << number(pose.x) << ',' << number(pose.y) << ',' << number(pose.yaw);
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        poses_.stream << ',' << format("%.9e", estimate->covariance(row, column));
      }
    }
  } else {
    poses_.stream << ",,,,,,,,,";
  }
  poses_.stream << ',' << toString(result.mode) << ',' << result.acceptedMarkers();
  if (estimate) {
    const Pose& pose = estimate->pose;
    for (const double value : {pose.z, pose.roll, pose.pitch}) {
      poses_.stream << ',' << number(value);
    }
    for (int i = 3; i < 6; ++i) poses_.stream << ',' << format("%.9e", estimate->covariance(i, i));
  } else {
    poses_.stream << ",,,,,,";
  }
  poses_.stream << '\n';
}

void ResultFiles::addUnusable(const ros::Time& stamp) {
  poses_.stream << stampOf(stamp) << ",,,,,,,,,," << toString(Mode::kSearching) << ",0,,,,,,\n";
}

void ResultFiles::addDetection(const ros::Time& stamp, const MarkerDetection& detection,
                               const MarkerMap& map) {
  std::ofstream& stream = detections_.stream;
  stream << stampOf(stamp) << ',' << detection.id << ',' << detection.family << ',';
  if (detection.map_entry) {
    stream << field(map.markers[*detection.map_entry].name) << ',' << *detection.map_entry;
  } else {
    stream << ",-1";
  }
  stream << ',' << (detection.accepted ? 1 : 0) << ',' << field(detection.reason) << ','
         << number(detection.bearing) << ',' << number(detection.range) << ','
         << number(detection.residual);
  for (const Eigen::Vector2d& corner : detection.corners) {
    stream << ',' << number(corner.x()) << ',' << number(corner.y());
  }
  stream << '\n';
}

void ResultFiles::close() {
  writePose();
  trajectory_.close();
  poses_.close();
  detections_.close();
}

}  // namespace omnitag
