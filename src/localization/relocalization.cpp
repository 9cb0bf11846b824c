#include "omnitag/localization/relocalization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "omnitag/common/angle.h"
#include "omnitag/localization/marker_pose.h"

namespace omnitag {
namespace {

using Assignment = std::vector<std::optional<std::size_t>>;

/// What a reading costs that a hypothesis does not explain.
constexpr double kCostOfUnexplained = 20.0;

double saturated(double cost) { return cost * kCostOfUnexplained / (cost + kCostOfUnexplained); }

/// A pose and the readings that it explains.
struct Hypothesis {
  ReprojectionFit fit;
  Assignment entries;
  std::vector<double> residuals;
  std::size_t explained = 0;
  /// Negative logarithm of the likelihood of the explained readings, but for a constant.
  double cost = 0.0;
  /// The same over all readings, each counting for at most kCostOfUnexplained: what ranks
  /// hypotheses, since a pose between two that fit well explains more, and each badly.
  double saturated_cost = 0.0;
};

/// A start for a hypothesis: the pose of one marker's corners, and how many readings may agree.
struct Seed {
  PoseEstimate map_from_base;
  Assignment entries;
  std::size_t promised = 0;
};

std::size_t countOf(const Assignment& entries) {
  return static_cast<std::size_t>(
      std::count_if(entries.begin(), entries.end(), [](const auto& entry) { return !!entry; }));
}

class Search {
 public:
  Search(const MarkerMap& map, const MountedCamera& camera,
         const std::vector<MarkerReading>& readings, const ReprojectionConfig& reprojection,
         double max_residual, const RelocalizationConfig& config)
      : map_(map),
        camera_(camera),
        readings_(readings),
        reprojection_(reprojection),
        max_residual_(max_residual),
        config_(config) {
    for (const MarkerReading& reading : readings) {
      candidates_.push_back(entriesOf(map, reading.family, reading.id));
    }
  }

  /// The best hypothesis; nothing, and the reason in words, where there is none or more than one.
  std::optional<Hypothesis> likeliest(std::string* reason) const {
    if (!hasCandidates()) {
      *reason = "no marker of the map was read";
      return std::nullopt;
    }
    std::vector<Hypothesis> all = hypotheses();
    if (all.empty()) {
      *reason = "no pose explains what was read";
      return std::nullopt;
    }
    const auto rivals = std::count_if(all.begin() + 1, all.end(), [&](const Hypothesis& other) {
      return isRival(all.front(), other);
    });
    if (rivals > 0) {
      *reason = std::to_string(rivals + 1) + " poses explain what was read about equally well";
      return std::nullopt;
    }
    return std::move(all.front());
  }

  /// The covariance that corners leave. Nothing but they tell, and few of them hardly tell how good
  /// they are.
  Eigen::Matrix3d covarianceOf(const Hypothesis& hypothesis) const {
    const double rise = config_.corner_noise / reprojection_.corner_noise;
    return std::max(rise * rise, varianceFactor(hypothesis.fit)) *
           hypothesis.fit.map_from_base.covariance;
  }

