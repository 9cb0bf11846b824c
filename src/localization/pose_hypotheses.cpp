#include "localization/pose_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "localization/marker_pose.h"
#include "measurement/marker_misplacement.h"

namespace omnitag {
namespace {

using Assignment = std::vector<std::optional<std::size_t>>;

/// The cost of a reading that a hypothesis does not explain.
constexpr double kCostOfUnexplained = 20.0;

/// Whether it costs more to explain a reading than to leave it unexplained.
bool isPoor(const Misfit& misfit) { return costOf(misfit) > kCostOfUnexplained; }

double saturated(double cost) { return cost * kCostOfUnexplained / (cost + kCostOfUnexplained); }

/// A reading and an entry that it may be.
struct Match {
  std::size_t reading;
  std::size_t entry;
};

/// An entry that a reading may be, and how many readings may belong to a pose based on it.
struct Candidate {
  std::size_t entry;
  std::size_t company;
};

/// A start for a hypothesis: the pose from one marker's corners, and how many readings may agree.
struct Seed {
  PoseEstimate map_from_base;
  Assignment entries;
  std::size_t promised = 0;
};

std::size_t countOf(const Assignment& entries) {
  return static_cast<std::size_t>(
      std::count_if(entries.begin(), entries.end(), [](const auto& entry) { return !!entry; }));
}

/// m per metre of its edge: the farthest that a marker can be. Seen from its front, its diagonals
/// look no smaller than in the reading.
double farthestPerSize(const MarkerReading& reading, const MountedCamera& camera) {
  // The corners of a small marker may be off by a fifth of its edge.
  constexpr double kMargin = 1.5;
  double widest = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto from = camera.rayInBase(reading.corners[k]);
    const auto to = camera.rayInBase(reading.corners[k + 2]);
    if (!from || !to) return std::numeric_limits<double>::infinity();
    widest = std::max(widest, std::acos(std::clamp(from->direction.dot(to->direction), -1.0, 1.0)));
  }
  return kMargin * std::sqrt(0.5) / std::tan(0.5 * widest);
}

class Search {
 public:
  explicit Search(const RelocalizationProblem& problem) : problem_(problem) {
    for (const MarkerReading& reading : problem.readings) {
      farthest_.push_back(farthestPerSize(reading, problem.camera));
    }
  }

  std::vector<PoseHypothesis> hypotheses() {
    const std::vector<std::size_t> sources = readingsToStartFrom();
    for (std::size_t k = 0; k < sources.size(); ++k) {
      // Starting from a reading finds all poses that explain it: poses not found yet leave all
      // earlier readings unexplained.
      if (!isWorthLooking(problem_.readings.size() - sources.size() + k)) break;
      growFrom(sources[k]);
    }
    std::stable_sort(hypotheses_.begin(), hypotheses_.end(),
                     [](const PoseHypothesis& a, const PoseHypothesis& b) {
                       return a.saturated_cost < b.saturated_cost;
                     });
    return std::move(hypotheses_);
  }

 private:
  /// Whether a pose that leaves this many readings unexplained could rival the best one.
  bool isWorthLooking(std::size_t unexplained) const {
    return static_cast<double>(unexplained) * kCostOfUnexplained <
           least_cost_ + problem_.config.min_lead;
  }

  /// The readings with a marker in the map, the least ambiguous and largest first.
  std::vector<std::size_t> readingsToStartFrom() const {
    std::vector<std::size_t> sources;
    for (std::size_t i = 0; i < problem_.readings.size(); ++i) {
      if (!problem_.candidates[i].empty()) sources.push_back(i);
    }
    std::stable_sort(sources.begin(), sources.end(), [this](std::size_t a, std::size_t b) {
      if (problem_.candidates[a].size() != problem_.candidates[b].size()) {
        return problem_.candidates[a].size() < problem_.candidates[b].size();
      }
      return meanEdge(problem_.readings[a].corners) > meanEdge(problem_.readings[b].corners);
    });
    return sources;
  }

  /// Adds the hypotheses that a reading leads to, the most promising first.
  void growFrom(std::size_t reading) {
    const std::vector<Candidate> candidates = inCompany(reading);
    for (auto first = candidates.begin(); first != candidates.end();) {
      if (!isWorthLooking(problem_.readings.size() - first->company)) break;
      const auto last = std::find_if(first, candidates.end(), [first](const Candidate& other) {
        return other.company != first->company;
      });
      std::vector<Seed> seeds;
      for (; first != last; ++first) addSeeds(reading, first->entry, &seeds);
      std::stable_sort(seeds.begin(), seeds.end(),
                       [](const Seed& a, const Seed& b) { return a.promised > b.promised; });
      for (const Seed& seed : seeds) {
        if (!isWorthLooking(problem_.readings.size() - seed.promised)) break;
        // From afar, all pull at once, and a marker a little beside its place drags the others
        // along; near the seed, those that agree outvote it.
        for (const auto refine : {&refineFromAfar, &refineByReprojection}) {
          auto hypothesis = grow(seed, refine, problem_.estimation.max_misfit);
          // If some pull the pose off the others, compare the pose of all with that of the others
          // alone.
          if (hypothesis && isWithPoorOnes(*hypothesis)) add(growWithoutPoorOnes(*hypothesis));
          add(std::move(hypothesis));
        }
      }
    }
  }

