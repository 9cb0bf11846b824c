#pragma once

#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/view/contour_table.h"
#include "omnitag/view/view.h"

namespace omnitag {

/// Views of all that a camera sees but for what is near the optical axis, whatever the map says:
/// while the camera is not known, neither is where in the image a height of the map is.
/// `shows_axis`: near the axis, too, for markers on the floor or under the ceiling.
std::vector<View> viewsOfRing(const MountedCamera& camera, const ContourTable& table,
                              bool shows_axis);

}  // namespace omnitag
