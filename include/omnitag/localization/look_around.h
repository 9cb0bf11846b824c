#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/glance_sectors.h"
#include "omnitag/marker/marker_index.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/view/contour_table.h"
#include "omnitag/view/view.h"
#include "omnitag/view/view_planner.h"

namespace omnitag {

/// How a camera looks all around for markers when its pose is unknown (the paper's Section 8).
struct LookAroundConfig {
  /// Whether to glance at the panorama first, sector by sector, which is several times faster:
  /// three markers that agree are enough, or two if no more should be seen.
  bool glance = true;
  /// rad, between the middles of neighbouring views.
  double step = radians(45.0);
  /// rad: how far neighbouring views or sectors overlap, so that a narrower marker is whole in one
  /// of them. Much wider (nearer) markers are not looked for, except on the floor and under the
  /// ceiling.
  double overlap = radians(20.0);
  /// Pixels of a view per pixel of the panorama along the tangent, where the panorama has its best
  /// resolution.
  double oversampling = 1.0;
  /// Pixels: largest width and height of a view; larger views are made coarser.
  int max_size = 960;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
LookAroundConfig readLookAroundConfig(const YamlReader& reader);

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
