#include "omnitag/adjustment/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "calibration_checks.h"
#include "calibration_report.h"
#include "calibration_result.h"
#include "omnitag/adjustment/calibration_data.h"
#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/adjustment/observability.h"
#include "omnitag/adjustment/pose_from_bearings.h"
#include "omnitag/common/error.h"
#include "outliers.h"

namespace omnitag {
namespace {

using Indices = std::vector<Eigen::Index>;

constexpr std::size_t kMinFrames = 10;

/// The steps from a guess to a camera, over what they share.
class Calibrator {
 public:
  Calibrator(const CameraTemplate& guess, const MarkerMap& map,
             const std::vector<FrameReadings>& frames, const CalibrationConfig& config,
             const CalibrationProgress& progress)
      : map_(map),
        config_(config),
        progress_(progress),
        model_(guess, LeaningMounting(frames.front().base_from_camera)),
        data_(selectObservations(map, frames, !config.is_rough)),
        adjustment_(map_, data_.frames, model_) {
    for (const std::string& name : config_.fixed) {
      if (!model_.indexOf(name)) {
        throw InputError("fixed parameters: expected some of " + namesOf(model_) + ", found '" +
                         name + "'");
      }
    }
    state_.values = model_.guess();
  }

  CalibrationResult run() {
    if (!config_.is_rough)
      checkCoverage(data_.frames, model_.camera().camera(guessedCamera())->imagePlane());
    findPoses();
    checkMotion(state_.poses);
    const ResidualSummary before = summaryOfGuess();
    approach();
    leaveOutOutliers();
    decideProfile();
    decideSize();
    settleProfile();
    holdUnobserved();
    return result(before);
  }

 private:
  Eigen::VectorXd guessedCamera() const { return model_.cameraValues(model_.guess()); }

  const std::string& nameOf(Eigen::Index index) const {
    return model_.parameters()[static_cast<std::size_t>(index)].name;
  }

  bool isFixed(const std::string& name) const { return config_.fixed.count(name) > 0; }

  /// Of those names, the parameters that there are and that may change.
  Indices indicesOf(std::initializer_list<const char*> names) const {
    Indices indices;
    for (const char* name : names) {
      const auto index = model_.indexOf(name);
      if (index && !isFixed(name)) indices.push_back(*index);
    }
    return indices;
  }

  void findPoses() {
    const MountedCamera camera = model_.mounted(model_.guess());
    std::vector<CalibrationFrame> frames;
    for (CalibrationFrame& frame : data_.frames) {
      const auto pose = poseFromBearings(map_, camera, frame);
      if (!pose) continue;
      state_.poses.push_back(*pose);
      frames.push_back(std::move(frame));
    }
    const std::size_t all = data_.frames.size();
    data_.frames = std::move(frames);
    if (data_.frames.size() >= kMinFrames) return;
    throw InputError("bearings to the markers agree with the map in " +
                     std::to_string(data_.frames.size()) + " of " + std::to_string(all) +
                     " images only, expected at least " + std::to_string(kMinFrames) +
                     ": look at the map, at lens.cx and lens.cy (the centre of the image's circle) "
                     "and at which way the optical axis points");
  }

  double medianResidual() const {
    std::vector<double> lengths;
    for (const CornerResidual& corner : adjustment_.residuals(state_)) {
      lengths.push_back(lengthOf(corner));
    }
    return medianOf(std::move(lengths));
  }

  /// Minimizes with a robust width that narrows as the residuals do.
  void adjust(const std::string& step, const Indices& free, bool adjusts_poses = true) {
    constexpr double kWide = 3.0;     // median residuals
    constexpr double kWidest = 60.0;  // pixels
    constexpr int kMaxRounds = 5;
    AdjustmentConfig adjustment;
    adjustment.free = free;
    adjustment.adjusts_poses = adjusts_poses;
    double last_width = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kMaxRounds; ++round) {
      adjustment.robust_width =
          std::max(config_.robust_width, std::min(kWide * medianResidual(), kWidest));
      // Once more with a width that is hardly narrower changes nothing.
      constexpr double kHardly = 0.9;
      if (adjustment.robust_width > kHardly * last_width) break;
      last_width = adjustment.robust_width;
      state_ = adjustment_.minimize(state_, adjustment, [&](int iteration, double) {
        if (progress_) progress_(step, iteration);
      });
    }
  }

