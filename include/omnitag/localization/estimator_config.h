#pragma once

#include "omnitag/localization/reprojection_config.h"
#include "omnitag/photometry/photometric_config.h"

namespace omnitag {

class YamlReader;

/// How a pose is computed from the observed markers.
enum class EstimatorKind {
  kTriangulation,  ///< the paper's: bearings of the centres, Eqns 1 and 2
  kReprojection,   ///< all corners, in the panoramic image
  kPhotometric,    ///< all pixels of the markers, starting from the corners
};

struct EstimatorConfig {
  EstimatorKind kind = EstimatorKind::kPhotometric;
  ReprojectionConfig reprojection;
  /// Standard deviations (Misfit): a marker that is farther off is rejected.
  double max_misfit = 7.0;
  PhotometricConfig photometric;
  /// Pixels of the panorama: assumed standard deviation of the lens's blur until the images
  /// show it.
  double blur = 0.0;
};

/// Reads the keys of ReprojectionConfig, max_misfit, blur, and those of PhotometricConfig; absent
/// ones keep their defaults. Throws InputError.
EstimatorConfig readEstimatorConfig(const YamlReader& reader);

}  // namespace omnitag
