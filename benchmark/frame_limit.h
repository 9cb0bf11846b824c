#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core/mat.hpp>
#include <set>
#include <string>

#include "camera/mounted_camera.h"
#include "measurement/frame_equations.h"
#include "measurement/pose_prior.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a sequence was rendered.
struct Rendering {
  /// Grey levels, standard deviation before rounding.
  double noise = 3.0;
  /// Rays across a pixel on an edge, of which it is the mean.
  int samples = 4;
};

/// From the arguments NOISE SAMPLES. Throws InputError.
Rendering renderingFrom(const std::string& noise, const std::string& samples);

struct MarkerInformation {
  FrameEquations exact;
  /// With the renderer's noise on edges.
  FrameEquations sampled;
};

/// What each marker in sight tells about a frame's unknowns, by its entry in the map.
using Informations = std::map<std::size_t, MarkerInformation>;

/// Of the markers that the tracker would look for (VisibilityConfig) where the robot really is, in
/// a map that is right. Those that something hides, so that their pixels do not correlate with the
/// pattern, are left out.
Informations markersInSight(const cv::Mat& image, const MountedCamera& camera, const MarkerMap& map,
                            const Pose& truth, const Rendering& rendering,
                            const std::set<std::size_t>& used = {});

/// The least covariance of a frame's unknowns (Cramer-Rao with priors) for whom knows, beside the
/// pixels, nothing but `prior`, by how much each marker may hang elsewhere than `map` says, and
/// that each part of the imaging error has the standard deviation 1. With the renderer's noise on
/// edges.
FrameMatrix leastCovariance(const Informations& in_sight, const MarkerMap& map, const Pose& truth,
                            const PosePrior& prior);

}  // namespace omnitag
