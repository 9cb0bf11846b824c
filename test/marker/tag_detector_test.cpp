#include "marker/tag_detector.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include "common/yaml_reader.h"
#include "marker/tag_family.h"
#include "omnitag/common/error.h"
#if __has_include(<apriltag/tag36h10.h>)
#include <apriltag/tag36h10.h>
#endif
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <future>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace omnitag {
namespace {

const Corners<Eigen::Vector2d> kTagCorners = {Eigen::Vector2d(-1.0, -1.0),
                                              Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(1.0, 1.0),
                                              Eigen::Vector2d(-1.0, 1.0)};

/// A tag as the library draws it for printing.
struct TagDrawing {
  /// One pixel per module.
  cv::Mat modules;
  /// In modules, edge of the square between the reported corners.
  int border_width = 0;
};

using Create = apriltag_family_t* (*)();
using Destroy = void (*)(apriltag_family_t*);

const std::map<std::string, std::pair<Create, Destroy>>& libraryFamilies() {
  static const std::map<std::string, std::pair<Create, Destroy>> families = {
    {"tag16h5", {tag16h5_create, tag16h5_destroy}},
    {"tag25h9", {tag25h9_create, tag25h9_destroy}},
#if __has_include(<apriltag/tag36h10.h>)
    {"tag36h10", {tag36h10_create, tag36h10_destroy}},
#endif
    {"tag36h11", {tag36h11_create, tag36h11_destroy}},
    {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
    {"tagCircle49h12", {tagCircle49h12_create, tagCircle49h12_destroy}},
    {"tagCustom48h12", {tagCustom48h12_create, tagCustom48h12_destroy}},
    {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}},
    {"tagStandard52h13", {tagStandard52h13_create, tagStandard52h13_destroy}},
  };
  return families;
}

TagDrawing drawTag(const std::string& family_name, int id) {
  const auto [create, destroy] = libraryFamilies().at(family_name);
  const std::unique_ptr<apriltag_family_t, Destroy> family(create(), destroy);
  image_u8_t* const drawing = apriltag_to_image(family.get(), id);
  const std::unique_ptr<image_u8_t, void (*)(void*)> free_drawing(drawing, std::free);
  const std::unique_ptr<std::uint8_t, void (*)(void*)> free_pixels(drawing->buf, std::free);
  TagDrawing tag;
  tag.border_width = family->width_at_border;
  cv::Mat(drawing->height, drawing->width, CV_8UC1, drawing->buf,
          static_cast<std::size_t>(drawing->stride))
      .copyTo(tag.modules);
  return tag;
}

/// A tag in front of a white wall. `image_from_tag` maps the tag's plane, where its corners are
/// `kTagCorners`, to pixels. A pixel is the mean over its area, whose middle has whole coordinates.
cv::Mat render(const TagDrawing& tag, const Eigen::Matrix3d& image_from_tag, cv::Size size) {
  // A Fibonacci lattice: on a grid, edges along its rows would move only in steps.
  constexpr int kSamples = 89;
  constexpr int kGenerator = 55;
  const Eigen::Matrix3d tag_from_image = image_from_tag.inverse();
  const double modules_per_unit = 0.5 * tag.border_width;
  const double middle = 0.5 * tag.modules.cols;
  const auto greyAt = [&](double u, double v) -> int {
    const auto row_times = [&](int row) {
      return tag_from_image(row, 0) * u + tag_from_image(row, 1) * v + tag_from_image(row, 2);
    };
    const double scale = modules_per_unit / row_times(2);
    const double column = middle + row_times(0) * scale;
    const double row = middle - row_times(1) * scale;
    const bool on_tag =
        column >= 0.0 && column < tag.modules.cols && row >= 0.0 && row < tag.modules.rows;
    return on_tag ? tag.modules.ptr<std::uint8_t>(static_cast<int>(row))[static_cast<int>(column)]
                  : 255;
  };
  cv::Mat image(size, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      int sum = 0;
      for (int i = 0; i < kSamples; ++i) {
        const double du = (i + 0.5) / kSamples - 0.5;
        const double dv = (i * kGenerator % kSamples + 0.5) / kSamples - 0.5;
        sum += greyAt(u + du, v + dv);
      }
      image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(sum / kSamples);
    }
  }
  return image;
}

/// The tag upright: y up in the tag, down in the image. `module` is in pixels.
Eigen::Matrix3d upright(const TagDrawing& tag, const Eigen::Vector2d& center, double module) {
  const double half = 0.5 * module * tag.border_width;
  Eigen::Matrix3d image_from_tag;
  image_from_tag << half, 0.0, center.x(), 0.0, -half, center.y(), 0.0, 0.0, 1.0;
  return image_from_tag;
}

Eigen::Matrix3d turnedBy(double angle, const Eigen::Matrix3d& image_from_tag) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(angle).toRotationMatrix();
  return image_from_tag * rotation;
}

