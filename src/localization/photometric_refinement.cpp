#include "omnitag/localization/photometric_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Where a line of sight meets a marker, in modules of its drawing, and how that depends on the
/// pose.
struct Meeting {
  Eigen::Vector2d position;
  Eigen::Matrix<double, 2, 3> by_pose;
};

/// A pixel of a marker as it is and as the pattern would have it.
struct Sample {
  double grey = 0.0;
  double white = 0.0;
  /// How much the share of white changes from pixel to pixel.
  double gradient = 0.0;
  Eigen::Vector2d position;
  Eigen::RowVector3d white_by_pose;
};

/// The part of the panorama that shows a marker.
class Patch {
 public:
  Patch(const cv::Mat& panorama, const Marker& marker, const TagPattern& pattern,
        const MountedCamera& camera, const Pose2& map_from_base, double blur)
      : panorama_(panorama),
        pattern_(pattern),
        marker_from_map_(marker.map_from_marker.inverse()),
        modules_per_metre_(pattern.widthBetweenCorners() / marker.size),
        blur_variance_(blur * blur) {
    const Eigen::Vector2d low_limit(1.0, 1.0);
    const Eigen::Vector2d high_limit(panorama.cols - 2.0, panorama.rows - 2.0);
    Eigen::Vector2d low = high_limit;
    Eigen::Vector2d high = low_limit;
    const double with_border = 1.0 * pattern.width() / pattern.widthBetweenCorners();
    for (const Eigen::Vector3d& corner : marker.corners()) {
      const Eigen::Vector3d outer = marker.center() + with_border * (corner - marker.center());
      const auto pixel = camera.pixelFromMap(map_from_base, outer);
      if (!pixel) continue;
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
    low = low.cwiseMax(low_limit);
    high = high.cwiseMin(high_limit);
    left_ = static_cast<int>(low.x()) - 1;
    top_ = static_cast<int>(low.y()) - 1;
    columns_ = std::max(0, static_cast<int>(high.x()) + 2 - left_);
    rows_ = std::max(0, static_cast<int>(high.y()) + 2 - top_);
    rays_.reserve(static_cast<std::size_t>(columns_ * rows_));
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        rays_.push_back(camera.rayInBase({left_ + column, top_ + row}));
      }
    }
  }

  /// The pixels that lie within the drawing, at a pose.
  std::vector<Sample> samples(const Pose2& map_from_base) const {
    const Eigen::Matrix3d map_from_base_rotation = map_from_base.toIsometry().linear();
    const Eigen::Vector3d base_in_map(map_from_base.x, map_from_base.y, 0.0);
    std::vector<std::optional<Meeting>> meetings;
    meetings.reserve(rays_.size());
    for (const std::optional<Ray>& ray : rays_) {
      meetings.push_back(ray ? meet({map_from_base_rotation * ray->origin,
                                     map_from_base_rotation * ray->direction},
                                    base_in_map)
                             : std::nullopt);
    }
    std::vector<Sample> samples;
    for (int row = 1; row + 1 < rows_; ++row) {
      for (int column = 1; column + 1 < columns_; ++column) {
        const std::size_t here = indexOf(column, row);
        const auto& left = meetings[here - 1];
        const auto& right = meetings[here + 1];
        const auto& above = meetings[here - static_cast<std::size_t>(columns_)];
        const auto& below = meetings[here + static_cast<std::size_t>(columns_)];
        if (!meetings[here] || !left || !right || !above || !below) continue;
        const std::optional<Sample> sample =
            predict(*meetings[here], 0.5 * (right->position - left->position),
                    0.5 * (below->position - above->position));
        if (!sample) continue;
        samples.push_back(*sample);
        samples.back().grey = panorama_.at<std::uint8_t>(top_ + row, left_ + column);
      }
    }
    return samples;
  }

 private:
  std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }

  /// `ray`: turned into the map's axes, but relative to base_link.
  std::optional<Meeting> meet(const Ray& ray, const Eigen::Vector3d& base_in_map) const {
    const Eigen::Matrix3d& rotation = marker_from_map_.linear();
    const Eigen::Vector3d origin = marker_from_map_ * (ray.origin + base_in_map);
    const Eigen::Vector3d direction = rotation * ray.direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
    const double slope_x = direction.x() / direction.z();
    const double slope_y = direction.y() / direction.z();
    const double x = origin.x() - origin.z() * slope_x;
    const double y = origin.y() - origin.z() * slope_y;

    // Turning the robot turns origin and direction about the z axis of base_link.
    const Eigen::Vector3d origin_by_yaw =
        rotation * Eigen::Vector3d(-ray.origin.y(), ray.origin.x(), 0.0);
    const Eigen::Vector3d direction_by_yaw =
        rotation * Eigen::Vector3d(-ray.direction.y(), ray.direction.x(), 0.0);
    Eigen::Matrix3d origin_by_pose;
    origin_by_pose << rotation.leftCols<2>(), origin_by_yaw;
    const double range = -origin.z() / direction.z();
    const double half = 0.5 * pattern_.width();
    Meeting meeting;
    meeting.position = {half + modules_per_metre_ * x, half - modules_per_metre_ * y};
    meeting.by_pose.row(0) = origin_by_pose.row(0) - slope_x * origin_by_pose.row(2);
    meeting.by_pose.row(1) = origin_by_pose.row(1) - slope_y * origin_by_pose.row(2);
    meeting.by_pose(0, 2) += range * (direction_by_yaw.x() - slope_x * direction_by_yaw.z());
    meeting.by_pose(1, 2) += range * (direction_by_yaw.y() - slope_y * direction_by_yaw.z());
    meeting.by_pose.row(0) *= modules_per_metre_;
    meeting.by_pose.row(1) *= -modules_per_metre_;
    return meeting;
  }

  /// The pixel's area on the marker is the parallelogram of its two sides, in modules. It is cut
  /// into four, each of which is averaged over as if its sides ran along the modules.
  std::optional<Sample> predict(const Meeting& meeting, Eigen::Vector2d side_u,
                                Eigen::Vector2d side_v) const {
    // A Gaussian blur and a box have the same variance where the box is sqrt(12) deviations wide.
    const double stretch = std::sqrt(1.0 + 12.0 * blur_variance_);
    side_u *= stretch;
    side_v *= stretch;
    const Eigen::Vector2d reach = 0.5 * (side_u.cwiseAbs() + side_v.cwiseAbs());
    const double width = pattern_.width();
    if ((meeting.position - reach).minCoeff() < 0.0 ||
        (meeting.position + reach).maxCoeff() > width) {
      return std::nullopt;
    }
    constexpr int kParts = 2;
    const Eigen::Vector2d size = (side_u.cwiseAbs2() + side_v.cwiseAbs2()).cwiseSqrt() / kParts;
    Sample sample;
    Eigen::Vector2d by_position = Eigen::Vector2d::Zero();
    for (const double i : {-0.25, 0.25}) {
      for (const double j : {-0.25, 0.25}) {
        const TagPattern::White white =
            pattern_.average(meeting.position + i * side_u + j * side_v, size);
        sample.white += white.share / (kParts * kParts);
        by_position += white.by_position / (kParts * kParts);
      }
    }
    sample.position = meeting.position / width - Eigen::Vector2d(0.5, 0.5);
    sample.white_by_pose = by_position.transpose() * meeting.by_pose;
    sample.gradient = std::hypot(by_position.dot(side_u), by_position.dot(side_v));
    return sample;
  }

  const cv::Mat& panorama_;
  const TagPattern& pattern_;
  Eigen::Isometry3d marker_from_map_;
  double modules_per_metre_;
  double blur_variance_;
  int left_ = 0;
  int top_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::optional<Ray>> rays_;
};

