#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/marker_families.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

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

/// A marker read in a view. Positions are pixels of that view, the centre of its top-left pixel at
/// (0, 0).
struct TagDetection {
  std::string family;
  int id = 0;
  int hamming = 0;
  /// Grey levels; of a picture, the standard deviation within its border.
  double decision_margin = 0.0;
  /// Between two corners; of a picture, as if its border were one module wide.
  int modules_per_edge = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
};

/// Where the diagonals of a quadrilateral meet.
Eigen::Vector2d centerOf(const Corners<Eigen::Vector2d>& corners);

/// Finds AprilTags, ArUco markers and pictures in grey images. Not safe to use from two threads at
/// once: give each thread its own.
class TagDetector {
 public:
  /// Throws InputError for an unknown family.
  TagDetector(const TagDetectorConfig& config, const MarkerFamilies& families);
  /// With the families of another detector, whose decoding tables (many megabytes) the two share.
  /// `max_hamming` remains the other detector's.
  TagDetector(const TagDetectorConfig& config, const TagDetector& other);
  ~TagDetector();
  TagDetector(TagDetector&& other) noexcept;
  TagDetector& operator=(TagDetector&& other) noexcept;

  /// The tags in an image (CV_8UC1, at most 32767 pixels a side), ordered by id, and then the
  /// pictures. None in an image of less than 8 pixels a side, times `quad_decimate`. Rows may be
  /// padded. `min_contrast`: grey levels between white and black, if more than the settings
  /// require. Throws std::invalid_argument for other images.
  std::vector<TagDetection> detect(const cv::Mat& image, int min_contrast = 0) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace omnitag
