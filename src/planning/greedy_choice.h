#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "camera/mounted_camera.h"

namespace omnitag {

/// What a marker adds to the information about the unknowns of an image from one of some poses.
struct AddedInformation {
  std::size_t pose = 0;
  FrameMatrix information;
};

/// Which of some candidates to add. The measure of a choice is the sum over the poses of the log
/// determinant of their information about all of a frame's unknowns.
struct InformationProblem {
  /// One for each pose, positive definite: the priors and the markers that hang already.
  std::vector<FrameMatrix> known;
  std::size_t candidates = 0;
  /// What a candidate adds, and to which poses. May be called from several threads at once.
  std::function<std::vector<AddedInformation>(std::size_t candidate)> addedBy;
};

struct GreedyChoice {
  /// In the order in which they were chosen; fewer than asked for if the others add nothing.
  std::vector<std::size_t> candidates;
  /// By how much the measure rises with each of them.
  std::vector<double> gains;
  /// The choice gains at least this share of what the best choice of as many candidates gains.
  double guaranteed_share = 1.0;
};

/// Chooses, one after the other, the candidate that raises the measure most.
///
/// The measure is monotone and submodular, since markers are independent measurements of the
/// unknowns (Krause, Singh and Guestrin 2008); the greedy choice therefore gains at least 1 - 1/e
/// of the best one (Nemhauser, Wolsey and Fisher 1978). No choice gains more than this one and the
/// largest remaining gains together (Minoux 1978), which usually guarantees more. Gains computed
/// before others were chosen are upper bounds, so that few are computed again.
GreedyChoice chooseGreedily(const InformationProblem& problem, std::size_t count, int threads);

}  // namespace omnitag