  /// The entries that a reading may be, those that the most readings support first.
  std::vector<Candidate> inCompany(std::size_t reading) const {
    std::vector<Candidate> candidates;
    for (const std::size_t entry : problem_.candidates[reading]) {
      Candidate candidate{entry, 1};
      for (std::size_t j = 0; j < problem_.candidates.size(); ++j) {
        const auto isInSight = [&](std::size_t other) {
          return areSeenTogether({reading, entry}, {j, other});
        };
        if (j != reading &&
            std::any_of(problem_.candidates[j].begin(), problem_.candidates[j].end(), isInSight)) {
          ++candidate.company;
        }
      }
      candidates.push_back(candidate);
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.company > b.company; });
    return candidates;
  }

  /// Whether both matches can be right, given how far apart their markers are.
  bool areSeenTogether(const Match& a, const Match& b) const {
    const Marker& marker_a = problem_.map.markers[a.entry];
    const Marker& marker_b = problem_.map.markers[b.entry];
    const double farthest =
        farthest_[a.reading] * marker_a.size + farthest_[b.reading] * marker_b.size;
    return (marker_a.center() - marker_b.center()).squaredNorm() < farthest * farthest;
  }

  void addSeeds(std::size_t reading, std::size_t entry, std::vector<Seed>* seeds) const {
    for (const ReprojectionFit& fit :
         posesFromMarker(problem_.map, problem_.camera, problem_.observation(reading, entry),
                         problem_.standing, problem_.estimation)) {
      Seed seed{fit.map_from_base, Assignment(problem_.readings.size()), 0};
      for (std::size_t j = 0; j < problem_.readings.size(); ++j) {
        seed.entries[j] =
            j == reading ? entry : nearbyEntry(j, {reading, entry}, seed.map_from_base);
      }
      seed.promised = countOf(seed.entries);
      seeds->push_back(std::move(seed));
    }
  }

