#include "clutter.h"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "marker/marker_prediction.h"
#include "marker/tag_family.h"
#include "marker/tag_pattern.h"
#include "masking.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr std::array<const char*, Clutter::kKinds> kNames = {
    "noise",       "lines",         "shapes", "checkerboards", "text",
    "random tags", "unmapped tags", "room",   "mixture"};

cv::Mat modulesOf(const std::string& family, int id) {
  const TagPattern pattern(family, id);
  cv::Mat modules(pattern.width(), pattern.width(), CV_8UC1);
  for (int row = 0; row < modules.rows; ++row) {
    for (int column = 0; column < modules.cols; ++column) {
      modules.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(255.0 * pattern.whiteAt(column, row));
    }
  }
  return modules;
}

/// A frame with every marker painted over that faces the camera, however small or slanting.
cv::Mat roomWithoutMarkers(const RecordedSequence& sequence, std::size_t index) {
  const Frame& frame = sequence.frames[index];
  VisibilityConfig everything;
  everything.max_range = 1e3;
  everything.max_incidence = radians(89.9);
  everything.min_edge_pixels = 0.1;
  FrameResult seen;
  seen.predicted = predictMarkers(sequence.map, {sequence.camera, frame.base_from_camera},
                                  {sequence.truth[index]}, everything);
  return withOnly({}, seen, frame.image);
}

/// One of the image, or one a little outside.
cv::Point anyPoint(cv::RNG* random, const cv::Mat& image) {
  constexpr int kOutside = 20;
  return {random->uniform(-kOutside, image.cols + kOutside),
          random->uniform(-kOutside, image.rows + kOutside)};
}

/// A quadrilateral where the mirror shows the world about upright, of any turn and a little skewed.
std::array<cv::Point2f, 4> quadOnMirror(cv::RNG* random, const cv::Mat& image, double min_side,
                                        double max_side) {
  const double half_image = 0.5 * std::min(image.cols, image.rows);
  const double radius = random->uniform(0.2, 0.75) * half_image;
  const double direction = random->uniform(0.0, 2.0 * kPi);
  const cv::Point2d center(0.5 * image.cols + radius * std::cos(direction),
                           0.5 * image.rows + radius * std::sin(direction));
  const double half_diagonal = random->uniform(min_side, max_side) / std::sqrt(2.0);
  const double turn = random->uniform(0.0, 2.0 * kPi);
  std::array<cv::Point2f, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double angle = turn + 0.5 * kPi * static_cast<double>(i) + random->gaussian(0.07);
    const double length = half_diagonal * (1.0 + random->gaussian(0.07));
    corners[i] = center + cv::Point2d(length * std::cos(angle), length * std::sin(angle));
  }
  return corners;
}

/// Puts a small picture onto an image, its corners at the given ones.
void paste(const cv::Mat& picture, const std::array<cv::Point2f, 4>& corners, cv::Mat* image) {
  constexpr int kEnlargement = 8;
  cv::Mat large;
  cv::resize(picture, large, {}, kEnlargement, kEnlargement, cv::INTER_NEAREST);
  const auto right = static_cast<float>(large.cols - 1);
  const auto bottom = static_cast<float>(large.rows - 1);
  const std::array<cv::Point2f, 4> from = {cv::Point2f(0, 0), cv::Point2f(right, 0),
                                           cv::Point2f(right, bottom), cv::Point2f(0, bottom)};
  const cv::Mat transform = cv::getPerspectiveTransform(from.data(), corners.data());
  cv::Mat warped;
  cv::Mat mask;
  cv::warpPerspective(large, warped, transform, image->size());
  cv::warpPerspective(cv::Mat(large.size(), CV_8UC1, cv::Scalar(255)), mask, transform,
                      image->size());
  warped.copyTo(*image, mask > 254);
}

void drawNoise(cv::RNG* random, cv::Mat* image) {
  cv::Mat noise(image->size(), CV_8UC1);
  random->fill(noise, cv::RNG::UNIFORM, 0, 256);
  const double blur = random->uniform(0.0, 4.0);
  if (blur > 0.5) {
    cv::GaussianBlur(noise, noise, {}, blur);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  }
  if (random->uniform(0, 2) == 0) cv::threshold(noise, noise, 127, 255, cv::THRESH_BINARY);
  cv::addWeighted(*image, 0.3, noise, 0.7, 0.0, *image);
}

void drawLines(cv::RNG* random, cv::Mat* image) {
  for (int i = random->uniform(20, 300); i > 0; --i) {
    cv::line(*image, anyPoint(random, *image), anyPoint(random, *image), random->uniform(0, 256),
             random->uniform(1, 9), cv::LINE_AA);
  }
}

