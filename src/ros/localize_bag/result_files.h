#pragma once

#include <ros/time.h>

#include <fstream>
#include <string>

#include "omnitag/marker/marker_map.h"
#include "ros/image_localizer.h"

namespace omnitag {

/// The trajectory (TUM), the poses (CSV) and the detections (CSV) of a run.
class ResultFiles {
 public:
  /// A file with an empty path is not written. Throws InputError if one cannot be written.
  ResultFiles(const std::string& trajectory, const std::string& poses,
              const std::string& detections);

  /// Stamps in the trajectory increase: of images with the same stamp, the last one's pose stays,
  /// and images that were overtaken are left out.
  void add(const ros::Time& stamp, const LocalizedImage& localized, const MarkerMap& map);

  /// Adds a line without a pose to the poses, for a frame that could not be processed.
  void addUnusable(const ros::Time& stamp);

  /// Throws InputError if not everything could be written.
  void close();

 private:
  struct File {
    std::string path;
    std::ofstream stream;

    void open(const std::string& file_path);
    void close();
  };

  void writePose();
  void addDetection(const ros::Time& stamp, const MarkerDetection& detection, const MarkerMap& map);

  File trajectory_;
  /// The trajectory's last line, and its stamp.
  std::string last_line_;
  ros::Time last_stamp_;
  File poses_;
  File detections_;
};

}  // namespace omnitag
