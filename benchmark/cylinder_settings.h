#pragma once

#include <opencv2/core/types.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "marker/tag_detector.h"
#include "recorded_sequence.h"
#include "unwrapped_panorama.h"
#include "visible_markers.h"

namespace omnitag {

/// How markers are read in an unwrapped panorama; as this package's detector reads them by default.
struct CylinderSettings {
  RowSpacing rows = RowSpacing::kSquare;
  int interpolation = cv::INTER_LINEAR;
  TagDetectorConfig detector;
};

/// What differs from the defaults, in words.
std::string describe(const CylinderSettings& settings);

/// Unwraps the frames of a sequence, which must outlive it, and reads what is on the cylinder.
class CylinderReader {
 public:
  CylinderReader(const RecordedSequence& sequence, const CylinderSettings& settings);

  std::vector<FoundMarker> read(std::size_t frame) const;

  cv::Size size() const { return panorama_.size(); }

 private:
  const RecordedSequence& sequence_;
  int interpolation_;
  UnwrappedPanorama panorama_;
  TagDetector detector_;
};

/// How settings do on a sequence, which must outlive it.
class CylinderTrial {
 public:
  /// rad: markers that are turned away by more do not count.
  CylinderTrial(const RecordedSequence& sequence, double max_incidence);

  struct Outcome {
    int found = 0;
    /// s of processor time, over all frames.
    double time = 0.0;
  };

  /// Stops after the frame at which the time passes `patience` (s).
  Outcome of(const CylinderSettings& settings, double patience) const;

 private:
  const RecordedSequence& sequence_;
  std::vector<std::vector<PredictedMarker>> visible_;
};

/// Settings that find the most markers, and of those that find as many the fastest.
CylinderSettings settingsThatFindMost(const CylinderTrial& trial);

/// The fastest settings that find no fewer markers than this package's.
CylinderSettings fastestSettings(const CylinderTrial& trial);

}  // namespace omnitag