void drawShapes(cv::RNG* random, cv::Mat* image) {
  for (int i = random->uniform(20, 200); i > 0; --i) {
    const auto corners = quadOnMirror(random, *image, 4.0, 90.0);
    const std::vector<cv::Point> outline(corners.begin(), corners.end());
    const int grey = random->uniform(0, 256);
    switch (random->uniform(0, 3)) {
      case 0:
        cv::fillConvexPoly(*image, outline, grey, cv::LINE_AA);
        break;
      case 1:
        cv::polylines(*image, outline, true, grey, random->uniform(1, 9), cv::LINE_AA);
        break;
      default:
        cv::circle(*image, outline[0], random->uniform(1, 40), grey, random->uniform(-1, 5) | 1,
                   cv::LINE_AA);
    }
  }
}

void drawCheckerboards(cv::RNG* random, cv::Mat* image) {
  for (int i = random->uniform(3, 15); i > 0; --i) {
    cv::Mat board(random->uniform(3, 14), random->uniform(3, 14), CV_8UC1);
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.cols; ++column) {
        board.at<std::uint8_t>(row, column) = (row + column) % 2 == 0 ? 20 : 230;
      }
    }
    paste(board, quadOnMirror(random, *image, 20.0, 140.0), image);
  }
}

void drawText(cv::RNG* random, cv::Mat* image) {
  for (int i = random->uniform(20, 120); i > 0; --i) {
    std::string text;
    for (int k = random->uniform(1, 12); k > 0; --k) {
      text += static_cast<char>(random->uniform(33, 127));
    }
    const double scale = random->uniform(0.3, 2.5);
    cv::putText(*image, text, anyPoint(random, *image), random->uniform(0, 8), scale,
                random->uniform(0, 256), random->uniform(1, 6), cv::LINE_AA);
  }
}

cv::Mat background(cv::RNG* random, const cv::Size& size) {
  cv::Mat corners(2, 2, CV_8UC1);
  random->fill(corners, cv::RNG::UNIFORM, 20, 236);
  cv::Mat image;
  cv::resize(corners, image, size, 0.0, 0.0, cv::INTER_LINEAR);
  return image;
}

}  // namespace

Clutter::Clutter(const RecordedSequence& sequence) {
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    rooms_.push_back(roomWithoutMarkers(sequence, i));
  }
  const std::string& family = sequence.map.markers.at(0).family;
  std::set<int> mapped;
  for (const Marker& marker : sequence.map.markers) mapped.insert(marker.id);
  for (int id = 0; id < tagCount(family); ++id) {
    if (mapped.count(id) == 0) unmapped_tags_.push_back(modulesOf(family, id));
  }
}

const char* Clutter::name(Kind kind) { return kNames.at(kind); }

cv::Mat Clutter::image(Kind kind, std::uint64_t seed) const {
  cv::RNG random(seed + 1);  // seed 0 stands for a fixed one
  cv::Mat image = background(&random, rooms_[0].size());
  draw(kind, &random, &image);
  cv::Mat noise(image.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, random.uniform(0.5, 4.0));
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  return image;
}

void Clutter::draw(Kind kind, cv::RNG* random, cv::Mat* image) const {
  switch (kind) {
    case kNoise:
      return drawNoise(random, image);
    case kLines:
      return drawLines(random, image);
    case kShapes:
      return drawShapes(random, image);
    case kCheckerboards:
      return drawCheckerboards(random, image);
    case kText:
      return drawText(random, image);
    case kRandomTags:
      for (int i = random->uniform(5, 30); i > 0; --i) {
        drawTag(randomModules(random), random, image);
      }
      return;
    case kUnmappedTags:
      for (int i = random->uniform(5, 30); i > 0; --i) {
        const int tag = random->uniform(0, static_cast<int>(unmapped_tags_.size()));
        drawTag(unmapped_tags_[static_cast<std::size_t>(tag)], random, image);
      }
      return;
    case kRoom: {
      const int room = random->uniform(0, static_cast<int>(rooms_.size()));
      rooms_[static_cast<std::size_t>(room)].copyTo(*image);
      if (random->uniform(0, 3) > 0) drawShapes(random, image);
      return;
    }
    default:
      for (const Kind part : {kRoom, kLines, kCheckerboards, kText, kRandomTags, kUnmappedTags}) {
        if (random->uniform(0, 2) == 0) draw(part, random, image);
      }
  }
}

void Clutter::drawTag(const cv::Mat& modules, cv::RNG* random, cv::Mat* image) const {
  auto corners = quadOnMirror(random, *image, 16.0, 110.0);
  // As a mirror shows it.
  std::swap(corners[1], corners[3]);
  const int black = random->uniform(0, 60);
  const int white = random->uniform(150, 256);
  cv::Mat grey;
  modules.convertTo(grey, CV_8U, (white - black) / 255.0, black);
  paste(grey, corners, image);
}

cv::Mat Clutter::randomModules(cv::RNG* random) const {
  constexpr int kBorders = 2;
  cv::Mat modules = unmapped_tags_.front().clone();
  for (int row = kBorders; row < modules.rows - kBorders; ++row) {
    for (int column = kBorders; column < modules.cols - kBorders; ++column) {
      modules.at<std::uint8_t>(row, column) = random->uniform(0, 2) == 0 ? 0 : 255;
    }
  }
  return modules;
}

}  // namespace omnitag
