#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "lit_patch.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/measurement/frame_equations.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/photometric_refinement.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {

/// One marker's share in the estimate of a frame's unknowns.
struct MarkerFit {
  MarkerPixels pixels;
  LitPatch patch;
  /// Because of its misplacement the marker tells less than its pixels.
  PoseMatrix misplacement;
  FrameEquations equations;

  /// The same equations with what they err by once the unknowns change so.
  FrameEquations equationsWithErrors(const PixelNoise& noise, const FrameVector& change) const;
};

/// What is estimated, and what is learnt on the way.
struct Alignment {
  Pose pose;
  ImagingError error = ImagingError::Zero();
  /// What the unknowns are expected to change by still: pixels count by how well they are explained
  /// then.
  FrameVector expected_change = FrameVector::Zero();
  PixelNoise noise;
  /// One for each marker; no light where it was not seen yet.
  std::vector<double> weights;
  std::vector<std::optional<Light>> lights;
};

/// Fits the markers of a map to a panorama, each by itself.
class MarkerFitter {
 public:
  /// One for each marker; nothing where it is not seen.
  using Fits = std::vector<std::optional<MarkerFit>>;

  /// All but the number of threads must outlive it. `entries`: the markers', in the map.
  MarkerFitter(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
               const TagPatterns& patterns, const std::vector<std::size_t>& entries,
               const PhotometricConfig& config, int threads)
      : panorama_(panorama),
        map_(map),
        camera_(camera),
        patterns_(patterns),
        entries_(entries),
        config_(config),
        threads_(threads) {}

  /// The parts of the panorama that show the markers, to find the pose from an initial one: where
  /// their pixels look is to be asked of their lines of sight.
  std::vector<MarkerPatch> roughPatches(const Pose& pose) const;

  /// What each marker says at the alignment's pose and camera error, near those of the patches.
  /// `lines` are the patches'.
  Fits fits(const std::vector<MarkerPatch>& patches, const std::vector<LinesOfSight>& lines,
            const Alignment& alignment) const;

  /// The pixels of each marker from a pose that is hardly to change any more: only those tell more
  /// of it that have an edge in them.
  std::vector<MarkerPixels> finePixels(const Pose& pose, const ImagingError& error) const;

  /// About as many of them, all together, as rough patches have.
  std::vector<MarkerPixels> someOf(const std::vector<MarkerPixels>& pixels) const;

  /// What they say at the pose that they are from, the alignment's.
  Fits fits(std::vector<MarkerPixels> pixels, const Alignment& alignment) const;

  /// What all markers' pixels say about the blur once the unknowns change so.
  BlurEquations blur(const Fits& fits, const PixelNoise& noise, const FrameVector& change) const;

  /// What all markers' residuals say about the pixels' noise once the pose changes so; some marker
  /// must be seen.
  PixelNoise noise(const Fits& fits, const FrameVector& change) const;

 private:
  std::optional<MarkerFit> fitOf(std::size_t index, MarkerPixels pixels,
                                 const Alignment& alignment) const;
  /// With at most this many pixels at edges, all together, except for what a marker needs. Large
  /// markers get more of them: they are near, and each of their pixels tells more of the pose.
  std::vector<MarkerPatch> patches(const MountedCamera& camera, const Pose& pose, int max_pixels,
                                   const MarkerPatch::Choice& choice,
                                   std::size_t worth_a_thread) const;
  /// Of a marker between its corners, in pixels, about; 0 where one of them is not seen.
  double areaOf(const Marker& marker, const Pose& pose) const;

  const cv::Mat& panorama_;
  const MarkerMap& map_;
  const MountedCamera& camera_;
  const TagPatterns& patterns_;
  const std::vector<std::size_t>& entries_;
  const PhotometricConfig& config_;
  int threads_;
};

}  // namespace omnitag
