#pragma once

#include <cstddef>

#include "lit_patch.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {

/// What a marker's pixels, at most about this many of them, say about the image's blur once the
/// unknowns change so.
BlurEquations blurEquationsOf(const MarkerPixels& pixels, const LitPatch& patch,
                              const TagPattern& pattern, const MountedCamera& camera,
                              const PixelNoise& noise, const FrameVector& change,
                              std::size_t at_most);

}  // namespace omnitag
