#include "marker/corner_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace omnitag {
namespace {

using Line = Eigen::ParametrizedLine<double, 2>;

/// The straight line y(x) that fits best.
class LinearFit {
 public:
  void add(double x, double y) {
    n_ += 1.0;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
  }

  /// Needs at least two different x.
  double at(double x) const {
    const double slope = (n_ * xy_ - x_ * y_) / (n_ * xx_ - x_ * x_);
    return y_ / n_ + slope * (x - x_ / n_);
  }

 private:
  double n_ = 0.0;
  double x_ = 0.0;
  double y_ = 0.0;
  double xx_ = 0.0;
  double xy_ = 0.0;
};

/// Grey levels across an edge at one place along it.
struct Profile {
  double along = 0.0;
  double first = 0.0;
  double last = 0.0;
  double mean = 0.0;
};

/// Grey level between pixels, bilinear; nothing outside the image.
std::optional<double> greyAt(const cv::Mat& image, const Eigen::Vector2d& point) {
  const int u = static_cast<int>(std::floor(point.x()));
  const int v = static_cast<int>(std::floor(point.y()));
  if (u < 0 || v < 0 || u + 1 >= image.cols || v + 1 >= image.rows) return std::nullopt;
  const double a = point.x() - u;
  const double b = point.y() - v;
  const std::uint8_t* const upper = image.ptr<std::uint8_t>(v) + u;
  const std::uint8_t* const lower = image.ptr<std::uint8_t>(v + 1) + u;
  return (1.0 - b) * ((1.0 - a) * upper[0] + a * upper[1]) +
         b * ((1.0 - a) * lower[0] + a * lower[1]);
}

/// From `reach` before the edge to `reach` after it.
std::optional<Profile> profileAcross(const cv::Mat& image, const Line& edge, double along,
                                     double reach) {
  constexpr double kStep = 0.5;
  const Eigen::Vector2d normal = edge.direction().unitOrthogonal();
  const int steps = std::max(4, static_cast<int>(std::ceil(2.0 * reach / kStep)));
  Profile profile;
  profile.along = along;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double offset = reach * (2.0 * i / steps - 1.0);
    const std::optional<double> grey = greyAt(image, edge.pointAt(along) + offset * normal);
    if (!grey) return std::nullopt;
    if (i == 0) profile.first = *grey;
    if (i == steps) profile.last = *grey;
    sum += *grey;
  }
  profile.mean = (sum - 0.5 * (profile.first + profile.last)) / steps;
  return profile;
}

/// The edge between the corners `index` and `index` + 1, moved to its place in the image.
Line refineEdge(const cv::Mat& image, const Corners<Eigen::Vector2d>& corners, std::size_t index,
                int modules_per_edge) {
  const Eigen::Vector2d& from = corners[index];
  const Eigen::Vector2d& to = corners[(index + 1) % 4];
  const Eigen::Vector2d& beyond = corners[(index + 2) % 4];
  const Eigen::Vector2d& before = corners[(index + 3) % 4];
  const Line edge = Line::Through(from, to);
  const double length = (to - from).norm();

  // Blur reaches no farther than this; more would only add noise.
  constexpr double kLongestReach = 3.0;
  const double depth = std::min(edge.distance(before), edge.distance(beyond));
  const double reach = std::min(0.5 * depth / modules_per_edge, kLongestReach);
  // Close to a corner the neighbouring edge interferes; the more it is inclined, the farther.
  const double lean_before = (before - from).dot(edge.direction()) / edge.distance(before);
  const double lean_beyond = (beyond - to).dot(edge.direction()) / edge.distance(beyond);
  const double lean = std::max(std::abs(lean_before), std::abs(lean_beyond));
  const double margin = std::min(1.5 + reach * lean, 0.25 * length);
  const int places = std::max(8, static_cast<int>(length));

  std::vector<Profile> profiles;
  // Light varies along an edge, but slowly: a fit to all places is less noisy.
  LinearFit first;
  LinearFit last;
  for (int i = 0; i < places; ++i) {
    const double along = margin + (length - 2.0 * margin) * i / (places - 1);
    const std::optional<Profile> profile = profileAcross(image, edge, along, reach);
    if (!profile) continue;
    first.add(along, profile->first);
    last.add(along, profile->last);
    profiles.push_back(*profile);
  }
  if (2 * static_cast<int>(profiles.size()) < places) return edge;

  LinearFit offset;
  for (const Profile& profile : profiles) {
    constexpr double kLowestContrast = 5.0;
    const double level = first.at(profile.along);
    const double contrast = last.at(profile.along) - level;
    if (std::abs(contrast) < kLowestContrast) return edge;
    const double share_of_last = (profile.mean - level) / contrast;
    offset.add(profile.along, reach * (1.0 - 2.0 * share_of_last));
  }
  const Eigen::Vector2d normal = edge.direction().unitOrthogonal();
  return Line::Through(from + offset.at(0.0) * normal, to + offset.at(length) * normal);
}

}  // namespace

Corners<Eigen::Vector2d> refineCorners(const cv::Mat& image,
                                       const Corners<Eigen::Vector2d>& corners,
                                       int modules_per_edge) {
  // The first pass finds the edges from corners that may be half a pixel off; the second samples
  // the grey levels at the right distance on both sides.
  constexpr int kPasses = 2;
  Corners<Eigen::Vector2d> refined = corners;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::array<Line, 4> edges;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      edges[i] = refineEdge(image, refined, i, modules_per_edge);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      refined[i] = edges[(i + 3) % 4].intersectionPoint(Eigen::Hyperplane<double, 2>(edges[i]));
    }
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double module = (corners[(i + 1) % 4] - corners[i]).norm() / modules_per_edge;
    const double shift = (refined[i] - corners[i]).norm();
    if (!std::isfinite(shift) || shift > module) return corners;
  }
  return refined;
}

}  // namespace omnitag
