#include "planning/expected_information.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "measurement/marker_misplacement.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Share of their amplitude that stripes as wide as a module (pixels) keep when they are averaged
/// over a pixel.
double transferOf(double module) {
  const double angle = 0.5 * kPi / std::max(module, 0.5);
  return std::sin(angle) / angle;
}

}  // namespace

std::optional<FrameEquations> expectedEquations(const PlanningScene& scene, const Marker& marker,
                                                const PatternEdges& edges,
                                                const Pose& map_from_base) {
  const Eigen::Isometry3d pose = map_from_base.toIsometry();
  FrameJacobian center_by_frame;
  Eigen::Matrix<double, 2, 3> by_point;
  if (!scene.camera.pixelFromMap(pose, marker.center(), &center_by_frame, &by_point)) {
    return std::nullopt;
  }
  const Eigen::Vector3d x_axis = marker.map_from_marker.linear().col(0);
  const Eigen::Vector3d y_axis = marker.map_from_marker.linear().col(1);
  const double module = marker.size / edges.modules;
  const Eigen::Vector2d module_x = module * by_point * x_axis;
  const Eigen::Vector2d module_y = module * by_point * y_axis;
  const double area = std::abs(module_x.x() * module_y.y() - module_x.y() * module_y.x());

  // Four places have the second moments of an even spread (Gauss and Legendre); each has a quarter
  // of the edges. whiteAcross() gives the factors by which a displacement at one of them counts, in
  // its standard deviations.
  constexpr int kPlaces = 4;
  const auto whiteAcross = [&](const Eigen::Vector2d& along, double length) -> Eigen::RowVector2d {
    const double pixels = along.norm();
    if (!(pixels > 0.0)) return Eigen::RowVector2d::Zero();
    const Eigen::RowVector2d normal = Eigen::RowVector2d(-along.y(), along.x()) / pixels;
    return transferOf(edges.feature_width * area / pixels) / scene.config.edge_noise *
           std::sqrt(length * pixels / kPlaces) * normal;
  };
  const Eigen::RowVector2d across_x = whiteAcross(module_x, edges.along_x);
  const Eigen::RowVector2d across_y = whiteAcross(module_y, edges.along_y);
  const double share = 1.0 / std::sqrt(3.0);
  const double reach = 0.5 * marker.size * share;
  const CameraUncertainty& uncertainty = scene.camera.model().uncertainty();
  Eigen::Matrix<double, 2 * kPlaces, kFrameUnknowns> rows;
  Eigen::Matrix<double, 2 * kPlaces, kShapeTerms> by_shape;
  for (Eigen::Index k = 0; k < kPlaces; ++k) {
    const double right = k % 2 == 0 ? -reach : reach;
    const double up = k < 2 ? -reach : reach;
    FrameJacobian by_frame;
    const Eigen::Vector3d place = marker.center() + right * x_axis + up * y_axis;
    if (!scene.camera.pixelFromMap(pose, place, &by_frame)) return std::nullopt;
    rows.row(2 * k) = across_x * by_frame;
    rows.row(2 * k + 1) = across_y * by_frame;
    const Eigen::Vector2d on_marker(k % 2 == 0 ? -share : share, k < 2 ? -share : share);
    const auto displacement = displacementByShape(uncertainty, on_marker);
    by_shape.row(2 * k) = across_x * displacement;
    by_shape.row(2 * k + 1) = across_y * displacement;
  }
  // The shape is marginalised: what it does is noise that the places share.
  using PlaceMatrix = Eigen::Matrix<double, 2 * kPlaces, 2 * kPlaces>;
  const PlaceMatrix of_shape = by_shape * by_shape.transpose();
  const PlaceMatrix weight = (PlaceMatrix::Identity() + of_shape).inverse();
  const Eigen::Matrix<double, 2 * kPlaces, kFrameUnknowns> weighted = weight * rows;
  FrameEquations equations;
  equations.information = rows.transpose().lazyProduct(weighted);
  equations.by_chance = weighted.transpose().lazyProduct(weighted);
  equations.by_shared = weighted.transpose() * of_shape * weighted;
  const Misplacement misplacement =
      misplacementOf(marker, scene.camera.model(), center_by_frame.leftCols<2>().norm(),
                     scene.config.localizer.estimation.photometric.alignment_deviation);
  return withMisplacement(equations, seenFrom(map_from_base, marker, misplacement));
}

PoseEstimate expectedEstimate(const PlanningScene& scene, const FrameEquations& markers,
                              const Pose& map_from_base) {
  return estimateOf(markers, scene.priorAt(map_from_base), map_from_base, 1.0);
}

}  // namespace omnitag
