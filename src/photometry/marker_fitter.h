#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "measurement/frame_equations.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/photometry/blur_equations.h"
#include "photometry/lit_patch.h"
#include "photometry/marker_patch.h"
#include "photometry/photometric_refinement.h"
#include "photometry/pixel_noise.h"

namespace omnitag {

/// One marker's contribution to the estimate of a frame's unknowns.
struct MarkerFit {
  MarkerPixels pixels;
  LitPatch patch;
  /// Covariance of the pose's error due to the marker's misplacement: the pixels alone would
  /// determine the pose too well.
  PoseMatrix misplacement;
  FrameEquations equations;

  /// The same equations with their errors after this change of the unknowns.
  FrameEquations equationsWithErrors(const PixelNoise& noise, const FrameVector& change) const;
};

/// The estimate, and what is learnt along the way.
struct Alignment {
  Pose pose;
  ImagingError error = ImagingError::Zero();
  /// The change of the unknowns that is still expected: it determines the residuals that the pixels
  /// are weighted by.
  FrameVector expected_change = FrameVector::Zero();
  PixelNoise noise;
  /// One for each marker; no light if the marker was not seen yet.
  std::vector<double> weights;
  std::vector<std::optional<Light>> lights;
  std::vector<Shape> shapes;
  /// The change of the shapes that is still expected.
  std::vector<Shape> expected_shape_changes;
};

/// Fits the markers of a map to a panorama, each by itself.
class MarkerFitter {
 public:
  /// One for each marker; nothing if it is not seen.
  using Fits = std::vector<std::optional<MarkerFit>>;

  /// The references must outlive it. `entries`: the markers' indices in the map.
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

  /// The parts of the panorama that show the markers, for an alignment from an initial pose. At
  /// other poses, their lines of sight give what their pixels see.
  std::vector<MarkerPatch> roughPatches(const Pose& pose) const;

  /// Each marker's fit at the alignment's pose, camera error and shapes, which must be near those
  /// of the patches. `lines`: from linesOfSight() of the patches.
  Fits fits(const std::vector<MarkerPatch>& patches, const std::vector<LinesOfSight>& lines,
            const Alignment& alignment) const;

  /// The pixels of each marker at the alignment's pose, camera error and shapes. The pose should
  /// hardly change any more: only pixels that see an edge contribute to it.
  std::vector<MarkerPixels> finePixels(const Alignment& alignment) const;

  /// A selection of the pixels, in total about as many as rough patches have.
  std::vector<MarkerPixels> someOf(const std::vector<MarkerPixels>& pixels) const;

  /// Each marker's fit at the pose that the pixels were taken from, which must be the alignment's.
  Fits fits(std::vector<MarkerPixels> pixels, const Alignment& alignment) const;

  /// The equations of all markers' pixels for the blur after this change of the unknowns.
  BlurEquations blur(const Fits& fits, const PixelNoise& noise, const FrameVector& change) const;

  /// The pixels' noise, estimated from all markers' residuals after this change of the unknowns. At
  /// least one marker must be seen.
  PixelNoise noise(const Fits& fits, const FrameVector& change) const;

 private:
  std::optional<MarkerFit> fitOf(std::size_t index, MarkerPixels pixels,
                                 const Alignment& alignment) const;
  /// With at most `max_pixels` pixels at edges in total, except for the minimum of each marker.
  /// Large markers get more of them: they are near, so that each of their pixels adds more to
  /// the pose.
  std::vector<MarkerPatch> patches(const MountedCamera& camera, const Pose& pose, int max_pixels,
                                   const MarkerPatch::Choice& choice,
                                   std::size_t worth_a_thread) const;
  /// Approximate area of a marker between its corners, in pixels; 0 if a corner is not seen.
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