/// How far grey levels are off: noise on even ground, and at edges as much more as if these were
/// displaced by chance from pixel to pixel. No sensor and no print has an edge just as a pixel's
/// average over an ideal pattern has it.
struct Noise {
  double flat = 10.0;  // grey levels
  double edge = 0.05;  // pixels

  double variance(double grey_gradient) const {
    return flat * flat + edge * edge * grey_gradient * grey_gradient;
  }
};

/// A pixel's difference from the pattern.
struct Residual {
  double grey = 0.0;
  /// From pixel to pixel: of the share of white, and of the grey levels.
  double gradient = 0.0;
  double grey_gradient = 0.0;
};

/// What a marker's pixels say about the pose once the light on it is fitted.
struct PatchFit {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::vector<Residual> residuals;
};

/// 1 / variance, and less for pixels that are off by more than this many deviations.
double weightOf(const Residual& residual, const Noise& noise) {
  constexpr double kOutlier = 3.5;
  const double variance = noise.variance(residual.grey_gradient);
  const double ratio_square = residual.grey * residual.grey / (kOutlier * kOutlier * variance);
  return 1.0 / (variance * std::max(1.0, ratio_square));
}

/// Fits grey = black + white * (contrast + slope . position) in the sense of weighted least squares
/// and linearises what remains by the pose.
std::optional<PatchFit> fitLight(const std::vector<Sample>& samples, const Noise& noise) {
  constexpr std::size_t kFewestPixels = 24;
  if (samples.size() < kFewestPixels) return std::nullopt;
  using Light = Eigen::Vector4d;
  const auto regressors = [](const Sample& sample) {
    return Light(1.0, sample.white, sample.white * sample.position.x(),
                 sample.white * sample.position.y());
  };
  PatchFit fit;
  fit.residuals.assign(samples.size(), {});
  Light light = Light::Zero();
  const auto contrastAt = [&light](const Sample& sample) {
    return light[1] + light.tail<2>().dot(sample.position);
  };
  Eigen::LDLT<Eigen::Matrix4d> factors;
  // The first round weighs all pixels alike, the second knows what is off.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Light right_side = Light::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Light x = regressors(samples[i]);
      const double weight = weightOf(fit.residuals[i], noise);
      normal.noalias() += weight * x * x.transpose();
      right_side += weight * samples[i].grey * x;
    }
    factors.compute(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    light = factors.solve(right_side);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      fit.residuals[i] = {samples[i].grey - light.dot(regressors(samples[i])), samples[i].gradient,
                          contrastAt(samples[i]) * samples[i].gradient};
    }
  }
  constexpr double kLowestContrast = 8.0;
  if (light[1] < kLowestContrast) return std::nullopt;

  Eigen::Matrix<double, 4, 3> mixed = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::RowVector3d by_pose = contrastAt(samples[i]) * samples[i].white_by_pose;
    const double weight = weightOf(fit.residuals[i], noise);
    fit.information.noalias() += weight * by_pose.transpose() * by_pose;
    fit.gradient += weight * fit.residuals[i].grey * by_pose.transpose();
    mixed.noalias() += weight * regressors(samples[i]) * by_pose;
  }
  // The light is free: what it could explain says nothing about the pose.
  fit.information -= mixed.transpose() * factors.solve(mixed);
  return fit;
}

