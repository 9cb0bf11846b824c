#include "adjustment/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/calibration_checks.h"
#include "adjustment/calibration_report.h"
#include "adjustment/calibration_result.h"
#include "adjustment/camera_fit.h"
#include "adjustment/observability.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

using Indices = CameraFit::Indices;

/// The steps from a guess to a camera.
class Calibrator {
 public:
  Calibrator(const CameraTemplate& guess, const MarkerMap& map,
             const std::vector<FrameReadings>& frames, const CalibrationConfig& config,
             const CalibrationProgress& progress)
      : config_(config), fit_(guess, map, frames, config, progress) {}

  CalibrationResult run() {
    const ResidualSummary before = summaryOfGuess();
    approach();
    fit_.leaveOutOutliers();
    decideProfile();
    decideSize();
    settleProfile();
    holdUnobserved();
    fit_.settle(observed_);
    return result(before);
  }

 private:
  const CalibrationModel& model() const { return fit_.model(); }
  bool impliesConic() const { return model().camera().impliesConicConstant(); }
  double valueOf(Eigen::Index index) const { return fit_.bundle.values(index); }

  /// The residuals of the guess, with only the poses adjusted.
  ResidualSummary summaryOfGuess() {
    const Bundle start = fit_.bundle;
    fit_.adjust("poses with the guess", {}, Moving::kCameraAndPoses);
    const ResidualSummary summary = summarize(cornerResiduals(fit_.bundle));
    fit_.bundle = start;
    return summary;
  }

  /// Estimates the camera, starting at the poses from bearings. If the profile is far from the
  /// mirror's, the other parameters would diverge to compensate; then the conic constant is
  /// estimated from the beginning.
  void approach() {
    constexpr double kFarOff = 0.5;  // pixels
    constexpr double kFarBetter = 0.5;
    const Bundle start = fit_.bundle;
    setFree();
    const double before = fit_.medianResidual();
    if (!mayDoubtProfile() || before < kFarOff) return;
    const Bundle believed = fit_.bundle;
    fit_.bundle = start;
    doubts_profile_ = true;
    setFree();
    doubts_profile_ = fit_.medianResidual() < kFarBetter * before;
    if (!doubts_profile_) fit_.bundle = believed;
  }

  /// Releases more and more parameters.
  void setFree() {
    Indices radial = fit_.indicesOf({"fx", "fy", "a0", "apex_distance", "z"});
    if (doubts_profile_) radial.push_back(*model().indexOf("conic_constant"));
    fit_.adjust("radial scale", radial, Moving::kCamera);
    for (const Eigen::Index index : fit_.indicesOf({"cx", "cy", "roll", "pitch"})) {
      radial.push_back(index);
    }
    fit_.adjust("centre and lean", radial, Moving::kCameraAndPoses);
    fit_.adjust("all but the mirror's size", candidates(), Moving::kCameraAndPoses);
    fit_.adjust("markers and leaning", candidates(), Moving::kAll);
  }

  bool mayDoubtProfile() const { return impliesConic() && !fit_.isFixed("conic_constant"); }

  /// All parameters that may be estimated; the mirror's size, and a conic constant that the profile
  /// implies, only if they are in doubt.
  Indices candidates() const {
    Indices indices;
    for (std::size_t i = 0; i < model().parameters().size(); ++i) {
      const std::string& name = model().parameters()[i].name;
      const bool is_implied =
          name == "conic_constant" && (is_settled_ || (impliesConic() && !doubts_profile_));
      const bool is_size = name == "radius_of_curvature" && !doubts_size_;
      if (!fit_.isFixed(name) && !is_implied && !is_size) {
        indices.push_back(static_cast<Eigen::Index>(i));
      }
    }
    return indices;
  }

  /// Whether the corners fit clearly better with the parameter that `*doubts` adds to the
  /// candidates; if not, restores everything.
  bool fitsBetter(const std::string& step, bool* doubts) {
    const Bundle believed = fit_.bundle;
    const double before = fit_.rms();
    *doubts = true;
    fit_.adjust(step, candidates(), Moving::kAll);
    const double after = fit_.rms();
    *doubts = isClearlyBetter(after, before);
    if (!*doubts) {
      fit_.bundle = believed;
      return false;
    }
    improvement_ = decimals(before, 3) + " to " + decimals(after, 3) + " px";
    return true;
  }

  /// Keeps a profile that implies the conic constant unless another constant fits better.
  void decideProfile() {
    fit_.adjust("everything", candidates(), Moving::kAll);
    if (doubts_profile_) {
      fit_.remarks.emplace_back("the mirror does not have the guess's profile, which fits nowhere");
    } else if (mayDoubtProfile() && fitsBetter("another profile", &doubts_profile_)) {
      fit_.remarks.push_back(
          "the mirror does not have the guess's profile: another conic constant brings the "
          "residual from " +
          improvement_);
    }
  }

  /// A mirror's size shows only in parallax. A caliper measures it better than images do, so the
  /// guess is kept unless they contradict it.
  void decideSize() {
    Indices all = fit_.indicesOf({"radius_of_curvature"});
    if (all.empty()) return;
    if (fitsBetter("another size of the mirror", &doubts_size_)) {
      fit_.remarks.push_back(
          "the mirror does not have the guess's size: another one brings the residual from " +
          improvement_);
      return;
    }
    const Indices others = candidates();
    all.insert(all.end(), others.begin(), others.end());
    size_deviation_ = uncertaintyOf(model(), all, fit_.cameraInformation(all)).deviations(0);
  }

