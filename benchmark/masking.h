#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "recorded_sequence.h"

namespace omnitag {

/// What the localizer makes of a frame that it expects from where it really is.
FrameResult lookAtTruth(const RecordedSequence& sequence, std::size_t frame,
                        const LocalizerConfig& config = {});

/// Indices of those of `seen.predicted` that were read and accepted.
std::vector<std::size_t> readableMarkers(const FrameResult& seen);

/// The image with all expected markers but the chosen ones painted over in the grey of a wall.
cv::Mat withOnly(const std::vector<std::size_t>& chosen, const FrameResult& seen,
                 const cv::Mat& image);

}  // namespace omnitag
