#include "marker/library_detector.h"

#include <cmath>

namespace omnitag {

LibraryDetector createLibraryDetector(const TagDetectorConfig& config) {
  LibraryDetector detector(apriltag_detector_create());
  detector->quad_decimate = static_cast<float>(config.quad_decimate);
  detector->quad_sigma = static_cast<float>(config.quad_sigma);
  detector->refine_edges = config.refine_edges;
  detector->decode_sharpening = config.decode_sharpening;
  detector->qtp.min_cluster_pixels = config.min_cluster_pixels;
  detector->qtp.max_nmaxima = config.max_nmaxima;
  // Which of the two is used depends on the library's version.
  detector->qtp.critical_rad = static_cast<float>(config.critical_angle);
  detector->qtp.cos_critical_rad = static_cast<float>(std::cos(config.critical_angle));
  detector->qtp.max_line_fit_mse = static_cast<float>(config.max_line_fit_mse);
  detector->qtp.deglitch = config.deglitch ? 1 : 0;
  return detector;
}

}  // namespace omnitag
