#include "localization/saved_pose.h"

#include <Eigen/Cholesky>
#include <vector>

#include "common/format.h"
#include "common/yaml_reader.h"

namespace omnitag {
namespace {

constexpr int kSize = 6;

std::string number(double value) { return format("%.10g", value); }

SavedPose readSavedPose(const YamlReader& reader) {
  reader.allowOnly({"frame_id", "stamp", "pose", "covariance"});
  SavedPose saved;
  saved.map_frame = reader.text("frame_id");
  saved.stamp = reader.number("stamp");
  const std::vector<double> pose = reader.numbers("pose", kSize);
  saved.map_from_base.pose = {pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]};
  const auto rows = reader.table("covariance", kSize);
  PoseMatrix& covariance = saved.map_from_base.covariance;
  if (rows.size() != kSize) reader.refuse("covariance", "6 rows");
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      covariance(row, column) =
          rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
  }
  const bool is_symmetric = covariance.isApprox(covariance.transpose(), 1e-6);
  const Eigen::LDLT<PoseMatrix> factors(covariance);
  if (!is_symmetric || !factors.isPositive()) {
    reader.refuse("covariance", "a symmetric matrix that is not negative");
  }
  return saved;
}

}  // namespace

std::string textOf(const SavedPose& saved) {
  const Pose& pose = saved.map_from_base.pose;
  std::string text = "# Where the robot was last: x, y (m), yaw (rad), z (m), roll, pitch (rad).\n";
  text += "frame_id: " + saved.map_frame + "\nstamp: " + format("%.9f", saved.stamp) + "\npose: [" +
          number(pose.x) + ", " + number(pose.y) + ", " + number(pose.yaw) + ", " + number(pose.z) +
          ", " + number(pose.roll) + ", " + number(pose.pitch) + "]\ncovariance:\n";
  for (int row = 0; row < kSize; ++row) {
    text += "  - [";
    for (int column = 0; column < kSize; ++column) {
      text += (column > 0 ? ", " : "") + number(saved.map_from_base.covariance(row, column));
    }
    text += "]\n";
  }
  return text;
}

SavedPose parseSavedPose(const std::string& text, const std::string& origin) {
  return readSavedPose(YamlReader::fromText(text, origin));
}

SavedPose loadSavedPose(const std::string& path) {
  return readSavedPose(YamlReader::fromFile(path));
}

PoseEstimate afterAPause(const PoseEstimate& saved, double position_deviation,
                         double heading_deviation) {
  PoseEstimate estimate = saved;
  PoseVector deviations = PoseVector::Zero();
  deviations.head<3>() << position_deviation, position_deviation, heading_deviation;
  estimate.covariance.diagonal() += deviations.cwiseAbs2();
  return estimate;
}

}  // namespace omnitag
