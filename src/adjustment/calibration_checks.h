#pragma once

#include <vector>

#include "adjustment/calibration_data.h"
#include "localization/frame_readings.h"
#include "omnitag/camera/image_plane.h"
#include "omnitag/common/pose.h"

/// Checks that a recording can calibrate a camera. All throw InputError, with what to do.
namespace omnitag {

/// The mounting must be the same in all frames.
void checkMounting(const std::vector<FrameReadings>& frames);

/// Markers must have been seen all around the centre of the image.
void checkCoverage(const std::vector<CalibrationFrame>& frames, const ImagePlane& plane,
                   bool is_board);

/// The robot must have moved.
void checkMotion(const std::vector<Pose>& poses);

/// A board must have been seen from different directions.
void checkViews(const std::vector<Pose>& poses);

}  // namespace omnitag