  /// The covariance of a pose that stands on one marker. Along the way around a marker that is seen
  /// from its front, the corners hardly change, and by no means as a straight line: how far the
  /// robot may be off along the least certain direction is found by going there.
  Eigen::Matrix3d spread(const Hypothesis& hypothesis) const {
    constexpr double kDeviations = 3.0;
    constexpr double kFirstStep = 0.5;  // deviations
    constexpr double kFarthest = 5.0;   // m
    constexpr int kMaxSteps = 60;
    std::size_t reading = 0;
    while (!hypothesis.entries[reading]) ++reading;
    const MarkerObservation observation = observationOf(reading, *hypothesis.entries[reading]);
    const double rise = config_.corner_noise / reprojection_.corner_noise;
    const Eigen::Matrix3d covariance = rise * rise * hypothesis.fit.map_from_base.covariance;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    const Eigen::Vector3d axis = eigen.eigenvectors().col(2);
    const double deviation = std::sqrt(eigen.eigenvalues()(2));

    double reach = kDeviations * deviation;
    for (const double side : {-1.0, 1.0}) {
      Pose2 pose = hypothesis.fit.map_from_base.pose;
      double offset = 0.0;
      for (int step = 0; step < kMaxSteps && offset < kFarthest; ++step) {
        offset += kFirstStep * deviation;
        const Eigen::Vector3d shift = side * offset * axis;
        const Pose2& optimum = hypothesis.fit.map_from_base.pose;
        PoseEstimate pinned;
        pinned.pose = {optimum.x + shift.x(), optimum.y + shift.y(), optimum.yaw + shift.z()};
        constexpr double kFree = 1e4;
        constexpr double kPinned = 1e-10;
        pinned.covariance =
            kFree * Eigen::Matrix3d::Identity() + (kPinned - kFree) * axis * axis.transpose();
        const auto fit =
            refineByReprojection(map_, camera_, {observation}, pose, pinned, reprojection_);
        if (!fit) break;
        pose = fit->map_from_base.pose;
        if (costOf(fit->residuals[0]) - hypothesis.cost > 0.5 * kDeviations * kDeviations) break;
        reach = std::max(reach, offset);
      }
    }
    const double stretched = reach / kDeviations;
    return covariance + (stretched * stretched - deviation * deviation) * axis * axis.transpose();
  }

 private:
  bool hasCandidates() const {
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [](const auto& candidates) { return !candidates.empty(); });
  }

  /// All poses worth comparing, the best first: those that it does not clearly surpass.
  std::vector<Hypothesis> hypotheses() const {
    std::vector<Hypothesis> hypotheses;
    double least = std::numeric_limits<double>::infinity();
    const auto isWorthLooking = [&](std::size_t unexplained) {
      return static_cast<double>(unexplained) * kCostOfUnexplained < least + config_.min_lead;
    };
    const std::vector<std::size_t> sources = readingsToStartFrom();
    for (std::size_t k = 0; k < sources.size(); ++k) {
      // Whatever explains a reading is found from there: what was not found yet leaves all those
      // before unexplained.
      if (!isWorthLooking(readings_.size() - sources.size() + k)) break;
      std::vector<Seed> seeds = seedsFrom(sources[k]);
      std::stable_sort(seeds.begin(), seeds.end(),
                       [](const Seed& a, const Seed& b) { return a.promised > b.promised; });
      for (const Seed& seed : seeds) {
        if (!isWorthLooking(readings_.size() - seed.promised)) break;
        // From afar all pull at once, and one that hangs a little beside its place drags the others
        // along; near the seed those that agree outvote it.
        for (const auto refine : {&refineFromAfar, &refineByReprojection}) {
          std::optional<Hypothesis> hypothesis = grow(seed, refine);
          if (!hypothesis) continue;
          least = std::min(least, hypothesis->saturated_cost);
          addUnlessKnown(std::move(*hypothesis), &hypotheses);
        }
      }
    }
    std::stable_sort(hypotheses.begin(), hypotheses.end(),
                     [](const Hypothesis& a, const Hypothesis& b) {
                       return a.saturated_cost < b.saturated_cost;
                     });
    return hypotheses;
  }

  /// Whether the better of two leaves the other one possible.
  bool isRival(const Hypothesis& best, const Hypothesis& other) const {
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      if (best.entries[i].has_value() != other.entries[i].has_value()) {
        return other.saturated_cost - best.saturated_cost < config_.min_lead;
      }
    }
    return other.cost - best.cost < config_.min_lead;
  }

  MarkerObservation observationOf(std::size_t reading, std::size_t entry) const {
    return {entry, readings_[reading].corners, readings_[reading].center};
  }

