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

/// How a camera looks all around for markers when it does not know where it is (the paper's
/// Section 8).
struct LookAroundConfig {
  /// Whether the panorama itself is looked at first, sector by sector, which is several times
  /// faster: three markers that agree are enough, or two that are all that should be seen.
  bool glance = true;
  /// rad, between the middles of neighbouring views.
  double step = radians(45.0);
  /// rad, by which neighbouring views or sectors overlap: a marker that is narrower is whole in one
  /// of them. Much wider, hence nearer ones are not looked for, but on the floor and under the
  /// ceiling.
  double overlap = radians(20.0);
  /// Pixels of a view per pixel of the panorama along the tangent, where the panorama resolves
  /// best.
  double oversampling = 1.0;
  /// Pixels, width and height of a view at most; larger ones are made coarser.
  int max_size = 960;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
LookAroundConfig readLookAroundConfig(const YamlReader& reader);

/// Where markers at these heights can image, whole, that are up to `max_range` metres away and
/// not much wider than `config.overlap`, and those on the floor and under the ceiling however near.
/// Nothing where the camera sees none of these.
std::optional<Annulus> annulusOfMarkers(const MarkerHeights& heights, const MountedCamera& camera,
                                        double max_range, const LookAroundConfig& config);

/// The same of markers at any height, seen by a camera that may lean any way: all that it sees but
/// for what it has of itself near its axis.
Annulus annulusOfEverything(const MountedCamera& camera);

/// Views all around the camera, at the elevations at which markers of these heights can be that are
/// up to `max_range` metres away and not much wider than `config.overlap`, and one along the axis
/// where markers can be there. `oversampling` as in ViewPlannerConfig. None where the camera sees
/// none of these elevations.
std::vector<View> viewsAllAround(const MarkerHeights& heights, const MountedCamera& camera,
                                 const ContourTable& table, double max_range,
                                 const LookAroundConfig& config);

/// Views of everything that the panorama shows, whatever the map: all around, and along either end
/// of the axis where the camera sees that. Around the axis they do not reach into kNearAxis.
std::vector<View> viewsOfEverything(const MountedCamera& camera, const ContourTable& table,
                                    const LookAroundConfig& config);

/// All markers that a panorama (CV_8UC1) shows anywhere, each once, where there is time to look at
/// all that it resolves: for recordings.
std::vector<MarkerReading> readEverything(const MarkerReader& reader, const MountedCamera& camera,
                                          const cv::Mat& panorama, LookAroundConfig config);

}  // namespace omnitag
