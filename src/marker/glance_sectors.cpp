#include "marker/glance_sectors.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr int kSectors = 4;
constexpr double kWidth = 2.0 * kPi / kSectors;

/// One number for each sector.
using Changes = Eigen::Matrix<double, kSectors, 1>;

double azimuthOf(int sector) { return kWidth * sector; }

/// How much the panorama changes from one sample of a grid to the next, summed over each sector: in
/// fourth powers, so that low contrast counts for little, however much of it there is, and the
/// lowest for nothing. The lens's distortion moves samples too little to matter.
Changes changeBySector(const cv::Mat& panorama, const Annulus& annulus, const ImagePlane& plane) {
  constexpr int kSamplesPerSide = 128;
  constexpr int kFlat = 32;  // grey levels
  const int step = std::max(1, std::min(panorama.cols, panorama.rows) / kSamplesPerSide);
  Eigen::Matrix<double, kSectors, 2> middles;
  for (int i = 0; i < kSectors; ++i) {
    middles.row(i) << std::cos(azimuthOf(i)), std::sin(azimuthOf(i));
  }
  const Eigen::Matrix2d ideal_from_offset = plane.affine().inverse();
  const auto idealOf = [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
    if (plane.isEquirectangular()) return *plane.idealFromPixel(pixel);
    return ideal_from_offset * (pixel - plane.principalPoint());
  };
  Changes changes = Changes::Zero();
  for (int y = 0; y + step < panorama.rows; y += step) {
    const auto* row = panorama.ptr<std::uint8_t>(y);
    const auto* next_row = panorama.ptr<std::uint8_t>(y + step);
    for (int x = 0; x + step < panorama.cols; x += step) {
      const int change = std::max(std::abs(row[x] - row[x + step]), std::abs(row[x] - next_row[x]));
      if (change < kFlat) continue;
      const Eigen::Vector2d ideal = idealOf({x, y});
      const double radius = ideal.norm();
      if (radius < annulus.min_radius || radius > annulus.max_radius) continue;
      Eigen::Index nearest = 0;
      (middles * ideal).maxCoeff(&nearest);
      const double squared = static_cast<double>(change) * change;
      changes[nearest] += squared * squared;
    }
  }
  return changes;
}

}  // namespace

std::vector<Sector> sectorsToGlanceAt(const cv::Mat& panorama, const Annulus& annulus,
                                      const ImagePlane& plane, double overlap) {
  // A marker at the axis is in no sector.
  if (!(annulus.min_radius > 0.0)) return {Sector{}};
  const Changes changes = changeBySector(panorama, annulus, plane);
  std::array<int, kSectors> order{};
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&changes](int a, int b) { return changes[a] > changes[b]; });
  std::vector<Sector> sectors;
  sectors.reserve(kSectors);
  for (const int i : order) sectors.push_back({azimuthOf(i), 0.5 * (kWidth + overlap)});
  return sectors;
}

}  // namespace omnitag
