#pragma once

#include <cstddef>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "omnitag/photometry/blur_equations.h"
#include "photometry/lit_patch.h"
#include "photometry/marker_patch.h"
#include "photometry/pixel_noise.h"

namespace omnitag {

/// The equations for the image's blur from about `at_most` of a marker's pixels, after this change
/// of the unknowns.
BlurEquations blurEquationsOf(const MarkerPixels& pixels, const LitPatch& patch,
                              const TagPattern& pattern, const MountedCamera& camera,
                              const PixelNoise& noise, const FrameVector& change,
                              std::size_t at_most);

}  // namespace omnitag