  /// If a mirror does not have the guess's profile, decides whether it is a sphere or a paraboloid:
  /// the one whose conic constant agrees with the estimate, unless the corners then fit clearly
  /// worse. If it is, the distance between lens and mirror is known several times better.
  void settleProfile() {
    if (!doubts_profile_) return;
    const Indices all = candidates();
    const Eigen::Index conic = *model().indexOf("conic_constant");
    const auto place = std::find(all.begin(), all.end(), conic) - all.begin();
    const double deviation =
        uncertaintyOf(model(), all, withCommonError(fit_.cameraInformation(all))).deviations(place);
    constexpr double kAgrees = 2.0;  // deviations
    for (const double implied : {0.0, -1.0}) {
      if (std::abs(valueOf(conic) - implied) > kAgrees * deviation) continue;
      const Bundle estimated = fit_.bundle;
      const double before = fit_.rms();
      fit_.bundle.values(conic) = implied;
      is_settled_ = true;
      fit_.adjust("a sphere or a paraboloid", candidates(), Moving::kAll);
      is_settled_ = !isClearlyBetter(before, fit_.rms());
      if (is_settled_) return;
      fit_.bundle = estimated;
    }
  }

  void holdUnobserved() {
    const Indices all = candidates();
    const Observability split = observability(model(), all, fit_.cameraInformation(all));
    for (const auto& [index, deviation] : split.held) refuseIfEssential(index, deviation);
    held_ = split.held;
    observed_ = split.observed;
    const Bundle estimated = fit_.bundle;
    const double before = fit_.rms();
    for (const auto& [index, deviation] : held_) fit_.bundle.values(index) = fit_.guess()(index);
    fit_.adjust("what is observed", observed_, Moving::kAll);
    // The guesses of two parameters that trade off against each other may be so far off that the
    // others cannot compensate.
    holds_estimates_ = isClearlyBetter(before, fit_.rms());
    if (!holds_estimates_) return;
    fit_.bundle = estimated;
    fit_.adjust("what is observed", observed_, Moving::kAll);
  }

  static bool isClearlyBetter(double rms, double than) {
    constexpr double kClearly = 0.05;  // of the mean square
    return rms * rms < (1.0 - kClearly) * than * than;
  }

  void refuseIfEssential(Eigen::Index index, double deviation) const {
    const std::string& name = fit_.nameOf(index);
    if (name != "fx" && name != "fy" && name != "a0" && name != "cx" && name != "cy") return;
    throw InputError("the images do not tell " + name + " (standard deviation " +
                     decimals(deviation, 1) +
                     " px): record more images in other places, with markers near and far and all "
                     "around");
  }

  std::string whyHeld(Eigen::Index index) const {
    const std::string& name = fit_.nameOf(index);
    if (config_.is_free && model().isOfMounting(index)) return "a board does not tell it";
    if (fit_.isFixed(name)) return "as told";
    if (name == "conic_constant" && impliesConic() && !doubts_profile_) {
      return "the guess's profile fits";
    }
    if (name == "conic_constant" && is_settled_) {
      return valueOf(index) == 0.0 ? "as of a sphere, which fits"
                                   : "as of a paraboloid, which fits";
    }
    if (name == "radius_of_curvature" && !doubts_size_) {
      return "images tell it to " + significant(size_deviation_, 2) + " only; measure it";
    }
    for (const auto& [held, deviation] : held_) {
      if (held != index) continue;
      return "not observed, +- " + significant(deviation, 2) +
             (holds_estimates_ ? "; where the others fit" : "");
    }
    return "";
  }

  CalibrationResult result(const ResidualSummary& before) const {
    CalibrationOutcome outcome{fit_, observed_, {}};
    for (std::size_t i = 0; i < model().parameters().size(); ++i) {
      outcome.why_held.push_back(whyHeld(static_cast<Eigen::Index>(i)));
    }
    return resultOf(outcome, before, config_);
  }

  const CalibrationConfig& config_;
  CameraFit fit_;
  bool doubts_profile_ = false;
  bool doubts_size_ = false;
  /// Whether the mirror is a sphere or a paraboloid although the guess was neither or the other.
  bool is_settled_ = false;
  double size_deviation_ = 0.0;
  /// The improvement by the last doubt, in words.
  std::string improvement_;
  Indices observed_;
  std::vector<std::pair<Eigen::Index, double>> held_;
  /// Whether the held parameters stay at their estimates instead of the guess.
  bool holds_estimates_ = false;
};

}  // namespace

CalibrationResult calibrateCamera(const CameraTemplate& guess, const MarkerMap& map,
                                  const std::vector<FrameReadings>& frames,
                                  const CalibrationConfig& config,
                                  const CalibrationProgress& progress) {
  if (frames.empty()) throw InputError("expected images, found none");
  checkMounting(frames);
  return Calibrator(guess, map, frames, config, progress).run();
}

}  // namespace omnitag
