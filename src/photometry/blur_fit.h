#pragma once

#include <cstddef>

#include "lit_patch.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {

/// The equations for the image's blur from about `at_most` of a marker's pixels, after this change
/// of the unknowns.
BlurEquations blurEquationsOf(const MarkerPixels& pixels, const LitPatch& patch,
                              const TagPattern& pattern, const MountedCamera& camera,
                              const PixelNoise& noise, const FrameVector& change,
                              std::size_t at_most);

}  // namespace omnitag
