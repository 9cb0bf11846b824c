#include "adjustment/reading_alignment.h"

#include <optional>
#include <utility>

#include "adjustment/corner_alignment.h"
#include "localization/pose_estimator.h"
#include "localization/relocalization.h"

namespace omnitag {

std::vector<MarkerReading> alignReadings(const cv::Mat& panorama, const MarkerMap& map,
                                         const TagPatterns& patterns, const MountedCamera& camera,
                                         const PosePrior& standing,
                                         std::vector<MarkerReading> readings) {
  const EstimatorConfig estimation;
  const Relocalization found =
      relocalize(map, camera, readings, standing, estimation, RelocalizationConfig());
  std::vector<MarkerReading> aligned;
  if (!found.map_from_base) return aligned;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (!found.entries[i]) continue;
    const Marker& marker = map.markers[*found.entries[i]];
    const std::optional<AlignedCorners> corners =
        alignCorners(panorama, marker, patterns.of(marker), camera, found.map_from_base->pose);
    if (!corners) continue;
    aligned.push_back(std::move(readings[i]));
    for (std::size_t k = 0; k < 4; ++k) {
      aligned.back().corners[k] = corners->pixels.segment<2>(2 * static_cast<Eigen::Index>(k));
    }
  }
  return aligned;
}

}  // namespace omnitag