  /// The candidate that an uncertain pose, based on a match, puts nearest to the reading, if it is
  /// near enough.
  std::optional<std::size_t> nearbyEntry(std::size_t reading, const Match& seed,
                                         const PoseEstimate& pose) const {
    constexpr double kDeviations = 4.0;
    std::optional<std::size_t> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t entry : problem_.candidates[reading]) {
      if (!areSeenTogether(seed, {reading, entry})) continue;
      FrameJacobian by_frame;
      const Marker& marker = problem_.map.markers[entry];
      const auto center = problem_.camera.pixelFromMap(pose.pose, marker.center(), &by_frame);
      if (!center) continue;
      const auto by_pose = by_frame.leftCols<6>();
      const PoseMatrix covariance =
          pose.covariance + seenFrom(pose.pose, marker, {marker.deviation, 0.0});
      const double variance = (by_pose * covariance * by_pose.transpose()).trace() +
                              by_frame.rightCols<kImagingUnknowns>().squaredNorm();
      const double reach =
          0.5 * meanEdge(problem_.readings[reading].corners) + kDeviations * std::sqrt(variance);
      const double offset = (*center - problem_.readings[reading].center).norm();
      if (offset <= reach && offset < least) {
        least = offset;
        nearest = entry;
      }
    }
    return nearest;
  }

  static bool isWithPoorOnes(const PoseHypothesis& hypothesis) {
    return std::any_of(hypothesis.misfits.begin(), hypothesis.misfits.end(), isPoor);
  }

  /// Nothing if fewer than two are left: a single one agrees with anything.
  std::optional<PoseHypothesis> growWithoutPoorOnes(const PoseHypothesis& hypothesis) const {
    Seed seed{hypothesis.fit.map_from_base, hypothesis.entries, 0};
    for (std::size_t i = 0; i < seed.entries.size(); ++i) {
      if (isPoor(hypothesis.misfits[i])) seed.entries[i].reset();
    }
    constexpr std::size_t kFewest = 2;
    if (countOf(seed.entries) < kFewest) return std::nullopt;
    const double most = std::sqrt(kCostOfUnexplained / costOf({0.0, 1.0}));
    auto grown = grow(seed, &refineByReprojection, most);
    if (grown && grown->explained < kFewest) return std::nullopt;
    return grown;
  }

  /// Refines a seed with all readings that agree within this many deviations, until no more join
  /// or leave.
  std::optional<PoseHypothesis> grow(const Seed& seed, decltype(&refineFromAfar) refine,
                                     double max_misfit) const {
    constexpr int kRounds = 4;
    PoseHypothesis hypothesis;
    hypothesis.entries = seed.entries;
    Pose pose = seed.map_from_base.pose;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<MarkerObservation> observations;
      for (std::size_t i = 0; i < problem_.readings.size(); ++i) {
        if (!hypothesis.entries[i]) continue;
        observations.push_back(problem_.observation(i, *hypothesis.entries[i]));
      }
      if (observations.empty()) return std::nullopt;
      auto fit = refine(problem_.map, problem_.camera, observations, pose, problem_.standing,
                        problem_.estimation.reprojection);
      if (!fit) return std::nullopt;
      hypothesis.fit = std::move(*fit);
      pose = hypothesis.fit.map_from_base.pose;
      const Assignment before = hypothesis.entries;
      explain(max_misfit, &hypothesis);
      if (hypothesis.entries == before) break;
    }
    if (hypothesis.explained == 0) return std::nullopt;
    if (hypothesis.explained == 1 && !isBelievableAlone(hypothesis)) return std::nullopt;
    return hypothesis;
  }

  void explain(double max_misfit, PoseHypothesis* hypothesis) const {
    const Pose& pose = hypothesis->fit.map_from_base.pose;
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    hypothesis->entries.assign(problem_.readings.size(), std::nullopt);
    hypothesis->misfits.assign(problem_.readings.size(), {kNaN, kNaN});
    hypothesis->explained = 0;
    hypothesis->cost = 0.0;
    hypothesis->saturated_cost = 0.0;
    const Eigen::Vector3d viewpoint = problem_.camera.mapFromCamera(pose).translation();
    std::vector<std::size_t> claimed;
    for (std::size_t i = 0; i < problem_.readings.size(); ++i) {
      Misfit least{kNaN, max_misfit};
      for (const std::size_t entry : problem_.candidates[i]) {
        const Marker& marker = problem_.map.markers[entry];
        if ((marker.center() - viewpoint).norm() > farthest_[i] * marker.size) continue;
        // No entry is in two places at once.
        if (std::find(claimed.begin(), claimed.end(), entry) != claimed.end()) continue;
        const Misfit misfit =
            misfitsAt(problem_.map, problem_.camera, {problem_.observation(i, entry)}, pose,
                      hypothesis->fit.imaging_error, problem_.estimation.reprojection)
                .front();
        if (misfit.deviations > least.deviations) continue;
        least = misfit;
        hypothesis->entries[i] = entry;
        hypothesis->misfits[i] = misfit;
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

  bool isBelievableAlone(const PoseHypothesis& hypothesis) const {
    for (std::size_t i = 0; i < problem_.readings.size(); ++i) {
      if (!hypothesis.entries[i]) continue;
      return hypothesis.misfits[i].deviations <= problem_.config.max_misfit_of_one &&
             problem_.readings[i].hamming <= problem_.config.max_hamming_of_one;
    }
    return false;
  }

  void add(std::optional<PoseHypothesis> hypothesis) {
    if (!hypothesis) return;
    least_cost_ = std::min(least_cost_, hypothesis->saturated_cost);
    for (PoseHypothesis& known : hypotheses_) {
      if (known.entries != hypothesis->entries) continue;
      if (!agree(known.fit.map_from_base, hypothesis->fit.map_from_base)) continue;
      if (hypothesis->cost < known.cost) known = std::move(*hypothesis);
      return;
    }
    hypotheses_.push_back(std::move(*hypothesis));
  }

  const RelocalizationProblem& problem_;
  /// For each reading, farthestPerSize().
  std::vector<double> farthest_;
  std::vector<PoseHypothesis> hypotheses_;
  double least_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

MarkerObservation RelocalizationProblem::observation(std::size_t reading, std::size_t entry) const {
  return {entry, readings[reading].corners, readings[reading].center};
}

std::vector<std::vector<std::size_t>> candidatesOf(const std::vector<MarkerReading>& readings,
                                                   const MarkerMap& map) {
  std::vector<std::vector<std::size_t>> candidates;
  candidates.reserve(readings.size());
  for (const MarkerReading& reading : readings) {
    candidates.push_back(entriesOf(map, reading.family, reading.id));
  }
  return candidates;
}

double costOf(const Misfit& misfit) {
  constexpr double kCoordinates = 8.0;  // of four corners
  return 0.5 * kCoordinates * misfit.deviations * misfit.deviations;
}

std::vector<PoseHypothesis> poseHypotheses(const RelocalizationProblem& problem) {
  return Search(problem).hypotheses();
}

}  // namespace omnitag
