#include "photometry/marker_patch.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

/// A footprint that outlives its patch.
struct Seen {
  int column = 0;
  int row = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Facet facet;
};

std::vector<Seen> seen(const MarkerPatch& patch) {
  std::vector<Seen> all;
  for (const Footprint& footprint : patch.footprints()) {
    all.push_back({footprint.column, footprint.row, footprint.position, *footprint.facet});
  }
  return all;
}

/// A marker as a camera sees it from a pose, and what follows from the camera's projection alone.
struct Scene {
  std::string name;
  MountedCamera camera;
  Marker marker;
  Pose pose{0.25, -0.15, 0.6};
  TagPattern pattern{marker.family, marker.id};

  MarkerPatch patch(const MarkerPatch::Choice& choice = {}) const {
    return {marker, pattern, camera, pose, choice};
  }

  std::vector<Seen> footprints(const MarkerPatch::Choice& choice = {}) const {
    return seen(patch(choice));
  }

  double metresPerModule() const { return marker.size / pattern.widthBetweenCorners(); }

  Eigen::Vector3d inMap(const Eigen::Vector2d& position) const {
    const double half = 0.5 * pattern.width();
    return marker.map_from_marker *
           (metresPerModule() * Eigen::Vector3d(position.x() - half, half - position.y(), 0.0));
  }

  std::optional<Eigen::Vector2d> pixelOf(const Eigen::Vector2d& position, const Pose& from) const {
    return camera.pixelFromMap(from, inMap(position));
  }

  /// Pixels per module.
  Eigen::Matrix2d pixelByPosition(const Eigen::Vector2d& position) const {
    constexpr double kStep = 1e-4;
    Eigen::Matrix2d derivative;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      derivative.col(axis) =
          (*pixelOf(position + step, pose) - *pixelOf(position - step, pose)) / (2.0 * kStep);
    }
    return derivative;
  }

  Eigen::Matrix<double, 2, 6> pixelByPose(const Eigen::Vector2d& position) const {
    constexpr double kStep = 1e-6;
    Eigen::Matrix<double, 2, 6> derivative;
    const auto seenFrom = [&](int i, double step) {
      return *pixelOf(position, moved(pose, step * PoseVector::Unit(i)));
    };
    for (int i = 0; i < 6; ++i) {
      derivative.col(i) = (seenFrom(i, kStep) - seenFrom(i, -kStep)) / (2.0 * kStep);
    }
    return derivative;
  }

  /// Where a pixel's line of sight meets the marker's plane, by Newton's method on the projection.
  std::optional<Eigen::Vector2d> positionAt(const Eigen::Vector2d& pixel) const {
    Eigen::Vector2d position = Eigen::Vector2d::Constant(0.5 * pattern.width());
    for (int i = 0; i < 20; ++i) {
      const auto image = pixelOf(position, pose);
      if (!image) return std::nullopt;
      const Eigen::Vector2d step = pixelByPosition(position).inverse() * (pixel - *image);
      position += step;
      if (position.minCoeff() < -0.5 * pattern.width() ||
          position.maxCoeff() > 1.5 * pattern.width()) {
        return std::nullopt;
      }
      if (step.norm() < 1e-9) return position;
    }
    return std::nullopt;
  }
};

/// How gtest names a scene.
void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

/// Far and near, from the front and from the side, upright and rolled, of more than one layout.
std::vector<Scene> scenes() {
  const MountedCamera down(test::sphericalCamera(), test::lookingDown());
  const MountedCamera up(test::hyperbolicCamera(), test::lookingUp());
  std::vector<Scene> scenes;
  scenes.push_back({"Far", down, test::wallMarker(42, {3.2, -0.6, 1.2}, kPi)});
  scenes.push_back({"Rolled", down, test::wallMarker(7, {-2.8, 0.3, 1.4}, 0.1, radians(20.0))});
  scenes.push_back({"FromTheSide", down, test::wallMarker(1, {0.4, 2.5, 1.3}, -0.6)});
  scenes.push_back({"Near", down, test::wallMarker(3, {-1.0, -1.3, 1.2}, 0.8)});
  scenes.push_back({"Up", up, test::wallMarker(5, {2.0, 1.0, 0.2}, -2.6)});
  scenes.push_back({"UpNear", up, test::wallMarker(9, {0.9, 1.0, 0.2}, -2.2)});
  Marker round = test::wallMarker(11, {2.6, -0.9, 1.2}, 2.8);
  round.family = "tagCircle21h7";
  scenes.push_back({"Circle", down, round});
  return scenes;
}

using ByPixel = std::map<std::pair<int, int>, Seen>;

