#include "marker/tag_detector.h"

#include <apriltag/apriltag.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/yaml_reader.h"
#include "marker/aprilgrid_family.h"
#include "marker/apriltag_family.h"
#include "marker/corner_refinement.h"
#include "marker/library_detector.h"
#include "marker/picture_matcher.h"
#include "marker/square_finder.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

struct DestroyDetections {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

/// The library keeps every code with every combination of up to `hamming` wrong bits in a hash
/// table. It reserves three entries of 16 bytes for each, and counts combinations as if the order
/// of the bits mattered.
double decodingTableBytes(const apriltag_family_t& family, int hamming) {
  double combinations = 1.0;
  double entries = 1.0;
  for (int wrong_bits = 1; wrong_bits <= hamming; ++wrong_bits) {
    combinations *= static_cast<double>(family.nbits) - wrong_bits + 1.0;
    entries += combinations;
  }
  return 3.0 * 16.0 * entries * static_cast<double>(family.ncodes);
}

int affordableHamming(const apriltag_family_t& family, int wanted) {
  constexpr double kLargestTable = 64e6;
  // With more wrong bits, the code could be that of another id.
  int hamming = std::min(wanted, (static_cast<int>(family.h) - 1) / 2);
  while (hamming > 0 && decodingTableBytes(family, hamming) > kLargestTable) --hamming;
  return hamming;
}

/// The library counts the centre of the top-left pixel as (0.5, 0.5).
Eigen::Vector2d toPixel(double x, double y) { return {x - 0.5, y - 0.5}; }

/// `scale`: pixels of the image per pixel of what the library has seen.
TagDetection toTagDetection(const apriltag_detection_t& detection, double scale) {
  TagDetection result;
  result.family = detection.family->name;
  result.id = detection.id;
  result.hamming = detection.hamming;
  result.decision_margin = detection.decision_margin;
  result.modules_per_edge = detection.family->width_at_border;
  for (std::size_t i = 0; i < result.corners.size(); ++i) {
    result.corners[i] = toPixel(scale * detection.p[i][0], scale * detection.p[i][1]);
  }
  return result;
}

}  // namespace

Eigen::Vector2d centerOf(const Corners<Eigen::Vector2d>& corners) {
  using Line = Eigen::Hyperplane<double, 2>;
  return Line::Through(corners[0], corners[2]).intersection(Line::Through(corners[1], corners[3]));
}

TagDetectorConfig readTagDetectorConfig(const YamlReader& reader) {
  reader.allowOnly({"quad_decimate", "quad_sigma", "refine_edges", "decode_sharpening",
                    "min_cluster_pixels", "max_nmaxima", "critical_angle", "max_line_fit_mse",
                    "min_white_black_diff", "deglitch", "max_hamming", "min_decision_margin"});
  TagDetectorConfig config;
  reader.read("quad_decimate", &config.quad_decimate);
  const bool integral = config.quad_decimate == std::floor(config.quad_decimate);
  if ((!integral && config.quad_decimate != 1.5) || config.quad_decimate < 1.0 ||
      config.quad_decimate > 8.0) {
    reader.refuse("quad_decimate", "1, 1.5 or an integer from 2 to 8");
  }
  reader.read("quad_sigma", &config.quad_sigma, {-3.0, 3.0});
  reader.read("refine_edges", &config.refine_edges);
  reader.read("decode_sharpening", &config.decode_sharpening, {0.0, 10.0});
  reader.read("min_cluster_pixels", &config.min_cluster_pixels, kNonNegative);
  reader.read("max_nmaxima", &config.max_nmaxima, {4.0, 40.0});
  reader.read("critical_angle", &config.critical_angle, {0.0, radians(45.0)});
  reader.read("max_line_fit_mse", &config.max_line_fit_mse, kPositive);
  reader.read("min_white_black_diff", &config.min_white_black_diff, {0.0, 255.0});
  reader.read("deglitch", &config.deglitch);
  reader.read("max_hamming", &config.max_hamming, {0.0, 3.0});
  reader.read("min_decision_margin", &config.min_decision_margin, {0.0, 255.0});
  return config;
}

struct TagDetector::Library {
  struct Families {
    std::vector<AprilTagFamily> codes;
    /// AprilGrid's, whose tags touch black squares at their corners.
    std::vector<AprilTagFamily> touching;
    std::optional<PictureMatcher> matcher;
  };

  Library(const TagDetectorConfig& config, std::shared_ptr<const Families> shared_families)
      : min_white_black_diff(config.min_white_black_diff),
        min_decision_margin(config.min_decision_margin),
        blurs(config.quad_sigma != 0.0 && config.quad_decimate <= 1.0),
        deglitches(config.deglitch && config.quad_decimate <= 1.0),
        smallest_side(8.0 * std::max(1.0, config.quad_decimate)),
        families(std::move(shared_families)),
        detector(createLibraryDetector(config)),
        touching_detector(createLibraryDetector(config)) {
    if (families->matcher) squares.emplace(config);
    // The library makes a family's decoding table unless it has one.
    const auto add = [&config](const std::vector<AprilTagFamily>& codes,
                               const LibraryDetector& reads) {
      for (const AprilTagFamily& family : codes) {
        apriltag_detector_add_family_bits(reads.get(), family.get(),
                                          affordableHamming(*family, config.max_hamming));
      }
    };
    add(families->codes, detector);
    add(families->touching, touching_detector);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    // The library would free the tables of a detector's families along with it.
    if (families.use_count() == 1) return;
    zarray_clear(detector->tag_families);
    zarray_clear(touching_detector->tag_families);
  }

