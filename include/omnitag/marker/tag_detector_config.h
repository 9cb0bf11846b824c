#pragma once

namespace omnitag {

class YamlReader;

/// Settings of the AprilTag library's detector. The names are the library's own.
struct TagDetectorConfig {
  /// Reduces the view before quads are searched: 1 (keeps its resolution), 1.5 or an integer. With
  /// other factors the library misplaces what it finds.
  double quad_decimate = 1.0;
  /// Gaussian blur of the reduced view, standard deviation in its pixels; negative sharpens, which
  /// does not apply to pictures.
  double quad_sigma = 0.0;
  /// Moves the edges of a quad to the strongest gradient, and the corners of a decoded tag to where
  /// its edges really meet (see refineCorners()).
  bool refine_edges = true;
  double decode_sharpening = 0.25;
  int min_cluster_pixels = 5;
  int max_nmaxima = 10;
  /// rad, quads with a corner sharper than this are ignored.
  double critical_angle = 0.1745;
  double max_line_fit_mse = 10.0;
  /// Grey levels between the white and the black of a marker. The library's own default, 5, finds
  /// quads in the noise and takes three to ten times longer.
  int min_white_black_diff = 25;
  bool deglitch = false;
  /// Wrong bits that are corrected, 3 at most. Families with very many ids get fewer, so that the
  /// library's decoding table stays under 64 MB.
  int max_hamming = 2;
  /// Grey levels; detections whose bits differ less from their threshold are not reported. Pictures
  /// have no such bits.
  double min_decision_margin = 10.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
TagDetectorConfig readTagDetectorConfig(const YamlReader& reader);

}  // namespace omnitag