/// The variance of which the squares are samples, by their median.
double varianceOf(std::vector<double> squares) {
  constexpr double kMedianOfChiSquare = 0.455;  // with one degree of freedom
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle / kMedianOfChiSquare;
}

/// Tells both kinds of noise apart by the pixels on even ground and those on edges.
Noise noiseOf(std::vector<Residual> residuals, double least_flat) {
  constexpr double kFlat = 0.05;  // share of white per pixel
  constexpr double kEdge = 0.25;
  constexpr std::ptrdiff_t kFewest = 30;
  constexpr Noise kTypical;
  std::sort(residuals.begin(), residuals.end(),
            [](const Residual& a, const Residual& b) { return a.gradient < b.gradient; });
  const auto firstFrom = [&residuals](double gradient) {
    return std::partition_point(residuals.begin(), residuals.end(),
                                [gradient](const Residual& r) { return r.gradient < gradient; });
  };
  // Small markers have hardly any even ground: the most even pixels must do.
  const auto count = static_cast<std::ptrdiff_t>(residuals.size());
  const auto flat_end = residuals.begin() + std::max(firstFrom(kFlat) - residuals.begin(),
                                                     std::min(kFewest, (count + 4) / 5));
  std::vector<double> flat_squares;
  std::for_each(residuals.begin(), flat_end,
                [&](const Residual& r) { flat_squares.push_back(r.grey * r.grey); });
  Noise noise;
  noise.flat = std::max(std::sqrt(varianceOf(std::move(flat_squares))), least_flat);

  const auto edge_begin = firstFrom(kEdge);
  noise.edge = kTypical.edge;
  if (residuals.end() - edge_begin < kFewest) return noise;
  std::vector<double> edge_squares;
  double gradient_square = 0.0;
  std::for_each(edge_begin, residuals.end(), [&](const Residual& r) {
    edge_squares.push_back(r.grey * r.grey);
    gradient_square += r.grey_gradient * r.grey_gradient;
  });
  gradient_square /= static_cast<double>(edge_squares.size());
  const double edge_variance = varianceOf(std::move(edge_squares)) - noise.flat * noise.flat;
  // Neighbours along an edge err alike, so that they tell less than if they did not.
  constexpr double kCorrelation = 1.5;
  noise.edge = std::sqrt(kCorrelation * std::max(0.0, edge_variance) / gradient_square);
  return noise;
}

