#pragma once

namespace omnitag {

class YamlReader;

/// How likely it is that the world is not as expected: the probabilities that weigh contradictory
/// poses against each other. They were chosen in the study of moved groups (group_study).
struct EvidenceConfig {
  /// That something moves the robot between two images without its odometry noticing; and the same
  /// without odometry, when the robot itself may have moved unexpectedly.
  double carried = 1e-6;
  double carried_without_odometry = 1e-2;
  /// That a marker is measured beside its place, for example because something covers part of it.
  double misread = 0.05;
  /// That markers hang elsewhere than the map says, by more than their deviation.
  double moved = 1e-2;
  /// 1/s: that a marker that was seen in its place is moved.
  double moved_per_second = 1e-8;
  /// m: the distance over which the probability that neighbours are moved together falls by a
  /// factor of e.
  double together = 2.5;
  /// That a pose from outside is off by more than its deviations, however much; and that markers
  /// then appear by chance where it puts them.
  double mistaken_start = 0.01;
  double mistaken = 1e-2;
  /// That a marker in view of a pose is not found, though it was when last looked for. For other
  /// markers, the share of the map's markers that were found at the first attempt is used.
  double missed = 0.03;
  /// Standard deviations (Misfit): the most that a marker in its place is off, if the pose is
  /// known.
  double in_place = 2.5;
  /// A hypothesis is dropped when another is this many times likelier.
  double odds = 100.0;
  /// The same between two that a pose from outside leaves open: only the sizes of two groups then
  /// tell which of them was moved. At 100, one marker in its place loses against five that were
  /// moved as one, and the pose is wrong by as much as they were moved (group_study).
  double odds_at_start = 1e4;
  /// m: while two hypotheses are possible, the likelier one is published with a covariance that
  /// covers the other, unless its deviation is then larger than this.
  double open_deviation = 0.25;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

}  // namespace omnitag
