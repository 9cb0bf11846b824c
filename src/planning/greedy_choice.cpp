#include "planning/greedy_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/parallel.h"

namespace omnitag {
namespace {

/// Of a positive definite matrix.
double logDeterminant(const FrameMatrix& information) {
  const Eigen::LLT<FrameMatrix> factors(information);
  const FrameMatrix& triangle = factors.matrixLLT();
  return 2.0 * triangle.diagonal().array().log().sum();
}

/// The poses' information with all that was chosen.
class Measure {
 public:
  explicit Measure(const InformationProblem& problem) : problem_(problem), sums_(problem.known) {
    for (const FrameMatrix& sum : sums_) values_.push_back(logDeterminant(sum));
  }

  double gainOf(std::size_t candidate) const {
    double gain = 0.0;
    for (const AddedInformation& added : problem_.addedBy(candidate)) {
      gain += logDeterminant(sums_[added.pose] + added.information) - values_[added.pose];
    }
    return std::max(0.0, gain);
  }

  void add(std::size_t candidate) {
    for (const AddedInformation& added : problem_.addedBy(candidate)) {
      sums_[added.pose] += added.information;
      values_[added.pose] = logDeterminant(sums_[added.pose]);
    }
  }

 private:
  const InformationProblem& problem_;
  std::vector<FrameMatrix> sums_;
  std::vector<double> values_;
};

struct Bound {
  std::size_t candidate;
  /// The candidate's gain when `chosen` others were chosen: an upper bound of its gain now.
  double gain;
  std::size_t chosen;
};

bool isLess(const Bound& a, const Bound& b) {
  return a.gain != b.gain ? a.gain < b.gain : a.candidate > b.candidate;
}

double guaranteedShare(const GreedyChoice& choice, std::vector<Bound> left) {
  double gain = 0.0;
  for (const double one : choice.gains) gain += one;
  std::sort(left.begin(), left.end(), [](const Bound& a, const Bound& b) { return isLess(b, a); });
  double more = 0.0;
  for (std::size_t i = 0; i < std::min(left.size(), choice.gains.size()); ++i) {
    more += left[i].gain;
  }
  return gain > 0.0 ? std::max(gain / (gain + more), 1.0 - std::exp(-1.0)) : 1.0;
}

}  // namespace

GreedyChoice chooseGreedily(const InformationProblem& problem, std::size_t count, int threads) {
  Measure measure(problem);
  std::vector<Bound> bounds(problem.candidates);
  forEachIndex(problem.candidates, threads, 1, [&](std::size_t i) {
    bounds[i] = {i, measure.gainOf(i), 0};
  });
  std::make_heap(bounds.begin(), bounds.end(), isLess);
  GreedyChoice choice;
  while (choice.candidates.size() < count && !bounds.empty()) {
    std::pop_heap(bounds.begin(), bounds.end(), isLess);
    Bound best = bounds.back();
    bounds.pop_back();
    if (best.chosen < choice.candidates.size()) {
      best.gain = measure.gainOf(best.candidate);
      best.chosen = choice.candidates.size();
      bounds.push_back(best);
      std::push_heap(bounds.begin(), bounds.end(), isLess);
      continue;
    }
    if (!(best.gain > 0.0)) break;
    measure.add(best.candidate);
    choice.candidates.push_back(best.candidate);
    choice.gains.push_back(best.gain);
  }
  choice.guaranteed_share = guaranteedShare(choice, std::move(bounds));
  return choice;
}

}  // namespace omnitag
