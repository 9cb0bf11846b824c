#include "ros/adjustment_tools/camera_output.h"

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <system_error>
#include <vector>

#include "adjustment/leaning_mounting.h"
#include "common/format.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "ros/bag_tools/mounting_option.h"

namespace omnitag {
namespace {

/// One parameter; angles in degrees.
std::string lineOf(const CalibratedParameter& parameter) {
  const CalibrationParameter& guess = parameter.guess;
  const bool is_angle = guess.unit == "rad";
  const double factor = is_angle ? degrees(1.0) : 1.0;
  const std::string unit = is_angle ? "deg" : guess.unit;
  const std::string name = guess.name + (unit.empty() ? "" : " (" + unit + ")");
  const std::string deviation = parameter.held.empty()
                                    ? format("%.2g", factor * parameter.deviation)
                                    : "held: " + parameter.held;
  return format("%-26s %12.6g %12.7g   %s", name.c_str(), factor * guess.value,
                factor * parameter.value, deviation.c_str());
}

std::string asComment(const std::string& text) {
  std::istringstream lines(text);
  std::string comment;
  for (std::string line; std::getline(lines, line);) {
    comment += line.empty() ? "#\n" : "# " + line + "\n";
  }
  return comment;
}

std::string summaryOf(const char* name, const ResidualSummary& summary) {
  return format("%-26s %12.3f   RMS over %zu corners, %zu left out\n", name, summary.rms,
                summary.counted, summary.left_out);
}

std::string mountingReport(const Eigen::Isometry3d& base_from_camera,
                           const MountingFrames& frames) {
  return "\nMounting (the optical axis leans by " +
         format("%.2f", degrees(leanOf(base_from_camera))) +
         " deg), for tf:\n  rosrun tf2_ros static_transform_publisher " +
         publisherArguments(base_from_camera) + " " + frames.base + " " + frames.camera +
         "\nand for bags whose /tf_static is older: --mounting " + mountingText(base_from_camera) +
         "\nIts x, y and yaw are the guess's: images cannot tell them from the robot's own place "
         "and heading.\n";
}

}  // namespace

std::string calibrationReport(const CalibrationResult& result,
                              const std::optional<MountingFrames>& frames) {
  std::string report =
      format("%-26s %12s %12s   %s\n", "parameter", "guess", "calibrated", "standard deviation");
  for (const CalibratedParameter& parameter : result.parameters) report += lineOf(parameter) + "\n";
  report += "\n" + summaryOf("residual before (px)", result.before);
  report += summaryOf("residual after (px)", result.after);
  report += format("%-26s %12.3f   of a corner, along each axis; %zu images, %zu markers\n",
                   "noise (px)", result.noise, result.frames, result.markers);
  const CameraUncertainty& left = result.uncertainty;
  report +=
      format("left of the camera (px)    principal point %.3f, scale %.3f, tilt %.3f, rim %.3f\n",
             left.principal_point, left.scale, left.tilt, left.rim);
  if (frames) report += mountingReport(result.base_from_camera, *frames);
  if (!result.remarks.empty()) report += "\n";
  for (const std::string& remark : result.remarks) report += remark + "\n";
  return report;
}

std::string calibratedFile(const CalibrationResult& result, const CameraTemplate& guess,
                           const std::optional<MountingFrames>& frames) {
  return "# Calibrated by calibrate_camera from the guess " + guess.origin() + ".\n#\n" +
         asComment(calibrationReport(result, frames)) +
         guess.text(result.camera_values, result.rim_radius, result.uncertainty);
}

void writeAtomically(const std::string& path, const std::string& content) {
  const std::string temporary = path + ".part";
  std::error_code error;
  {
    std::ofstream file(temporary, std::ios::binary);
    file << content;
    file.close();
    if (!file) {
      std::filesystem::remove(temporary, error);
      throw InputError(path + ": cannot be written");
    }
  }
  std::filesystem::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InputError(path + ": cannot be written: " + error.message());
  }
}

void writePicture(const std::string& path, const cv::Mat& picture) {
  const std::string extension = std::filesystem::path(path).extension().string();
  std::vector<unsigned char> bytes;
  try {
    cv::imencode(extension.empty() ? ".png" : extension, picture, bytes);
  } catch (const cv::Exception&) {
    throw InputError(path + ": cannot be written: expected the extension of a picture, as in .png");
  }
  writeAtomically(path, std::string(bytes.begin(), bytes.end()));
}

}  // namespace omnitag
