#include "adjustment/observability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "adjustment/joint_estimate.h"

namespace omnitag {
namespace {

/// "a1" stands for all coefficients of an ocam camera but a0.
constexpr std::array<std::string_view, 24> kFirstToHold = {"radius_of_curvature",
                                                           "k4",
                                                           "k3",
                                                           "p2",
                                                           "p1",
                                                           "k2",
                                                           "k1",
                                                           "a1",
                                                           "e",
                                                           "d",
                                                           "beta",
                                                           "alpha",
                                                           "xi",
                                                           "apex_distance",
                                                           "conic_constant",
                                                           "z",
                                                           "pitch",
                                                           "roll",
                                                           "c",
                                                           "fy",
                                                           "fx",
                                                           "a0",
                                                           "cy",
                                                           "cx"};

/// The smaller, the sooner a parameter is held; of a polynomial, the highest coefficient first.
std::ptrdiff_t rankOf(const std::string& name) {
  constexpr std::ptrdiff_t kMostCoefficients = 100;
  const bool is_coefficient = name.size() > 1 && name.front() == 'a' && name != "a0" &&
                              std::isdigit(static_cast<unsigned char>(name[1])) != 0;
  const std::string_view listed = is_coefficient ? "a1" : std::string_view(name);
  const std::ptrdiff_t place =
      std::find(kFirstToHold.begin(), kFirstToHold.end(), listed) - kFirstToHold.begin();
  return kMostCoefficients * place - (is_coefficient ? std::stoi(name.substr(1)) : 0);
}

const CalibrationParameter& parameterAt(const CalibrationModel& model, Eigen::Index index) {
  return model.parameters()[static_cast<std::size_t>(index)];
}

/// The inverse of an information matrix; undetermined directions become very uncertain, but not
/// infinitely so.
Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& information) {
  constexpr double kNothing = 1e-12;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const double least = kNothing * std::max(eigen.eigenvalues().maxCoeff(), 1e-12);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(least).cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// The index of the parameter to hold: of all that are too uncertain, or trade off against one that
/// is, the first in kFirstToHold; -1 if none is too uncertain.
std::ptrdiff_t firstToHold(const CalibrationModel& model, const ParameterUncertainty& uncertainty) {
  constexpr double kTradesOff = 0.5;
  std::ptrdiff_t first = -1;
  const auto size = static_cast<Eigen::Index>(uncertainty.free.size());
  const auto parameter = [&](Eigen::Index place) -> const CalibrationParameter& {
    return parameterAt(model, uncertainty.free[static_cast<std::size_t>(place)]);
  };
  for (Eigen::Index i = 0; i < size; ++i) {
    if (uncertainty.deviations(i) <= parameter(i).tolerable) continue;
    for (Eigen::Index j = 0; j < size; ++j) {
      if (std::abs(uncertainty.correlations(i, j)) < kTradesOff) continue;
      const bool goes_first =
          first < 0 || rankOf(parameter(j).name) < rankOf(parameter(first).name);
      if (goes_first) first = j;
    }
  }
  return first;
}

}  // namespace

ParameterUncertainty uncertaintyOf(const CalibrationModel& model,
                                   const std::vector<Eigen::Index>& free,
                                   const CameraInformation& information) {
  if (free.empty()) return {};
  const Eigen::MatrixXd covariance = covarianceOf(information.matrix);
  const Eigen::VectorXd deviations = covariance.diagonal().cwiseSqrt();
  Eigen::VectorXd variances = covariance.diagonal();
  if (information.common_error > 0.0) {
    const Eigen::MatrixX2d shifts =
        information.common_error * covariance * information.common_error_gradient;
    variances += shifts.rowwise().squaredNorm();
  }
  ParameterUncertainty uncertainty{free, variances.cwiseSqrt(), covariance};
  for (Eigen::Index i = 0; i < deviations.size(); ++i) {
    uncertainty.deviations(i) *= parameterAt(model, free[static_cast<std::size_t>(i)]).scale;
  }
  const Eigen::VectorXd inverse = deviations.cwiseInverse();
  uncertainty.correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  return uncertainty;
}

Observability observability(const CalibrationModel& model,
                            const std::vector<Eigen::Index>& candidates,
                            const CameraInformation& information) {
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    places.push_back(static_cast<Eigen::Index>(i));
  }
  Observability result;
  result.observed = candidates;
  while (!result.observed.empty()) {
    const ParameterUncertainty uncertainty =
        uncertaintyOf(model, result.observed, {part(information.matrix, places)});
    const std::ptrdiff_t first = firstToHold(model, uncertainty);
    if (first < 0) break;
    result.held.emplace_back(result.observed[static_cast<std::size_t>(first)],
                             uncertainty.deviations(first));
    result.observed.erase(result.observed.begin() + first);
    places.erase(places.begin() + first);
  }
  return result;
}

}  // namespace omnitag