/// Each pixel must occur only once.
ByPixel byPixel(const std::vector<Seen>& footprints) {
  ByPixel by_pixel;
  for (const Seen& footprint : footprints) {
    by_pixel[{footprint.column, footprint.row}] = footprint;
  }
  EXPECT_EQ(by_pixel.size(), footprints.size());
  return by_pixel;
}

/// Distance of what a pixel sees from the drawing's border, in units of its own extent; negative if
/// it reaches beyond. Nothing if the pixel does not show the marker's surroundings.
std::optional<double> roomOf(const Scene& scene, int column, int row) {
  const auto position = scene.positionAt(Eigen::Vector2d(column, row));
  if (!position) return std::nullopt;
  const Eigen::Vector2d reach =
      0.5 * scene.pixelByPosition(*position).inverse().cwiseAbs().rowwise().sum();
  const double room = std::min((*position - reach).minCoeff(),
                               scene.pattern.width() - (*position + reach).maxCoeff());
  return room / reach.maxCoeff();
}

class MarkerPatchTest : public testing::TestWithParam<Scene> {};

TEST_P(MarkerPatchTest, PositionsAreWhatThePixelsSee) {
  const Scene& scene = GetParam();
  const std::vector<Seen> footprints = scene.footprints();
  ASSERT_GT(footprints.size(), 100U);
  double largest = 0.0;
  for (const Seen& footprint : footprints) {
    const auto pixel = scene.pixelOf(footprint.position, scene.pose);
    ASSERT_TRUE(pixel);
    const Eigen::Vector2d expected(footprint.column, footprint.row);
    largest = std::max(largest, (*pixel - expected).norm());
  }
  EXPECT_LT(largest, MarkerPatch::Choice().tolerance);
}

TEST_P(MarkerPatchTest, PositionsFollowThePose) {
  const Scene& scene = GetParam();
  const MarkerPatch patch = scene.patch();
  const Pose moved{scene.pose.x + 0.004, scene.pose.y - 0.003, scene.pose.yaw + 0.004};
  const ImageSize& size = scene.camera.model().imageSize();
  const cv::Mat panorama(size.height, size.width, CV_8UC1, cv::Scalar(100));
  const auto pixels =
      patch.pixels(panorama, patch.linesOfSight(), moved, ImagingError::Zero()).pixels;
  ASSERT_GT(pixels.size(), 100U);
  for (const MarkerPixel& seen : pixels) {
    const Eigen::Vector2d position =
        scene.pattern.width() * (seen.position + Eigen::Vector2d(0.5, 0.5));
    const auto pixel = scene.pixelOf(position, moved);
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - Eigen::Vector2d(seen.column, seen.row)).norm(), 2e-3);
  }
}

TEST_P(MarkerPatchTest, DerivativesAreThoseOfTheProjection) {
  const Scene& scene = GetParam();
  // They are exact about the middle of each of 4 x 4 cells and change little within it.
  const double cell = 0.25 * scene.pattern.width();
  double largest = 0.0;
  double largest_in_middle = 0.0;
  int in_middle = 0;
  for (const Seen& footprint : scene.footprints()) {
    const Eigen::Matrix2d by_pixel = scene.pixelByPosition(footprint.position).inverse();
    const Eigen::Matrix<double, 2, 6> by_pose = -by_pixel * scene.pixelByPose(footprint.position);
    const Eigen::Matrix<double, 2, 6> found = footprint.facet.by_frame.leftCols<6>();
    const double error = std::max((footprint.facet.by_pixel - by_pixel).norm() / by_pixel.norm(),
                                  (found - by_pose).norm() / by_pose.norm());
    largest = std::max(largest, error);
    const Eigen::Vector2d in_cell = footprint.position / cell;
    const Eigen::Vector2d off = in_cell.array() - in_cell.array().floor() - 0.5;
    if (off.cwiseAbs().maxCoeff() > 0.1) continue;
    largest_in_middle = std::max(largest_in_middle, error);
    ++in_middle;
  }
  RecordProperty("largest_error", std::to_string(largest));
  RecordProperty("largest_error_in_middle", std::to_string(largest_in_middle));
  EXPECT_GT(in_middle, 0);
  EXPECT_LT(largest, 0.2);
  EXPECT_LT(largest_in_middle, 0.04);
}

