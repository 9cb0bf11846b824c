#include "measurement/consensus.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/symmetric_matrix.h"

namespace omnitag {
namespace {

using Markers = std::vector<std::optional<FrameEquations>>;

/// By how much one more marker may raise chi-square (six degrees of freedom): far beyond chance,
/// since effects that the camera file does not describe displace each marker a little.
constexpr double kMostPerMarker = 36.0;

FrameEquations sumOf(const Markers& markers, const std::vector<bool>& which, const PosePrior& prior,
                     const Pose& pose, const ImagingError& error) {
  FrameEquations sum;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (which[i] && markers[i]) sum.add(*markers[i], 1.0);
  }
  return withPriors(sum, prior, pose, error);
}

/// A set of markers, and how badly they disagree.
struct Set {
  std::vector<bool> members;
  std::size_t size = 0;
  double chi_square = 0.0;
};

class Grower {
 public:
  Grower(const Markers& markers, const PosePrior& prior, const Pose& pose,
         const ImagingError& error, double excess)
      : markers_(markers),
        prior_(prior),
        pose_(pose),
        error_(error),
        most_(kMostPerMarker * excess) {}

  Set grownFrom(std::size_t seed) const {
    Set set{std::vector<bool>(markers_.size(), false), 0, 0.0};
    set = with(seed, set);
    while (true) {
      Set best;
      best.chi_square = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < markers_.size(); ++i) {
        if (!markers_[i] || set.members[i]) continue;
        Set more = with(i, set);
        if (more.chi_square < best.chi_square) best = std::move(more);
      }
      if (!(best.chi_square <= set.chi_square + most_)) return set;
      set = std::move(best);
    }
  }

 private:
  Set with(std::size_t marker, const Set& set) const {
    Set more{set.members, set.size + 1, std::numeric_limits<double>::infinity()};
    more.members[marker] = true;
    const auto change = solutionOf(sumOf(markers_, more.members, prior_, pose_, error_));
    if (!change) return more;
    const PoseVector off = prior_.errorOf(moved(pose_, change->head<6>()));
    more.chi_square = off.dot(prior_.information * off) +
                      (error_ + change->tail<kImagingUnknowns>()).squaredNorm();
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      if (more.members[i]) more.chi_square += chiSquareOf(*markers_[i], *change);
    }
    return more;
  }

  const Markers& markers_;
  const PosePrior& prior_;
  const Pose& pose_;
  const ImagingError& error_;
  double most_;
};

}  // namespace

std::vector<bool> consensusOf(const Markers& markers, const PosePrior& prior, const Pose& pose,
                              const ImagingError& error, double excess) {
  const Grower grower(markers, prior, pose, error, excess);
  Set best;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!markers[i]) continue;
    Set set = grower.grownFrom(i);
    const bool is_better =
        set.size > best.size || (set.size == best.size && set.chi_square < best.chi_square);
    if (is_better) best = std::move(set);
  }
  std::vector<bool> agree(markers.size(), true);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (markers[i]) agree[i] = best.members[i];
  }
  return agree;
}

std::optional<PoseEstimate> poseOf(const Markers& markers, const std::vector<bool>& which,
                                   const PosePrior& prior, const Pose& pose,
                                   const ImagingError& error) {
  const FrameEquations all = sumOf(markers, which, prior, pose, error);
  const auto change = solutionOf(all);
  if (!change) return std::nullopt;
  return PoseEstimate{moved(pose, change->head<6>()),
                      inverseOf(all.information).topLeftCorner<6, 6>()};
}

}  // namespace omnitag