  /// Those of which the map has a marker, the least ambiguous and largest first.
  std::vector<std::size_t> readingsToStartFrom() const {
    std::vector<std::size_t> sources;
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      if (!candidates_[i].empty()) sources.push_back(i);
    }
    std::stable_sort(sources.begin(), sources.end(), [this](std::size_t a, std::size_t b) {
      if (candidates_[a].size() != candidates_[b].size()) {
        return candidates_[a].size() < candidates_[b].size();
      }
      return meanEdge(readings_[a].corners) > meanEdge(readings_[b].corners);
    });
    return sources;
  }

  std::vector<Seed> seedsFrom(std::size_t reading) const {
    std::vector<Seed> seeds;
    for (const std::size_t entry : candidates_[reading]) {
      for (const ReprojectionFit& fit : posesFromMarker(
               map_, camera_, observationOf(reading, entry), reprojection_, max_residual_)) {
        Seed seed{fit.map_from_base, Assignment(readings_.size()), 0};
        for (std::size_t j = 0; j < readings_.size(); ++j) {
          seed.entries[j] = j == reading ? entry : nearbyEntry(j, seed.map_from_base);
        }
        seed.promised = countOf(seed.entries);
        seeds.push_back(std::move(seed));
      }
    }
    return seeds;
  }

  /// The candidate that an uncertain pose has nearest to where the reading is, if near enough.
  std::optional<std::size_t> nearbyEntry(std::size_t reading, const PoseEstimate& pose) const {
    constexpr double kDeviations = 4.0;
    std::optional<std::size_t> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t entry : candidates_[reading]) {
      Eigen::Matrix<double, 2, 3> by_pose;
      const auto center = camera_.pixelFromMap(pose.pose, map_.markers[entry].center(), &by_pose);
      if (!center) continue;
      const double variance = (by_pose * pose.covariance * by_pose.transpose()).trace();
      const double reach = max_residual_ + 0.5 * meanEdge(readings_[reading].corners) +
                           kDeviations * std::sqrt(variance);
      const double offset = (*center - readings_[reading].center).norm();
      if (offset <= reach && offset < least) {
        least = offset;
        nearest = entry;
      }
    }
    return nearest;
  }

  /// Refines a seed with all readings that agree, until no more join or leave.
  std::optional<Hypothesis> grow(const Seed& seed, decltype(&refineFromAfar) refine) const {
    constexpr int kRounds = 4;
    Hypothesis hypothesis;
    hypothesis.entries = seed.entries;
    Pose2 pose = seed.map_from_base.pose;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<MarkerObservation> observations;
      for (std::size_t i = 0; i < readings_.size(); ++i) {
        if (hypothesis.entries[i]) observations.push_back(observationOf(i, *hypothesis.entries[i]));
      }
      if (observations.empty()) return std::nullopt;
      auto fit = refine(map_, camera_, observations, pose, std::nullopt, reprojection_);
      if (!fit) return std::nullopt;
      hypothesis.fit = std::move(*fit);
      pose = hypothesis.fit.map_from_base.pose;
      const Assignment before = hypothesis.entries;
      explain(pose, &hypothesis);
      if (hypothesis.entries == before) break;
    }
    if (hypothesis.explained == 0) return std::nullopt;
    if (hypothesis.explained == 1 && !isBelievableAlone(hypothesis)) return std::nullopt;
    return hypothesis;
  }

  void explain(const Pose2& pose, Hypothesis* hypothesis) const {
    hypothesis->entries.assign(readings_.size(), std::nullopt);
    hypothesis->residuals.assign(readings_.size(), std::numeric_limits<double>::quiet_NaN());
    hypothesis->explained = 0;
    hypothesis->cost = 0.0;
    hypothesis->saturated_cost = 0.0;
    std::vector<std::size_t> claimed;
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      double least = max_residual_;
      for (const std::size_t entry : candidates_[i]) {
        // No entry is in two places at once.
        if (std::find(claimed.begin(), claimed.end(), entry) != claimed.end()) continue;
        const double residual =
            reprojectionResiduals(map_, camera_, {observationOf(i, entry)}, pose)[0];
        if (residual > least) continue;
        least = residual;
        hypothesis->entries[i] = entry;
        hypothesis->residuals[i] = residual;
      }
      if (!hypothesis->entries[i]) {
        hypothesis->saturated_cost += kCostOfUnexplained;
        continue;
      }
      claimed.push_back(*hypothesis->entries[i]);
      ++hypothesis->explained;
      hypothesis->cost += costOf(least);
      hypothesis->saturated_cost += saturated(costOf(least));
    }
  }

  /// Of four corners with two coordinates each, of which the residual is the RMS distance.
  double costOf(double residual) const {
    const double ratio = residual / config_.corner_noise;
    return 0.5 * 4.0 * ratio * ratio;
  }

  bool isBelievableAlone(const Hypothesis& hypothesis) const {
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      if (!hypothesis.entries[i]) continue;
      return hypothesis.residuals[i] <= config_.max_residual_of_one &&
             readings_[i].hamming <= config_.max_hamming_of_one;
    }
    return false;
  }

  static void addUnlessKnown(Hypothesis hypothesis, std::vector<Hypothesis>* hypotheses) {
    for (Hypothesis& known : *hypotheses) {
      if (known.entries != hypothesis.entries) continue;
      if (!agree(known.fit.map_from_base, hypothesis.fit.map_from_base)) continue;
      if (hypothesis.cost < known.cost) known = std::move(hypothesis);
      return;
    }
    hypotheses->push_back(std::move(hypothesis));
  }

  const MarkerMap& map_;
  const MountedCamera& camera_;
  const std::vector<MarkerReading>& readings_;
  const ReprojectionConfig& reprojection_;
  double max_residual_;
  const RelocalizationConfig& config_;
  std::vector<std::vector<std::size_t>> candidates_;
};