TEST_P(MarkerPatchTest, MoreFacetsFollowTheProjectionMoreClosely) {
  const Scene& scene = GetParam();
  const auto meanError = [&scene](int facets) {
    MarkerPatch::Choice choice;
    choice.facets = facets;
    const std::vector<Seen> footprints = scene.footprints(choice);
    EXPECT_GT(footprints.size(), 100U);
    double sum = 0.0;
    for (const Seen& footprint : footprints) {
      const Eigen::Matrix2d by_pixel = scene.pixelByPosition(footprint.position).inverse();
      sum += (footprint.facet.by_pixel - by_pixel).norm() / by_pixel.norm();
    }
    return sum / static_cast<double>(footprints.size());
  };
  // The error grows with the size of a facet.
  const double of_two = meanError(2);
  EXPECT_LT(meanError(6), 0.5 * of_two);
  EXPECT_LT(meanError(12), 0.25 * of_two);
}

TEST(MarkerPatchAtTheEdge, HoldsWhatIsSeenOfAMarkerThatIsCutOff) {
  const Scene scene{"CutOff", MountedCamera(test::hyperbolicCamera(), test::lookingUp()),
                    test::wallMarker(5, {2.0, 1.0, 0.2}, -2.6)};
  const auto sees = [](const Scene& seen, double x, double y) {
    return seen.pixelOf(seen.pattern.width() * Eigen::Vector2d(x, y), seen.pose).has_value();
  };
  Scene cut = scene;
  for (int i = 0; i < 200 && sees(cut, 0.0, 0.0) && sees(cut, 1.0, 0.0); ++i) {
    cut.marker.map_from_marker.translation().z() += 0.02;
  }
  ASSERT_FALSE(sees(cut, 0.0, 0.0) && sees(cut, 1.0, 0.0));
  ASSERT_TRUE(sees(cut, 0.5, 0.6));
  for (const int facets : {4, 6}) {
    MarkerPatch::Choice choice;
    choice.facets = facets;
    EXPECT_GT(cut.footprints(choice).size(), 50U) << facets;
  }
}

TEST_P(MarkerPatchTest, BlurMakesTheFootprintsLarger) {
  const Scene& scene = GetParam();
  const ByPixel sharp = byPixel(scene.footprints());
  constexpr double kBlur = 0.6;
  Scene blurred_scene = scene;
  blurred_scene.camera = scene.camera.withBlur({kBlur * kBlur});
  const std::vector<Seen> blurred = blurred_scene.footprints();
  ASSERT_GT(blurred.size(), 50U);
  EXPECT_LT(blurred.size(), sharp.size());
  for (const Seen& footprint : blurred) {
    const Seen& other = sharp.at({footprint.column, footprint.row});
    // How far a parallelogram reaches: half the lengths of its sides along an axis.
    EXPECT_TRUE(other.facet.window.reach().isApprox(
        0.5 * other.facet.by_pixel.cwiseAbs().rowwise().sum(), 1e-12));
    EXPECT_TRUE(footprint.facet.by_pixel.isApprox(other.facet.by_pixel, 1e-12));
    EXPECT_GT((footprint.facet.window.reach() - other.facet.window.reach()).minCoeff(), 0.0);
    // The variance of a box of width w is w^2 / 12; those of blur and pixel add up.
    const double stretch = std::sqrt(12.0 * (1.0 / 12.0 + kBlur * kBlur));
    EXPECT_TRUE(footprint.facet.window.size().isApprox(stretch * other.facet.window.size(), 1e-12));
  }
}