  static std::shared_ptr<const Families> create(const MarkerFamilies& wanted) {
    auto families = std::make_shared<Families>();
    for (const std::string& name : wanted.codes) {
      auto& codes = name == kAprilGridFamily ? families->touching : families->codes;
      codes.push_back(createAprilTagFamily(name));
    }
    if (!wanted.pictures.empty()) families->matcher.emplace(wanted.pictures);
    return families;
  }

  void decode(const cv::Mat& image, int min_contrast, std::vector<TagDetection>* found) const;
  void decodeTouching(const cv::Mat& image, int min_contrast,
                      std::vector<TagDetection>* found) const;
  /// `seen`: the image as the library sees it, larger by the factor `enlargement`.
  void decode(const LibraryDetector& reads, const cv::Mat& seen, double enlargement,
              const cv::Mat& image, int min_contrast, std::vector<TagDetection>* found) const;
  void matchPictures(const cv::Mat& image, int min_contrast,
                     std::vector<TagDetection>* found) const;

  int min_white_black_diff;
  double min_decision_margin;
  bool blurs;
  bool deglitches;
  double smallest_side;
  // The detector releases its families when it is destroyed: they must outlive it.
  std::shared_ptr<const Families> families;
  LibraryDetector detector;
  LibraryDetector touching_detector;
  std::optional<SquareFinder> squares;
};

TagDetector::TagDetector(const TagDetectorConfig& config, const MarkerFamilies& families)
    : library_(std::make_unique<Library>(config, Library::create(families))) {}

TagDetector::TagDetector(const TagDetectorConfig& config, const TagDetector& other)
    : library_(std::make_unique<Library>(config, other.library_->families)) {}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

void TagDetector::Library::decode(const cv::Mat& image, int min_contrast,
                                  std::vector<TagDetection>* found) const {
  // The library blurs in place, and deglitches as if rows had hardly any padding.
  const bool needs_copy = blurs || (deglitches && !image.isContinuous());
  const cv::Mat input = needs_copy ? image.clone() : image;
  decode(detector, input, 1.0, image, min_contrast, found);
}

void TagDetector::Library::decodeTouching(const cv::Mat& image, int min_contrast,
                                          std::vector<TagDetection>* found) const {
  // To the library, black squares that touch are one shape. Widening the white by half a pixel
  // separates them.
  constexpr double kEnlargement = 2.0;
  cv::Mat enlarged;
  cv::resize(image, enlarged, {}, kEnlargement, kEnlargement, cv::INTER_CUBIC);
  cv::dilate(enlarged, enlarged, cv::Mat());
  decode(touching_detector, enlarged, kEnlargement, image, min_contrast, found);
}

void TagDetector::Library::decode(const LibraryDetector& reads, const cv::Mat& seen,
                                  double enlargement, const cv::Mat& image, int min_contrast,
                                  std::vector<TagDetection>* found) const {
  image_u8_t library_image{seen.cols, seen.rows, static_cast<int>(seen.step), seen.data};
  reads->qtp.min_white_black_diff = std::max(min_white_black_diff, min_contrast);
  const std::unique_ptr<zarray_t, DestroyDetections> detections(
      apriltag_detector_detect(reads.get(), &library_image));
  for (int i = 0; i < zarray_size(detections.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections.get(), i, &detection);
    if (detection->decision_margin < min_decision_margin) continue;
    TagDetection tag = toTagDetection(*detection, 1.0 / enlargement);
    // The library's own refinement is off by up to 0.3 pixels in releases before 3.4.3.
    if (reads->refine_edges) tag.corners = refineCorners(image, tag.corners, tag.modules_per_edge);
    tag.center = centerOf(tag.corners);
    found->push_back(std::move(tag));
  }
}

void TagDetector::Library::matchPictures(const cv::Mat& image, int min_contrast,
                                         std::vector<TagDetection>* found) const {
  for (const Corners<Eigen::Vector2d>& square : squares->find(image, min_contrast)) {
    const Corners<Eigen::Vector2d> refined =
        refineCorners(image, square, families->matcher->modulesPerEdge());
    const std::optional<PictureMatch> match = families->matcher->match(image, refined);
    if (!match) continue;
    TagDetection tag;
    tag.family = kPictureFamily;
    tag.id = match->id;
    tag.decision_margin = match->contrast;
    tag.modules_per_edge = match->modules_per_edge;
    tag.corners = match->corners;
    tag.center = centerOf(tag.corners);
    found->push_back(std::move(tag));
  }
}

std::vector<TagDetection> TagDetector::detect(const cv::Mat& image, int min_contrast) const {
  constexpr int kLargestSide = std::numeric_limits<std::int16_t>::max();
  if (image.type() != CV_8UC1 || std::max(image.cols, image.rows) > kLargestSide) {
    throw std::invalid_argument("tag detection needs a CV_8UC1 image, at most 32767 pixels a side");
  }
  // The library reads beyond the bounds of images smaller than its 4 x 4 pixel tiles.
  if (std::min(image.cols, image.rows) < library_->smallest_side) return {};
  std::vector<TagDetection> found;
  if (!library_->families->codes.empty()) library_->decode(image, min_contrast, &found);
  if (!library_->families->touching.empty() &&
      2 * std::max(image.cols, image.rows) <= kLargestSide) {
    library_->decodeTouching(image, min_contrast, &found);
  }
  if (library_->squares) library_->matchPictures(image, min_contrast, &found);
  return found;
}

}  // namespace omnitag
