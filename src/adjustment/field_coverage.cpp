#include "adjustment/field_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/format.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr std::size_t kRings = 3;
constexpr std::size_t kSectors = 8;
constexpr std::array<const char*, kRings> kRingNames = {"the middle", "half way out", "the rim"};
/// In the image, whose y points down, from the right on clockwise.
constexpr std::array<const char*, kSectors> kSectorNames = {
    "right", "lower right", "bottom", "lower left", "left", "upper left", "top", "upper right"};

/// Whether a pixel of the field is also within the image: lenses may image more than the sensor
/// has.
bool isInImage(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const ImageSize& size = camera.imageSize();
  return pixel.minCoeff() >= 0.0 && pixel.x() <= size.width - 1 && pixel.y() <= size.height - 1;
}

}  // namespace

std::optional<FieldCell> fieldCellOf(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const double inner = std::pow(camera.minRadius(), 2);
  const double outer = std::pow(camera.maxRadius(), 2);
  const auto ideal = camera.imagePlane().idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  const double out = (ideal->squaredNorm() - inner) / (outer - inner);
  if (out < 0.0 || out >= 1.0) return std::nullopt;
  const double turn = std::atan2(ideal->y(), ideal->x()) / (2.0 * kPi) + 1.0;
  return FieldCell{static_cast<std::size_t>(out * kRings),
                   static_cast<std::size_t>(std::lround(turn * kSectors)) % kSectors};
}

FieldCoverage fieldCoverage(const CameraModel& camera, const std::vector<Eigen::Vector2d>& pixels) {
  const double inner = std::pow(camera.minRadius(), 2);
  const double outer = std::pow(camera.maxRadius(), 2);
  std::array<std::array<int, kSectors>, kRings> counts{};
  for (const Eigen::Vector2d& pixel : pixels) {
    const auto cell = fieldCellOf(camera, pixel);
    if (cell) ++counts[cell->ring][cell->sector];
  }
  FieldCoverage coverage;
  double cells = 0.0;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    std::vector<std::string> empty;
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      const double out = (static_cast<double>(ring) + 0.5) / kRings;
      const double radius = std::sqrt(inner + out * (outer - inner));
      const double azimuth = 2.0 * kPi * static_cast<double>(sector) / kSectors;
      const Eigen::Vector2d middle = camera.imagePlane().pixelFromIdeal(
          radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
      if (!isInImage(camera, middle)) continue;
      cells += 1.0;
      if (counts[ring][sector] > 0) {
        coverage.share += 1.0;
      } else {
        empty.emplace_back(kSectorNames[sector]);
        coverage.empty.push_back({ring, sector});
      }
    }
    if (empty.size() == kSectors) {
      coverage.missing.emplace_back(kRingNames[ring]);
    } else if (!empty.empty()) {
      std::string where;
      for (const std::string& name : empty) where += (where.empty() ? "" : ", ") + name;
      coverage.missing.push_back(std::string(kRingNames[ring]) + " (" + where + ")");
    }
  }
  if (cells > 0.0) coverage.share /= cells;
  return coverage;
}

std::string describe(const FieldCoverage& coverage) {
  std::string text = format("corners cover %.0f %% of the field", 100.0 * coverage.share);
  if (coverage.missing.empty()) return text;
  std::string missing;
  for (const std::string& part : coverage.missing) missing += (missing.empty() ? "" : "; ") + part;
  return text + "; none in " + missing + ": record more there";
}

}  // namespace omnitag
