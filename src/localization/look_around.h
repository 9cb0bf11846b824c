#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/glance_sectors.h"
#include "marker/marker_index.h"
#include "marker/marker_reader.h"
#include "omnitag/localization/look_around_config.h"
#include "omnitag/view/view.h"
#include "view/contour_table.h"
#include "view/view_planner.h"

namespace omnitag {

/// Where markers can image as a whole if they are at these heights, up to `max_range` metres away
/// and not much wider than `config.overlap`; and those on the floor and under the ceiling, however
/// near. Nothing if the camera sees none of these.
std::optional<Annulus> annulusOfMarkers(const MarkerHeights& heights, const MountedCamera& camera,
                                        double max_range, const LookAroundConfig& config);

/// The same for markers at any height and a camera that may lean any way: all that it sees, except
/// what it shows of itself near its axis.
Annulus annulusOfEverything(const MountedCamera& camera);

/// Views all around the camera at the elevations of markers that are at these heights, up to
/// `max_range` metres away and not much wider than `config.overlap`, and one along the axis if
/// markers can be there. `oversampling` as in ViewPlannerConfig. None if the camera sees none of
/// these elevations.
std::vector<View> viewsAllAround(const MarkerHeights& heights, const MountedCamera& camera,
                                 const ContourTable& table, double max_range,
                                 const LookAroundConfig& config);

/// Views of everything that the panorama shows, whatever the map: all around, and along each end of
/// the axis that the camera sees. Those around the axis do not reach into kNearAxis.
std::vector<View> viewsOfEverything(const MountedCamera& camera, const ContourTable& table,
                                    const LookAroundConfig& config);

/// All markers that a panorama (CV_8UC1) shows anywhere, each once; for recordings, where there is
/// time to use its full resolution.
std::vector<MarkerReading> readEverything(const MarkerReader& reader, const MountedCamera& camera,
                                          const cv::Mat& panorama, LookAroundConfig config);

}  // namespace omnitag
