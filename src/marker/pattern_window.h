#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace omnitag {

/// What a pixel sees: a parallelogram given by its sides (modules), blurred by a Gaussian of this
/// variance (pixels squared), and swept along a displacement (modules). A sharp parallelogram is
/// cut into four, each of which is averaged as if its sides ran along the modules. A blurred one is
/// a Gaussian as a whole: a few Gaussians along the modules' axes, whose places on a line account
/// for the correlation. The sweep is made in steps of half a side, if these are not too many.
class PatternWindow {
 public:
  PatternWindow() = default;
  PatternWindow(const Eigen::Vector2d& side_u, const Eigen::Vector2d& side_v,
                double blur_variance = 0.0, const Eigen::Vector2d& sweep = Eigen::Vector2d::Zero());

  /// How far it reaches from its middle along the modules' axes.
  const Eigen::Vector2d& reach() const { return reach_; }

  /// How far nearly all of it reaches from its middle; all of it if it is sharp. Beyond the
  /// drawing, the drawing's edge is continued.
  const Eigen::Vector2d& core() const { return core_; }

  bool isBlurred() const { return is_blurred_; }

  /// The size of a rectangle along the modules' axes that approximates all of it.
  const Eigen::Vector2d& size() const { return size_; }

 private:
  friend class TagPattern;
  /// One of the rectangles or Gaussians that it is made of.
  struct Place {
    Eigen::Vector2d from_middle = Eigen::Vector2d::Zero();
    double share = 0.0;
  };
  void add(const Eigen::Vector2d& from_middle, double share) {
    places_[place_count_++] = {from_middle, share};
  }

  /// Calls `visit` with the middle of each place, at each step of the sweep, and its share.
  template <typename Visit>
  void visit(const Eigen::Vector2d& position, const Visit& visit) const {
    const double per_step = 1.0 / steps_;
    for (int i = 0; i < steps_; ++i) {
      const Eigen::Vector2d middle = position + (i - 0.5 * (steps_ - 1)) * step_;
      for (std::size_t k = 0; k < place_count_; ++k) {
        visit(middle + places_[k].from_middle, per_step * places_[k].share);
      }
    }
  }

  Eigen::Vector2d reach_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d core_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d size_ = Eigen::Vector2d::Zero();
  std::array<Place, 5> places_{};
  std::size_t place_count_ = 0;
  /// At each place: half the sides of rectangles, the standard deviations of Gaussians.
  Eigen::Vector2d extent_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d step_ = Eigen::Vector2d::Zero();
  int steps_ = 1;
  bool is_blurred_ = false;
};

}  // namespace omnitag