/// Takes into account that a marker does not hang exactly where the map says, nor exactly even: the
/// pose errs along with it, however exact the pixels are.
void blurPlacement(const Marker& marker, const Pose2& pose, double deviation, PatchFit* fit) {
  const Eigen::Vector2d from_marker = Eigen::Vector2d(pose.x, pose.y) - marker.center().head<2>();
  const Eigen::Vector3d by_turn(-from_marker.y(), from_marker.x(), 1.0);
  Eigen::Matrix3d placement = by_turn * by_turn.transpose() / (marker.size * marker.size);
  placement.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity();
  placement *= deviation * deviation;
  // (information^-1 + placement)^-1, also where the information has no inverse.
  const Eigen::Matrix3d share =
      (Eigen::Matrix3d::Identity() + fit->information * placement).inverse();
  fit->information = share * fit->information;
  fit->gradient = share * fit->gradient;
}

/// How far a marker's own optimum is from a pose at which its gradient is `gradient`: chi-square
/// with 3 degrees of freedom.
double disagreement(const PatchFit& fit, const Eigen::Vector3d& gradient) {
  return gradient.dot(fit.information.ldlt().solve(gradient));
}

}  // namespace

TagPatterns::TagPatterns(const MarkerMap& map) {
  for (const Marker& marker : map.markers) {
    const auto key = std::make_pair(marker.family, marker.id);
    if (patterns_.count(key) == 0) patterns_.emplace(key, TagPattern(marker.family, marker.id));
  }
}

const TagPattern& TagPatterns::of(const Marker& marker) const {
  return patterns_.at({marker.family, marker.id});
}

std::optional<PhotometricFit> refinePhotometrically(
    const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
    const TagPatterns& patterns, const std::vector<std::size_t>& entries, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const PhotometricConfig& config) {
  std::vector<Patch> patches;
  patches.reserve(entries.size());
  for (const std::size_t entry : entries) {
    const Marker& marker = map.markers[entry];
    patches.emplace_back(panorama, marker, patterns.of(marker), camera, initial, config.blur);
  }
  Eigen::Matrix3d prior_information = Eigen::Matrix3d::Zero();
  if (prior) prior_information = prior->covariance.inverse();

  constexpr int kMaxSteps = 8;
  // Standard deviations. The averages over pixels are not smooth enough to come much closer, nor
  // would it gain anything.
  constexpr double kConverged = 0.3;
  // Chi-square that 95 of 100 markers stay below: one that disagrees by more, since it hangs a
  // little elsewhere or something shades it, counts less.
  constexpr double kDisagreement = 7.81;
  Pose2 pose = initial;
  Noise noise;
  PhotometricFit result;
  std::vector<double> weights(patches.size(), 1.0);
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::Matrix3d information = prior_information;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    if (prior) gradient = -prior_information * difference(pose, prior->pose);
    std::vector<Residual> residuals;
    std::vector<std::optional<PatchFit>> fits;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      fits.push_back(fitLight(patches[i].samples(pose), noise));
      if (!fits[i]) continue;
      blurPlacement(map.markers[entries[i]], pose, config.placement_deviation, &*fits[i]);
      information += weights[i] * fits[i]->information;
      gradient += weights[i] * fits[i]->gradient;
      residuals.insert(residuals.end(), fits[i]->residuals.begin(), fits[i]->residuals.end());
    }
    if (residuals.empty()) return std::nullopt;
    const Eigen::LLT<Eigen::Matrix3d> factors(information);
    if (factors.info() != Eigen::Success) return std::nullopt;
    const Eigen::Vector3d change = factors.solve(gradient);
    if (!change.allFinite()) return std::nullopt;
    pose = {pose.x + change.x(), pose.y + change.y(), normalizeAngle(pose.yaw + change.z())};

    const Noise noise_before =
        std::exchange(noise, noiseOf(std::move(residuals), config.min_noise));
    const bool is_settled = step > 0 &&
                            std::abs(noise.flat - noise_before.flat) < 0.1 * noise.flat &&
                            std::abs(noise.edge - noise_before.edge) < 0.1 * noise.edge + 0.01;
    if (is_settled && change.dot(information * change) < kConverged * kConverged) {
      result.map_from_base = {pose, information.inverse()};
      result.noise = noise.flat;
      result.edge_noise = noise.edge;
      result.weights = std::move(weights);
      return result;
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (!fits[i]) continue;
      const double off = disagreement(*fits[i], fits[i]->gradient - fits[i]->information * change);
      weights[i] = std::min(1.0, kDisagreement / off);
    }
  }
  return std::nullopt;
}

}  // namespace omnitag
