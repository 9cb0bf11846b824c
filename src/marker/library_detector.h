#pragma once

#include <apriltag/apriltag.h>

#include <memory>

#include "marker/tag_detector.h"

namespace omnitag {

struct DestroyLibraryDetector {
  void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
};

/// A detector of the AprilTag library.
using LibraryDetector = std::unique_ptr<apriltag_detector_t, DestroyLibraryDetector>;

/// With these settings, and without families.
LibraryDetector createLibraryDetector(const TagDetectorConfig& config);

}  // namespace omnitag