TEST_P(MarkerPatchTest, HoldsEveryPixelThatSeesNothingButTheDrawing) {
  const Scene& scene = GetParam();
  const ByPixel held = byPixel(scene.footprints());
  // The facets, a quarter of the drawing wide, tell to a fifth what a pixel sees.
  constexpr double kTolerance = 0.2;
  for (const auto& [pixel, footprint] : held) {
    EXPECT_GT(roomOf(scene, pixel.first, pixel.second).value_or(-1.0), -kTolerance);
  }
  const Eigen::Vector2d center =
      *scene.pixelOf(Eigen::Vector2d::Constant(0.5 * scene.pattern.width()), scene.pose);
  constexpr int kReach = 150;  // pixels
  int missing = 0;
  int inside = 0;
  for (int row = cvRound(center.y()) - kReach; row <= cvRound(center.y()) + kReach; ++row) {
    for (int column = cvRound(center.x()) - kReach; column <= cvRound(center.x()) + kReach;
         ++column) {
      if (roomOf(scene, column, row).value_or(-1.0) < kTolerance) continue;
      ++inside;
      missing += static_cast<int>(held.count({column, row}) == 0);
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_EQ(missing, 0) << "of " << inside;
}

/// Whether neighbours among these are equally far apart.
bool areEven(const std::set<int>& coordinates) {
  std::set<int> gaps;
  for (auto next = std::next(coordinates.begin()); next != coordinates.end(); ++next) {
    gaps.insert(*next - *std::prev(next));
  }
  return gaps.size() == 1;
}

void expectGridOfAbout(std::size_t most, const ByPixel& all, const ByPixel& grid) {
  std::set<int> columns;
  std::set<int> rows;
  for (const auto& [pixel, footprint] : grid) {
    EXPECT_EQ(all.count(pixel), 1U);
    columns.insert(pixel.first);
    rows.insert(pixel.second);
  }
  EXPECT_TRUE(areEven(columns)) << most;
  EXPECT_TRUE(areEven(rows)) << most;
  EXPECT_GE(grid.size(), std::min(all.size(), most) * 4 / 10) << most;
  EXPECT_LE(grid.size(), most * 2) << most;
}

TEST_P(MarkerPatchTest, ConsidersAboutAsManyPixelsAsAskedForOnAGrid) {
  const Scene& scene = GetParam();
  const ByPixel all = byPixel(scene.footprints());
  for (const std::size_t most : {60U, 150U, 400U}) {
    MarkerPatch::Choice choice;
    choice.max_considered = most;
    expectGridOfAbout(most, all, byPixel(scene.footprints(choice)));
  }
}

/// Whether a pixel and those within two pixels of it see only one colour.
bool seesOneColour(const Scene& scene, const Seen& footprint, double reach) {
  const Eigen::Matrix2d by_pixel = scene.pixelByPosition(footprint.position).inverse();
  std::set<double> colours;
  const int width = scene.pattern.width();
  constexpr int kSamples = 40;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      const Eigen::Vector2d offset(2.0 * i / kSamples - 1.0, 2.0 * j / kSamples - 1.0);
      const Eigen::Vector2d position = footprint.position + reach * by_pixel * offset;
      if (position.minCoeff() < 0.0 || position.maxCoeff() >= width) continue;
      colours.insert(
          scene.pattern.whiteAt(static_cast<int>(position.x()), static_cast<int>(position.y())));
    }
  }
  return colours.size() < 2;
}

TEST_P(MarkerPatchTest, KeepsNoMoreAtEdgesAndOnEvenGroundThanAskedFor) {
  const Scene& scene = GetParam();
  const auto count = [&](std::size_t at_edges, std::size_t on_even_ground) {
    MarkerPatch::Choice choice;
    choice.max_at_edges = at_edges;
    choice.max_on_even_ground = on_even_ground;
    return scene.footprints(choice).size();
  };
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  const std::size_t all = count(kAll, kAll);
  const std::size_t edges = count(kAll, 0);
  const std::size_t even = count(0, kAll);
  // Of nine pixels that see even ground together, one is enough.
  EXPECT_LE(edges + even, all);
  EXPECT_GE(edges + 9 * even, all);
  EXPECT_EQ(count(0, 0), 0U);
  for (const std::size_t most : {1U, 7U, 60U, 200U}) {
    EXPECT_LE(count(most, 0), most);
    EXPECT_LE(count(0, most), most);
    EXPECT_GE(count(most, 0), std::min(most, edges) / 4) << most;
  }
}

TEST_P(MarkerPatchTest, PixelsNearEdgesAreAtEdges) {
  const Scene& scene = GetParam();
  MarkerPatch::Choice choice;
  choice.max_on_even_ground = 0;
  for (const Seen& footprint : scene.footprints(choice)) {
    EXPECT_FALSE(seesOneColour(scene, footprint, 4.5)) << footprint.column << ", " << footprint.row;
  }
  choice.max_on_even_ground = std::numeric_limits<std::size_t>::max();
  choice.max_at_edges = 0;
  for (const Seen& footprint : scene.footprints(choice)) {
    EXPECT_TRUE(seesOneColour(scene, footprint, 1.5)) << footprint.column << ", " << footprint.row;
  }
}

TEST_P(MarkerPatchTest, PixelsSeeWhatAPanoramaShows) {
  const Scene& scene = GetParam();
  const cv::Mat panorama =
      test::renderPanorama({"map", {scene.marker}}, scene.camera, scene.pose, 8);
  double squares = 0.0;
  const std::vector<MarkerPixel> pixels = scene.patch().pixels(panorama).pixels;
  ASSERT_GT(pixels.size(), 100U);
  for (const MarkerPixel& pixel : pixels) {
    const double error = 30.0 + 190.0 * pixel.white - pixel.grey;
    squares += error * error / static_cast<double>(pixels.size());
  }
  EXPECT_LT(std::sqrt(squares), 0.03 * 190.0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, MarkerPatchTest, testing::ValuesIn(scenes()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace omnitag
