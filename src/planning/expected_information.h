#pragma once

#include <optional>

#include "measurement/frame_equations.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "planning/pattern_edges.h"
#include "planning/planning_scene.h"

namespace omnitag {

/// What the image of a marker is expected to tell about a frame's unknowns.
///
/// Its pattern's edges are taken as spread evenly over it. A pixel along an edge shows the edge's
/// place across it with the deviation edge_noise, so that l pixels of edge with the unit normal n
/// have the information l n n^T / edge_noise^2 about their place in the image. Modules that pixels
/// hardly resolve tell less, by the square of a pixel's transfer function at their spatial
/// frequency. The marker's misplacement is marginalised. Nothing if the camera does not see all of
/// the marker.
std::optional<FrameEquations> expectedEquations(const PlanningScene& scene, const Marker& marker,
                                                const PatternEdges& edges,
                                                const Pose& map_from_base);

/// The estimate that an image is expected to give by itself: the pose with its covariance.
/// `markers`: the sum of their equations.
PoseEstimate expectedEstimate(const PlanningScene& scene, const FrameEquations& markers,
                              const Pose& map_from_base);

}  // namespace omnitag
