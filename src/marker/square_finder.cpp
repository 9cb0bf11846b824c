#include "marker/square_finder.h"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "marker/apriltag_family.h"
#include "marker/library_detector.h"

// The library's own sources declare it where they use it; its header does not.
extern "C" zarray_t* apriltag_quad_thresh(apriltag_detector_t* detector, image_u8_t* image);

namespace omnitag {
namespace {

struct DestroyQuads {
  void operator()(zarray_t* quads) const { zarray_destroy(quads); }
};

/// Counter-clockwise for a person who looks at it, where y points down.
Corners<Eigen::Vector2d> counterClockwise(Corners<Eigen::Vector2d> corners) {
  const Eigen::Vector2d along = corners[1] - corners[0];
  const Eigen::Vector2d beyond = corners[2] - corners[1];
  const bool is_clockwise = along.x() * beyond.y() - along.y() * beyond.x() > 0.0;
  if (is_clockwise) std::reverse(corners.begin(), corners.end());
  return corners;
}

}  // namespace

struct SquareFinder::Library {
  explicit Library(const TagDetectorConfig& config)
      : min_white_black_diff(config.min_white_black_diff),
        reduction(config.quad_decimate),
        blur(config.quad_sigma),
        detector(createLibraryDetector(config)) {
    detector->quad_decimate = 1.0F;
    detector->quad_sigma = 0.0F;
    // The library finds squares for the families that it knows, and prepares its threads only when
    // it detects their tags.
    apriltag_detector_add_family_bits(detector.get(), family.get(), 0);
    constexpr int kSide = 16;
    cv::Mat blank(kSide, kSide, CV_8UC1, cv::Scalar(0));
    image_u8_t image{blank.cols, blank.rows, static_cast<int>(blank.step), blank.data};
    apriltag_detections_destroy(apriltag_detector_detect(detector.get(), &image));
  }

  int min_white_black_diff;
  double reduction;
  double blur;
  // Any family with a black border; it must outlive the detector.
  AprilTagFamily family = createAprilTagFamily("tag16h5");
  LibraryDetector detector;
};

SquareFinder::SquareFinder(const TagDetectorConfig& config)
    : library_(std::make_unique<Library>(config)) {}

SquareFinder::~SquareFinder() = default;
SquareFinder::SquareFinder(SquareFinder&&) noexcept = default;
SquareFinder& SquareFinder::operator=(SquareFinder&&) noexcept = default;

std::vector<Corners<Eigen::Vector2d>> SquareFinder::find(const cv::Mat& image,
                                                         int min_contrast) const {
  const double reduction = library_->reduction;
  cv::Mat reduced = image;
  if (reduction > 1.0) {
    cv::resize(image, reduced, {}, 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
  }
  if (library_->blur > 0.0) {
    // Not in place: the caller's pixels may be the same.
    cv::Mat blurred;
    cv::GaussianBlur(reduced, blurred, {}, library_->blur);
    reduced = blurred;
  }
  // The library deglitches as if rows had hardly any padding.
  if (library_->detector->qtp.deglitch != 0 && !reduced.isContinuous()) reduced = reduced.clone();
  image_u8_t library_image{reduced.cols, reduced.rows, static_cast<int>(reduced.step),
                           reduced.data};
  library_->detector->qtp.min_white_black_diff =
      std::max(library_->min_white_black_diff, min_contrast);
  const std::unique_ptr<zarray_t, DestroyQuads> quads(
      apriltag_quad_thresh(library_->detector.get(), &library_image));
  std::vector<Corners<Eigen::Vector2d>> squares;
  for (int i = 0; i < zarray_size(quads.get()); ++i) {
    quad* found = nullptr;
    zarray_get_volatile(quads.get(), i, &found);
    if (found->reversed_border) continue;
    Corners<Eigen::Vector2d> corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      // The library counts the centre of the top-left pixel as (0.5, 0.5).
      const Eigen::Vector2d position(found->p[k][0], found->p[k][1]);
      corners[k] = reduction * position - Eigen::Vector2d::Constant(0.5);
    }
    squares.push_back(counterClockwise(corners));
  }
  return squares;
}

}  // namespace omnitag