Relocalization explained(const Hypothesis& hypothesis, const Eigen::Matrix3d& covariance) {
  return {PoseEstimate{hypothesis.fit.map_from_base.pose, covariance}, "", hypothesis.entries,
          hypothesis.residuals};
}

Relocalization unexplained(std::size_t readings, std::string reason) {
  return {std::nullopt, std::move(reason), Assignment(readings),
          std::vector<double>(readings, std::numeric_limits<double>::quiet_NaN())};
}

}  // namespace

RelocalizationConfig readRelocalizationConfig(const YamlReader& reader) {
  reader.allowOnly({"corner_noise", "min_lead", "max_residual_of_one", "max_hamming_of_one",
                    "max_deviation_of_one"});
  RelocalizationConfig config;
  reader.read("corner_noise", &config.corner_noise, kPositive);
  reader.read("min_lead", &config.min_lead, kNonNegative);
  reader.read("max_residual_of_one", &config.max_residual_of_one, kPositive);
  reader.read("max_deviation_of_one", &config.max_deviation_of_one, kPositive);
  reader.read("max_hamming_of_one", &config.max_hamming_of_one, {0, 3});
  return config;
}

Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings,
                          const ReprojectionConfig& reprojection, double max_residual,
                          const RelocalizationConfig& config) {
  const Search search(map, camera, readings, reprojection, max_residual, config);
  std::string reason;
  const std::optional<Hypothesis> best = search.likeliest(&reason);
  if (!best) return unexplained(readings.size(), std::move(reason));
  if (best->explained > 1) return explained(*best, search.covarianceOf(*best));
  const Eigen::Matrix3d spread = search.spread(*best);
  if (spread.topLeftCorner<2, 2>().trace() >
      config.max_deviation_of_one * config.max_deviation_of_one) {
    return unexplained(readings.size(), "the only marker that was read leaves the pose uncertain");
  }
  return explained(*best, spread);
}

Relocalization relocalizeRoughly(const MarkerMap& map, const MountedCamera& camera,
                                 const std::vector<MarkerReading>& readings,
                                 const ReprojectionConfig& reprojection, double max_residual,
                                 const RelocalizationConfig& config) {
  const Search search(map, camera, readings, reprojection, max_residual, config);
  std::string reason;
  const std::optional<Hypothesis> best = search.likeliest(&reason);
  if (!best) return unexplained(readings.size(), std::move(reason));
  return explained(*best, search.covarianceOf(*best));
}

}  // namespace omnitag