/// Tag 36h11 in a plain view, 40 pixels wide.
cv::Mat renderOne(int id) {
  const TagDrawing tag = drawTag("tag36h11", id);
  return render(tag, upright(tag, {40.0, 40.0}, 5.0), {80, 80});
}

double largestCornerError(const TagDetection& detection, const Eigen::Matrix3d& image_from_tag) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kTagCorners.size(); ++i) {
    const Eigen::Vector2d expected = (image_from_tag * kTagCorners[i].homogeneous()).hnormalized();
    largest = std::max(largest, (detection.corners[i] - expected).norm());
  }
  return largest;
}

class EveryFamily : public testing::TestWithParam<std::string> {};

std::set<std::string> libraryNames() {
  std::set<std::string> names;
  for (const auto& [name, functions] : libraryFamilies()) names.insert(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Library, EveryFamily, testing::ValuesIn(libraryNames()),
                         [](const auto& info) { return info.param; });

TEST(TagFamilies, HaveAllOfTheLibrary) {
  std::set<std::string> names;
  for (const std::string& name : tagFamilies()) {
    if (name.rfind("DICT_", 0) != 0) names.insert(name);
  }
  EXPECT_EQ(names.erase("aprilgrid"), 1u);
  EXPECT_EQ(names, libraryNames());
  EXPECT_EQ(tagCount("tag16h5"), 30);
  EXPECT_EQ(tagCount("tag36h11"), 587);
}

TEST(TagFamilies, UnknownOnesAreRefused) {
  EXPECT_THROW(tagCount("tag36h12"), InputError);
  EXPECT_THROW(TagDetector(TagDetectorConfig(), {"tag36h11", ""}), InputError);
}

void expectReadInPlace(const std::string& family, int id, const Eigen::Matrix3d& image_from_tag,
                       const std::vector<TagDetection>& tags) {
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_EQ(tags[0].family, family);
  EXPECT_EQ(tags[0].id, id);
  EXPECT_EQ(tags[0].hamming, 0);
  EXPECT_LT(largestCornerError(tags[0], image_from_tag), 0.05);
  const Eigen::Vector2d center = image_from_tag.col(2).hnormalized();
  EXPECT_LT((tags[0].center - center).norm(), 0.05);
}

TEST_P(EveryFamily, CornersAreInOrderAndInPlace) {
  const TagDetector detector(TagDetectorConfig(), {GetParam()});
  for (const int id : {0, tagCount(GetParam()) - 1}) {
    SCOPED_TRACE(id);
    const TagDrawing tag = drawTag(GetParam(), id);
    const Eigen::Matrix3d image_from_tag = upright(tag, {40.25, 38.75}, 5.5);
    expectReadInPlace(GetParam(), id, image_from_tag,
                      detector.detect(render(tag, image_from_tag, {80, 80})));
  }
}

TEST_P(EveryFamily, CornersFollowASlantedTag) {
  const TagDetector detector(TagDetectorConfig(), {GetParam()});
  const TagDrawing tag = drawTag(GetParam(), 1);
  for (const double angle : {0.6, 1.6, -1.9}) {
    SCOPED_TRACE(angle);
    Eigen::Matrix3d slanted = Eigen::Matrix3d::Identity();
    slanted(0, 0) = 0.6;
    slanted(2, 0) = 0.1;
    slanted(2, 1) = -0.05;
    const Eigen::Matrix3d image_from_tag =
        turnedBy(angle, upright(tag, {60.3, 59.6}, 8.0)) * slanted;
    expectReadInPlace(GetParam(), 1, image_from_tag,
                      detector.detect(render(tag, image_from_tag, {120, 120})));
  }
}

TEST_P(EveryFamily, IsReadWhenItsDecodingTableHadToBeMadeSmall) {
  TagDetectorConfig config;
  config.max_hamming = 3;
  const TagDrawing tag = drawTag(GetParam(), 2);
  const cv::Mat image = render(tag, upright(tag, {40.0, 40.0}, 5.0), {80, 80});
  const std::vector<TagDetection> tags = TagDetector(config, {GetParam()}).detect(image);
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_EQ(tags[0].id, 2);
}

// An image of integral edges shows the pixel convention by itself: a tag that fills the pixels
// 20 to 59 ends at 19.5 and 59.5.
TEST(TagDetector, CentersOfPixelsHaveWholeCoordinates) {
  const TagDrawing tag = drawTag("tag36h11", 5);
  cv::Mat image(80, 80, CV_8UC1, cv::Scalar(255));
  for (int v = 20; v < 60; ++v) {
    for (int u = 20; u < 60; ++u) {
      image.at<std::uint8_t>(v, u) =
          tag.modules.at<std::uint8_t>(1 + (v - 20) / 5, 1 + (u - 20) / 5);
    }
  }
  const std::vector<TagDetection> tags =
      TagDetector(TagDetectorConfig(), {"tag36h11"}).detect(image);
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_LT((tags[0].corners[0] - Eigen::Vector2d(19.5, 59.5)).norm(), 0.01);
  EXPECT_LT((tags[0].corners[1] - Eigen::Vector2d(59.5, 59.5)).norm(), 0.01);
  EXPECT_LT((tags[0].corners[2] - Eigen::Vector2d(59.5, 19.5)).norm(), 0.01);
  EXPECT_LT((tags[0].corners[3] - Eigen::Vector2d(19.5, 19.5)).norm(), 0.01);
  EXPECT_LT((tags[0].center - Eigen::Vector2d(39.5, 39.5)).norm(), 0.01);
}

TEST(TagDetector, DoesNotReadMirroredTags) {
  const TagDetector detector(TagDetectorConfig(), {"tag36h11"});
  for (const int id : {0, 100, 200, 586}) {
    cv::Mat mirrored;
    cv::flip(renderOne(id), mirrored, 1);
    EXPECT_TRUE(detector.detect(mirrored).empty()) << id;
  }
}

TEST(TagDetector, SharedTablesOutliveEitherDetector) {
  TagDetectorConfig reduced;
  reduced.quad_decimate = 2.0;
  const cv::Mat image = renderOne(12);
  auto first = std::make_unique<TagDetector>(TagDetectorConfig(), MarkerFamilies{"tag36h11"});
  auto second = std::make_unique<TagDetector>(reduced, *first);
  EXPECT_EQ(second->detect(image).size(), 1U);
  first.reset();
  EXPECT_EQ(second->detect(image).size(), 1U);
  auto third = std::make_unique<TagDetector>(TagDetectorConfig(), *second);
  second.reset();
  EXPECT_EQ(third->detect(image).size(), 1U);
}

TEST(TagDetector, TellsFamiliesApart) {
  const TagDetector both(TagDetectorConfig(), {"tag36h11", "tagStandard41h12"});
  for (const std::string family : {"tag36h11", "tagStandard41h12"}) {
    const TagDrawing tag = drawTag(family, 12);
    const std::vector<TagDetection> tags =
        both.detect(render(tag, upright(tag, {40.0, 40.0}, 5.0), {80, 80}));
    ASSERT_EQ(tags.size(), 1u);
    EXPECT_EQ(tags[0].family, family);
    EXPECT_EQ(tags[0].id, 12);
  }
  EXPECT_TRUE(TagDetector(TagDetectorConfig(), {"tag16h5"}).detect(renderOne(12)).empty());
  EXPECT_TRUE(TagDetector(TagDetectorConfig(), {}).detect(renderOne(12)).empty());
}

TEST(TagDetector, CorrectsWrongBitsUpToTheLimit) {
  TagDrawing tag = drawTag("tag36h11", 3);
  for (const cv::Point module : {cv::Point(3, 4), cv::Point(6, 2)}) {
    auto& grey = tag.modules.at<std::uint8_t>(module);
    grey = static_cast<std::uint8_t>(255 - grey);
  }
  const cv::Mat image = render(tag, upright(tag, {40.0, 40.0}, 5.0), {80, 80});
  TagDetectorConfig config;
  const std::vector<TagDetection> tags = TagDetector(config, {"tag36h11"}).detect(image);
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_EQ(tags[0].id, 3);
  EXPECT_EQ(tags[0].hamming, 2);
  config.max_hamming = 1;
  EXPECT_TRUE(TagDetector(config, {"tag36h11"}).detect(image).empty());
}

TEST(TagDetector, LeavesOutFaintTags) {
  const cv::Mat image = 0.2 * renderOne(3) + 100.0;
  TagDetectorConfig config;
  config.min_decision_margin = 0.0;
  const std::vector<TagDetection> tags = TagDetector(config, {"tag36h11"}).detect(image);
  ASSERT_EQ(tags.size(), 1u);
  config.min_decision_margin = tags[0].decision_margin + 0.1;
  EXPECT_TRUE(TagDetector(config, {"tag36h11"}).detect(image).empty());
}

TEST(TagDetector, ReadsNoTagOfLessContrastThanAskedFor) {
  // Black and white are 51 grey levels apart.
  const cv::Mat image = 0.2 * renderOne(3) + 100.0;
  const TagDetector detector({}, {"tag36h11"});
  EXPECT_EQ(detector.detect(image, 45).size(), 1u);
  EXPECT_TRUE(detector.detect(image, 60).empty());
  // The detector's settings remain a lower limit, and do not change.
  EXPECT_EQ(detector.detect(image, 0).size(), 1u);
  TagDetectorConfig config;
  config.min_white_black_diff = 60;
  EXPECT_TRUE(TagDetector(config, {"tag36h11"}).detect(image, 45).empty());
}

void expectPaddedRowsReadAndKept(double quad_sigma, bool deglitch) {
  TagDetectorConfig config;
  config.quad_sigma = quad_sigma;
  config.deglitch = deglitch;
  cv::Mat large(400, 700, CV_8UC1, cv::Scalar(90));
  const cv::Mat view = large(cv::Rect(301, 203, 80, 80));
  renderOne(8).copyTo(view);
  const cv::Mat before = large.clone();
  const std::vector<TagDetection> tags = TagDetector(config, {"tag36h11"}).detect(view);
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_EQ(tags[0].id, 8);
  EXPECT_LT((tags[0].center - Eigen::Vector2d(40.0, 40.0)).norm(), 0.05);
  EXPECT_EQ(cv::countNonZero(large != before), 0);
}

TEST(TagDetector, RowsMayBePaddedAndTheImageStaysAsItIs) {
  for (const double quad_sigma : {0.0, 0.8}) {
    for (const bool deglitch : {false, true}) {
      SCOPED_TRACE(testing::Message() << quad_sigma << " " << deglitch);
      expectPaddedRowsReadAndKept(quad_sigma, deglitch);
    }
  }
}

TEST(TagDetector, ReducedViewsGiveTheSameCorners) {
  const TagDrawing tag = drawTag("tag36h11", 9);
  const Eigen::Matrix3d image_from_tag = turnedBy(0.2, upright(tag, {80.3, 79.1}, 12.0));
  const cv::Mat image = render(tag, image_from_tag, {160, 160});
  for (const double quad_decimate : {1.0, 1.5, 2.0, 3.0}) {
    TagDetectorConfig config;
    config.quad_decimate = quad_decimate;
    const std::vector<TagDetection> tags = TagDetector(config, {"tag36h11"}).detect(image);
    ASSERT_EQ(tags.size(), 1u) << quad_decimate;
    EXPECT_LT(largestCornerError(tags[0], image_from_tag), 0.05) << quad_decimate;
  }
}

cv::Mat noise(int width, int height, std::minstd_rand* random) {
  cv::Mat image(height, width, CV_8UC1);
  std::generate(image.begin<std::uint8_t>(), image.end<std::uint8_t>(),
                [&] { return static_cast<std::uint8_t>((*random)() % 256); });
  return image;
}

/// How many tags are read in images of noise of up to 25 pixels a side.
std::size_t countInTinyImages(double quad_decimate, double quad_sigma) {
  TagDetectorConfig config;
  config.quad_decimate = quad_decimate;
  config.quad_sigma = quad_sigma;
  config.deglitch = true;
  const TagDetector detector(config, {"tag36h11"});
  std::minstd_rand random(1);
  std::size_t count = detector.detect(cv::Mat(0, 0, CV_8UC1)).size();
  for (const int height : {1, 2, 3, 4, 7, 8, 11, 12, 16, 24}) {
    for (int width = 1; width <= 25; ++width) {
      count += detector.detect(noise(width, height, &random)).size();
    }
  }
  return count;
}

TEST(TagDetector, TinyImagesHoldNoTag) {
  for (const double quad_decimate : {1.0, 1.5, 2.0, 3.0}) {
    for (const double quad_sigma : {0.0, 3.0, -3.0}) {
      EXPECT_EQ(countInTinyImages(quad_decimate, quad_sigma), 0u);
    }
  }
}

TEST(TagDetector, RefusesOtherKindsOfImages) {
  const TagDetector detector(TagDetectorConfig(), {"tag36h11"});
  EXPECT_THROW(detector.detect(cv::Mat(40, 40, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(detector.detect(cv::Mat(40, 40, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(detector.detect(cv::Mat(10, 40000, CV_8UC1)), std::invalid_argument);
}

int countReadFrom(int first_id) {
  const TagDetector detector(TagDetectorConfig(), {"tag36h11"});
  int correct = 0;
  for (int id = first_id; id < first_id + 10; ++id) {
    const std::vector<TagDetection> tags = detector.detect(renderOne(id));
    if (tags.size() == 1 && tags[0].id == id) ++correct;
  }
  return correct;
}

TEST(TagDetector, EachThreadMayHaveItsOwn) {
  std::future<int> other = std::async(std::launch::async, countReadFrom, 100);
  EXPECT_EQ(countReadFrom(0), 10);
  EXPECT_EQ(other.get(), 10);
}

TEST(TagDetector, Moves) {
  TagDetector first(TagDetectorConfig(), {"tag36h11"});
  TagDetector second(TagDetectorConfig(), {"tag16h5"});
  second = std::move(first);
  EXPECT_EQ(second.detect(renderOne(4)).size(), 1u);
}

TagDetectorConfig readConfig(const std::string& text) {
  return readTagDetectorConfig(YamlReader::fromText(text, "detector.yaml"));
}

TEST(TagDetectorConfig, KeepsDefaultsAndReadsWhatIsThere) {
  const TagDetectorConfig defaults;
  const TagDetectorConfig config =
      readConfig("{quad_decimate: 2, max_hamming: 1, critical_angle: 0.3, deglitch: true}");
  EXPECT_EQ(config.quad_decimate, 2.0);
  EXPECT_EQ(config.max_hamming, 1);
  EXPECT_EQ(config.critical_angle, 0.3);
  EXPECT_TRUE(config.deglitch);
  EXPECT_EQ(config.min_white_black_diff, defaults.min_white_black_diff);
  EXPECT_EQ(config.refine_edges, defaults.refine_edges);
  EXPECT_EQ(readConfig("{}").quad_decimate, defaults.quad_decimate);
}

std::string refusal(const std::string& text) {
  try {
    readConfig(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TagDetectorConfig, RefusesWhatTheLibraryCannotDo) {
  for (const std::string text :
       {"quad_decimate: 0", "quad_decimate: 2.5", "quad_decimate: 1.2", "quad_decimate: 100",
        "quad_sigma: 20", "refine_edges: maybe", "decode_sharpening: -1", "min_cluster_pixels: -1",
        "max_nmaxima: 3", "critical_angle: 2", "max_line_fit_mse: 0", "min_white_black_diff: 256",
        "deglitch: 3", "max_hamming: 4", "max_hamming: 1.5", "min_decision_margin: .nan"}) {
    const std::string key = text.substr(0, text.find(':'));
    EXPECT_EQ(refusal(text).rfind("detector.yaml:1: " + key + ": expected ", 0), 0u)
        << refusal(text);
  }
  EXPECT_NE(refusal("quad_decimation: 2").find("unknown key"), std::string::npos);
}

}  // namespace
}  // namespace omnitag
