#pragma once

namespace omnitag {

class YamlReader;

/// How likely it is that the world is not as expected: all probabilities that weigh contradictory
/// poses against each other. They were chosen in the study of moved groups (group_study).
struct EvidenceConfig {
  /// That something moves the robot between two images without its odometry noticing; and the same
  /// without odometry, when the robot may also have moved differently by itself.
  double carried = 1e-6;
  double carried_without_odometry = 1e-2;
  /// That a marker is measured beside its place, for example because something covers part of it.
  double misread = 0.05;
  /// That markers hang elsewhere than the map says, by more than their deviation.
  double moved = 1e-2;
  /// 1/s: that a marker that was seen in its place is moved.
  double moved_per_second = 1e-8;
  /// m, over which the probability that neighbours are moved together falls by a factor of e.
  double together = 2.5;
  /// That a pose from outside is off by any amount beyond its deviations; and that markers are seen
  /// by chance where it puts them.
  double mistaken_start = 0.01;
  double mistaken = 1e-2;
  /// That a marker is not found though it was found when last looked for, and is in view of a pose.
  /// For other markers, the share of the map's markers that were found at first sight counts.
  double missed = 0.03;
  /// Standard deviations (Misfit) by which a marker in its place is off at most, if the pose
  /// is known.
  double in_place = 2.5;
  /// How many times likelier than another a hypothesis must be for the other to be given up.
  double odds = 100.0;
  /// The same between two that a pose from outside leaves open: which of two groups was moved then
  /// rests on their sizes alone. With 100, one marker in its place against five that were moved as
  /// one is given up, and the pose is as wrong as they are far (group_study).
  double odds_at_start = 1e4;
  /// m: while two hypotheses are possible, the likelier one is published with a covariance that
  /// covers the other, unless its deviation is then larger than this.
  double open_deviation = 0.25;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

}  // namespace omnitag