  /// The poses alone: what a guess is worth.
  ResidualSummary summaryOfGuess() {
    const CalibrationState start = state_;
    adjust("poses with the guess", {});
    const ResidualSummary summary = summarize(adjustment_.residuals(state_));
    state_ = start;
    return summary;
  }

  /// From the bearings' poses to a camera. With a profile that is far from the mirror's, the rest
  /// would run off to make up for it: then another one is looked for from the beginning.
  void approach() {
    constexpr double kFarOff = 0.5;  // pixels
    constexpr double kFarBetter = 0.5;
    const CalibrationState start = state_;
    setFree();
    const double before = medianResidual();
    if (!mayDoubtProfile() || before < kFarOff) return;
    const CalibrationState believed = state_;
    state_ = start;
    doubts_profile_ = true;
    setFree();
    doubts_profile_ = medianResidual() < kFarBetter * before;
    if (!doubts_profile_) state_ = believed;
  }

  /// More and more is set free.
  void setFree() {
    Indices radial = indicesOf({"fx", "fy", "apex_distance", "z"});
    if (doubts_profile_) radial.push_back(*model_.indexOf("conic_constant"));
    adjust("radial scale", radial, false);
    for (const Eigen::Index index : indicesOf({"cx", "cy", "roll", "pitch"})) {
      radial.push_back(index);
    }
    adjust("centre and lean", radial);
    adjust("all but the mirror's size", candidates());
  }

  bool mayDoubtProfile() const {
    return model_.camera().impliesConicConstant() && !isFixed("conic_constant");
  }

  /// All that may be estimated: but for the mirror's size and a conic constant that the profile
  /// implies, as long as these are not in doubt.
  Indices candidates() const {
    Indices indices;
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      const std::string& name = model_.parameters()[i].name;
      const bool is_implied =
          name == "conic_constant" &&
          (is_settled_ || (model_.camera().impliesConicConstant() && !doubts_profile_));
      const bool is_size = name == "radius_of_curvature" && !doubts_size_;
      if (!isFixed(name) && !is_implied && !is_size) {
        indices.push_back(static_cast<Eigen::Index>(i));
      }
    }
    return indices;
  }

  void leaveOutOutliers() {
    leaveOutFrames(adjustment_.residuals(state_), &data_, &state_);
    if (data_.frames.size() < kMinFrames) {
      throw InputError("no camera explains the images: look at the map, and at the guess's model");
    }
    leaveOutMarkers(adjustment_.residuals(state_), map_, &data_);
  }

  /// Whether the corners fit clearly better once `*doubts` adds a parameter to the candidates; if
  /// they do not, all stays as it was.
  bool fitsBetter(const std::string& step, bool* doubts) {
    const CalibrationState believed = state_;
    const double before = summarize(adjustment_.residuals(state_)).rms;
    *doubts = true;
    adjust(step, candidates());
    const double after = summarize(adjustment_.residuals(state_)).rms;
    *doubts = isClearlyBetter(after, before);
    if (!*doubts) {
      state_ = believed;
      return false;
    }
    fit_ = decimals(before, 3) + " to " + decimals(after, 3) + " px";
    return true;
  }

  /// A profile that implies the conic constant is believed unless another constant fits better.
  void decideProfile() {
    adjust("everything", candidates());
    if (doubts_profile_) {
      data_.remarks.emplace_back(
          "the mirror does not have the guess's profile, which fits nowhere");
    } else if (mayDoubtProfile() && fitsBetter("another profile", &doubts_profile_)) {
      data_.remarks.push_back(
          "the mirror does not have the guess's profile: another conic constant brings the "
          "residual "
          "from " +
          fit_);
    }
  }

  /// The size of a mirror shows in parallax alone: a caliper measures it better than images do,
  /// which are believed only where they contradict.
  void decideSize() {
    const auto size = indicesOf({"radius_of_curvature"});
    if (size.empty()) return;
    if (fitsBetter("another size of the mirror", &doubts_size_)) {
      data_.remarks.push_back(
          "the mirror does not have the guess's size: another one brings the residual from " +
          fit_);
      return;
    }
    AdjustmentConfig all;
    all.robust_width = config_.robust_width;
    all.free = candidates();
    all.free.insert(all.free.begin(), size.front());
    size_deviation_ =
        uncertaintyOf(model_, all.free, adjustment_.information(state_, all)).deviations(0);
  }

  /// Of a mirror that is none of the guess's kind, whether it is a sphere or a paraboloid: that of
  /// the two whose conic constant the estimate agrees with, unless the corners then fit clearly
  /// worse. The lens's and the mirror's distance are several times better known then.
  void settleProfile() {
    if (!doubts_profile_) return;
    AdjustmentConfig all;
    all.robust_width = config_.robust_width;
    all.free = candidates();
    const AdjustmentInformation information = informationAt(adjustment_, state_, all);
    const Eigen::Index conic = *model_.indexOf("conic_constant");
    const auto place = std::find(all.free.begin(), all.free.end(), conic) - all.free.begin();
    const double deviation = uncertaintyOf(model_, all.free, information).deviations(place);
    constexpr double kAgrees = 2.0;  // deviations
    for (const double implied : {0.0, -1.0}) {
      if (std::abs(state_.values(conic) - implied) > kAgrees * deviation) continue;
      const CalibrationState estimated = state_;
      const double before = summarize(adjustment_.residuals(state_)).rms;
      state_.values(conic) = implied;
      is_settled_ = true;
      adjust("a sphere or a paraboloid", candidates());
      is_settled_ = !isClearlyBetter(before, summarize(adjustment_.residuals(state_)).rms);
      if (is_settled_) return;
      state_ = estimated;
    }
  }

  void holdUnobserved() {
    AdjustmentConfig all;
    all.robust_width = config_.robust_width;
    all.free = candidates();
    const Observability split =
        observability(model_, all.free, adjustment_.information(state_, all));
    for (const auto& [index, deviation] : split.held) refuseIfEssential(index, deviation);
    held_ = split.held;
    observed_ = split.observed;
    const CalibrationState estimated = state_;
    const double before = summarize(adjustment_.residuals(state_)).rms;
    for (const auto& [index, deviation] : held_) state_.values(index) = model_.guess()(index);
    adjust("what is observed", observed_);
    // Two that trade off against each other may both be off in the guess, by more than the rest can
    // make up for.
    const double after = summarize(adjustment_.residuals(state_)).rms;
    holds_estimates_ = isClearlyBetter(before, after);
    if (!holds_estimates_) return;
    state_ = estimated;
    adjust("what is observed", observed_);
  }

  static bool isClearlyBetter(double rms, double than) {
    constexpr double kClearly = 0.05;  // of the mean square
    return rms * rms < (1.0 - kClearly) * than * than;
  }

  void refuseIfEssential(Eigen::Index index, double deviation) const {
    const std::string& name = nameOf(index);
    if (name != "fx" && name != "fy" && name != "cx" && name != "cy") return;
    throw InputError("the images do not tell " + name + " (standard deviation " +
                     decimals(deviation, 1) +
                     " px): record more images in other places, with markers near and far and all "
                     "around");
  }

  std::string whyHeld(Eigen::Index index) const {
    const std::string& name = nameOf(index);
    if (isFixed(name)) return "as told";
    if (name == "conic_constant" && model_.camera().impliesConicConstant() && !doubts_profile_) {
      return "the guess's profile fits";
    }
    if (name == "conic_constant" && is_settled_) {
      return state_.values(index) == 0.0 ? "as of a sphere, which fits"
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
    CalibrationOutcome outcome{model_, data_, adjustment_, state_, observed_, {}};
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      outcome.why_held.push_back(whyHeld(static_cast<Eigen::Index>(i)));
    }
    return resultOf(outcome, before, config_);
  }

  const MarkerMap& map_;
  const CalibrationConfig& config_;
  const CalibrationProgress& progress_;
  CalibrationModel model_;
  CalibrationData data_;
  BundleAdjustment adjustment_;
  CalibrationState state_;
  bool doubts_profile_ = false;
  bool doubts_size_ = false;
  /// Whether it is a sphere or a paraboloid, though the guess was another.
  bool is_settled_ = false;
  double size_deviation_ = 0.0;
  /// How much better the last doubt made it, in words.
  std::string fit_;
  Indices observed_;
  std::vector<std::pair<Eigen::Index, double>> held_;
  /// Whether these are held where they fit instead of at the guess.
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
