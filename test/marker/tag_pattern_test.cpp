#include "marker/tag_pattern.h"

#include <apriltag/tag36h11.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "marker/tag_family.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

TEST(TagPatternTest, IsTheTagAsTheLibraryDrawsIt) {
  for (const char* family : {"tag36h11", "tag16h5", "tagCircle21h7", "tagStandard41h12"}) {
    for (const int id : {0, 3, 17, 29}) {
      const test::TagBitmap bitmap = test::tagBitmap(family, id);
      const TagPattern pattern(family, id);
      ASSERT_EQ(pattern.width(), bitmap.total_width);
      EXPECT_EQ(pattern.widthBetweenCorners(), bitmap.width_at_border);
      for (int row = 0; row < bitmap.total_width; ++row) {
        for (int column = 0; column < bitmap.total_width; ++column) {
          const auto index = static_cast<std::size_t>(row * bitmap.total_width + column);
          EXPECT_EQ(pattern.whiteAt(column, row) > 0.5, bitmap.white[index])
              << family << " " << id << ": column " << column << ", row " << row;
        }
      }
    }
  }
}

/// Share of white among evenly spaced points of a rectangle.
double sampledAverage(const test::TagBitmap& bitmap, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& size) {
  constexpr int kSamples = 300;
  int white = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double x = position.x() + size.x() * ((i + 0.5) / kSamples - 0.5);
      const double y = position.y() + size.y() * ((j + 0.5) / kSamples - 0.5);
      const int index = static_cast<int>(y) * bitmap.total_width + static_cast<int>(x);
      white += bitmap.white[static_cast<std::size_t>(index)] ? 1 : 0;
    }
  }
  return static_cast<double>(white) / (kSamples * kSamples);
}

TEST(TagPatternTest, AveragesOverAnyRectangle) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 42);
  const TagPattern pattern("tag36h11", 42);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d size(0.05 + 3.0 * share(generator), 0.05 + 3.0 * share(generator));
    const Eigen::Vector2d room = Eigen::Vector2d::Constant(bitmap.total_width) - size;
    const Eigen::Vector2d position =
        0.5 * size + Eigen::Vector2d(share(generator) * room.x(), share(generator) * room.y());
    EXPECT_NEAR(pattern.average(position, size).share, sampledAverage(bitmap, position, size),
                0.01);
  }
}

TEST(TagPatternTest, AveragesOverModulesAndTheWholeDrawingAreExact) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 7);
  const TagPattern pattern("tag36h11", 7);
  double white = 0.0;
  for (int row = 0; row < bitmap.total_width; ++row) {
    for (int column = 0; column < bitmap.total_width; ++column) {
      const auto index = static_cast<std::size_t>(row * bitmap.total_width + column);
      const double module = bitmap.white[index] ? 1.0 : 0.0;
      EXPECT_NEAR(pattern.average({column + 0.5, row + 0.5}, {1.0, 1.0}).share, module, 1e-12);
      white += module;
    }
  }
  const double width = bitmap.total_width;
  EXPECT_NEAR(pattern.average({0.5 * width, 0.5 * width}, {width, width}).share,
              white / (width * width), 1e-12);
}

TEST(TagPatternTest, DerivativesAreThoseOfTheAverage) {
  const TagPattern pattern("tag36h11", 42);
  constexpr double kStep = 1e-6;
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> coordinate(2.0, pattern.width() - 2.0);
  std::uniform_real_distribution<double> edge(0.1, 3.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d position(coordinate(generator), coordinate(generator));
    const Eigen::Vector2d size(edge(generator), edge(generator));
    const TagPattern::White white = pattern.average(position, size);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      const double difference = pattern.average(position + step, size).share -
                                pattern.average(position - step, size).share;
      EXPECT_NEAR(white.by_position[axis], difference / (2.0 * kStep), 1e-5);
    }
  }
}

/// A parallelogram within a drawing, by its middle and its sides.
struct Parallelogram {
  Eigen::Vector2d middle;
  Eigen::Vector2d side_u;
  Eigen::Vector2d side_v;

  TagPattern::Window window() const { return {side_u, side_v}; }
};

/// What a pixel may see: sides of up to `longest` modules, at an angle of at least 30 degrees.
std::vector<Parallelogram> randomParallelograms(int width, int count, double longest) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Parallelogram> parallelograms;
  for (int i = 0; i < count; ++i) {
    const double direction = 2.0 * kPi * share(generator);
    const double angle = radians(30.0 + 120.0 * share(generator));
    const double length_u = 0.1 + (longest - 0.1) * share(generator);
    const double length_v = 0.1 + (longest - 0.1) * share(generator);
    Parallelogram one;
    one.side_u = length_u * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    one.side_v =
        length_v * Eigen::Vector2d(std::cos(direction + angle), std::sin(direction + angle));
    const Eigen::Vector2d reach = 0.5 * (one.side_u.cwiseAbs() + one.side_v.cwiseAbs());
    const Eigen::Vector2d room = Eigen::Vector2d::Constant(width) - 2.0 * reach;
    const double along_x = share(generator);
    const double along_y = share(generator);
    one.middle = reach + Eigen::Vector2d(along_x * room.x(), along_y * room.y());
    parallelograms.push_back(one);
  }
  return parallelograms;
}

/// Calls back with the module in which each of the evenly spread points of a parallelogram lies,
/// and with the point's share of the whole.
template <typename Visit>
void sample(const Parallelogram& one, const Visit& visit) {
  constexpr int kSamples = 200;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Eigen::Vector2d point = one.middle + ((i + 0.5) / kSamples - 0.5) * one.side_u +
                                    ((j + 0.5) / kSamples - 0.5) * one.side_v;
      visit(static_cast<int>(point.x()), static_cast<int>(point.y()), 1.0 / (kSamples * kSamples));
    }
  }
}

TEST(TagPatternTest, AveragesOverParallelogramsAlongTheModulesAreExact) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 42);
  const TagPattern pattern("tag36h11", 42);
  for (const Parallelogram& one : randomParallelograms(pattern.width(), 40, 2.5)) {
    const Eigen::Vector2d size(one.side_u.norm(), one.side_v.norm());
    const Eigen::Vector2d middle = one.middle.cwiseMax(1.3).cwiseMin(pattern.width() - 1.3);
    const double expected = sampledAverage(bitmap, middle, size);
    const Eigen::Vector2d along_x(size.x(), 0.0);
    const Eigen::Vector2d along_y(0.0, size.y());
    EXPECT_NEAR(pattern.averageOver(middle, {along_x, along_y}).share, expected, 0.01);
    EXPECT_NEAR(pattern.averageOver(middle, {-along_y, along_x}).share, expected, 0.01);
  }
}

TEST(TagPatternTest, AveragesOverAnyParallelogram) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 42);
  const TagPattern pattern("tag36h11", 42);
  double squares = 0.0;
  std::vector<double> errors;
  constexpr int kCount = 1000;
  for (const Parallelogram& one : randomParallelograms(pattern.width(), kCount, 1.5)) {
    double expected = 0.0;
    sample(one, [&](int column, int row, double share) {
      const auto index = static_cast<std::size_t>(row * bitmap.total_width + column);
      expected += bitmap.white[index] ? share : 0.0;
    });
    const double error = pattern.averageOver(one.middle, one.window()).share - expected;
    squares += error * error / kCount;
    errors.push_back(std::abs(error));
  }
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.18);
  const auto rarely = errors.begin() + kCount * 99 / 100;
  std::nth_element(errors.begin(), rarely, errors.end());
  RecordProperty("rms_error", std::to_string(std::sqrt(squares)));
  RecordProperty("error_of_99_percent", std::to_string(*rarely));
  EXPECT_LT(std::sqrt(squares), 0.02);
  // A few cover many corners of modules: the worst of 20,000 is off by 0.175.
  EXPECT_LT(*rarely, 0.07);
}

TEST(TagPatternTest, DerivativesAreThoseOfTheAverageOverAParallelogram) {
  const TagPattern pattern("tag36h11", 42);
  constexpr double kStep = 1e-6;
  for (const Parallelogram& one : randomParallelograms(pattern.width(), 200, 2.0)) {
    const Eigen::Vector2d middle = one.middle.cwiseMax(2.1).cwiseMin(pattern.width() - 2.1);
    const TagPattern::White white = pattern.averageOver(middle, one.window());
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      const double difference = pattern.averageOver(middle + step, one.window()).share -
                                pattern.averageOver(middle - step, one.window()).share;
      EXPECT_NEAR(white.by_position[axis], difference / (2.0 * kStep), 1e-5);
    }
  }
}

TEST(TagPatternTest, TellsWhereTheDrawingIsEven) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 42);
  const TagPattern pattern("tag36h11", 42);
  const int width = bitmap.total_width;
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> coordinate(-1.0, width + 1.0);
  std::uniform_real_distribution<double> reach_along(0.05, 1.0);
  int even = 0;
  constexpr int kCount = 500;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector2d position(coordinate(generator), coordinate(generator));
    const Eigen::Vector2d reach(reach_along(generator), reach_along(generator));
    const Eigen::Vector2d low = position - reach;
    const Eigen::Vector2d high = position + reach;
    if (high.minCoeff() <= 0.0 || low.maxCoeff() >= width) continue;
    bool has_white = false;
    bool has_black = false;
    for (int row = 0; row < width; ++row) {
      for (int column = 0; column < width; ++column) {
        if (column + 1 <= low.x() || column >= high.x() || row + 1 <= low.y() || row >= high.y()) {
          continue;
        }
        const bool white = bitmap.white[static_cast<std::size_t>(row * width + column)];
        (white ? has_white : has_black) = true;
      }
    }
    EXPECT_EQ(pattern.isEvenAround(position, reach), !(has_white && has_black))
        << low.transpose() << " to " << high.transpose();
    even += has_white && has_black ? 0 : 1;
  }
  EXPECT_GT(even, kCount / 10);
  EXPECT_LT(even, kCount / 2);
  // It looks no farther than the next module.
  EXPECT_TRUE(pattern.isEvenAround({0.2, 0.2}, {0.7, 1.0}));
  EXPECT_FALSE(pattern.isEvenAround({0.2, 0.2}, {0.7, 1.1}));
}

/// Number of the data module at a place of the grid; nothing where the layout fixes the module.
std::optional<int> dataModuleAt(const TagPattern& pattern, int column, int row) {
  std::vector<TagPattern::DataShare> shares;
  pattern.appendDataShares({column + 0.5, row + 0.5}, {{0.5, 0.0}, {0.0, 0.6}}, &shares);
  if (shares.empty()) return std::nullopt;
  EXPECT_EQ(shares.size(), 1U);
  EXPECT_NEAR(shares.front().share, 1.0, 1e-12);
  return shares.front().module;
}

TEST(TagPatternTest, DataModulesAreThoseWhichDifferAmongTheTagsOfAFamily) {
  for (const std::string& family : tagFamilies()) {
    const int count = tagCount(family);
    const int tags = std::min(count, 80);
    std::vector<TagPattern> patterns;
    for (int i = 0; i < tags; ++i) {
      // Not in even steps, which may leave the last bits as they are.
      patterns.emplace_back(family, (i * (count / tags) + i % 7) % count);
    }
    const TagPattern& first = patterns.front();
    std::vector<int> places(static_cast<std::size_t>(first.dataModules()), 0);
    for (int row = 0; row < first.width(); ++row) {
      for (int column = 0; column < first.width(); ++column) {
        const bool differs =
            std::any_of(patterns.begin(), patterns.end(), [&](const TagPattern& pattern) {
              return pattern.whiteAt(column, row) != first.whiteAt(column, row);
            });
        const std::optional<int> module = dataModuleAt(first, column, row);
        EXPECT_EQ(module.has_value(), differs)
            << family << ": column " << column << ", row " << row;
        if (!module) continue;
        ++places[static_cast<std::size_t>(*module)];
        for (const TagPattern& pattern : patterns) {
          EXPECT_EQ(pattern.dataAt(*module), 2.0 * pattern.whiteAt(column, row) - 1.0) << family;
        }
      }
    }
    for (const int number : places) EXPECT_EQ(number, 1) << family;
  }
}

TEST(TagPatternTest, DataModulesStandInTheOrderOfTheCodesBits) {
  const std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)> family(tag36h11_create(),
                                                                               tag36h11_destroy);
  for (const int id : {0, 1, 123, 586}) {
    const TagPattern pattern("tag36h11", id);
    ASSERT_EQ(pattern.dataModules(), 36);
    for (int bit = 0; bit < 36; ++bit) {
      EXPECT_EQ(pattern.dataAt(bit) > 0.0, ((family->codes[id] >> (35 - bit)) & 1U) != 0)
          << id << ", bit " << bit;
    }
  }
}

/// Rectangles within a drawing.
std::vector<Parallelogram> randomRectangles(int width, int count, double longest) {
  std::vector<Parallelogram> rectangles = randomParallelograms(width, count, longest);
  for (Parallelogram& one : rectangles) {
    one.side_u = Eigen::Vector2d(one.side_u.norm(), 0.0);
    one.side_v = Eigen::Vector2d(0.0, one.side_v.norm());
    const Eigen::Vector2d half(0.5 * one.side_u.x(), 0.5 * one.side_v.y());
    one.middle = one.middle.cwiseMax(half).cwiseMin(Eigen::Vector2d::Constant(width) - half);
  }
  return rectangles;
}

/// One element for each data module.
Eigen::VectorXd sharesOf(const TagPattern& pattern, const Parallelogram& rectangle) {
  // What was there before stays.
  std::vector<TagPattern::DataShare> shares = {{0, 7.0}};
  pattern.appendDataShares(rectangle.middle, rectangle.window(), &shares);
  EXPECT_EQ(shares.front().share, 7.0);
  shares.erase(shares.begin());
  Eigen::VectorXd all = Eigen::VectorXd::Zero(pattern.dataModules());
  for (const TagPattern::DataShare& share : shares) all[share.module] += share.share;
  return all;
}

TEST(TagPatternTest, DataSharesAreThoseOfTheRectangle) {
  for (const char* family : {"tag36h11", "tagCircle21h7", "tagStandard41h12"}) {
    const TagPattern pattern(family, 17);
    std::map<std::pair<int, int>, int> modules;
    for (int row = 0; row < pattern.width(); ++row) {
      for (int column = 0; column < pattern.width(); ++column) {
        if (const auto module = dataModuleAt(pattern, column, row))
          modules[{column, row}] = *module;
      }
    }
    for (const Parallelogram& one : randomRectangles(pattern.width(), 100, 1.5)) {
      Eigen::VectorXd expected = Eigen::VectorXd::Zero(pattern.dataModules());
      sample(one, [&](int column, int row, double share) {
        const auto module = modules.find({column, row});
        if (module != modules.end()) expected[module->second] += share;
      });
      const Eigen::VectorXd shares = sharesOf(pattern, one);
      EXPECT_LT((shares - expected).cwiseAbs().maxCoeff(), 0.01) << family;
    }
  }
}

TEST(TagPatternTest, DataSharesAddUpToTheAverageOfWhatTheLayoutLeavesOpen) {
  // Averages of two tags over the same part differ only by their data modules.
  const TagPattern a("tag36h11", 3);
  const TagPattern b("tag36h11", 400);
  for (const Parallelogram& one : randomRectangles(a.width(), 200, 2.0)) {
    const Eigen::VectorXd shares = sharesOf(a, one);
    double expected = 0.0;
    for (int module = 0; module < a.dataModules(); ++module) {
      expected += shares[module] * (0.5 * (a.dataAt(module) - b.dataAt(module)));
    }
    const Eigen::Vector2d size(one.side_u.x(), one.side_v.y());
    EXPECT_NEAR(a.average(one.middle, size).share - b.average(one.middle, size).share, expected,
                1e-9);
  }
}

TEST(TagPatternTest, AWindowsRectangleIsAsWideAsTheWindowAlongEitherAxis) {
  // In terms of the variance of points spread evenly over it.
  for (const Parallelogram& one : randomParallelograms(10, 50, 2.0)) {
    Eigen::Vector2d variance = Eigen::Vector2d::Zero();
    constexpr int kSamples = 100;
    for (int i = 0; i < kSamples; ++i) {
      for (int j = 0; j < kSamples; ++j) {
        const Eigen::Vector2d off =
            ((i + 0.5) / kSamples - 0.5) * one.side_u + ((j + 0.5) / kSamples - 0.5) * one.side_v;
        variance += off.cwiseAbs2() / (kSamples * kSamples);
      }
    }
    const Eigen::Vector2d expected = (12.0 * variance).cwiseSqrt();
    EXPECT_LT((one.window().size() - expected).norm(), 1e-3 * expected.norm());
  }
}

/// What a pixel that is blurred by `blur` pixels sees, summed over a grid of points.
double blurredShare(const TagPattern& pattern, const Parallelogram& pixel, double blur) {
  constexpr int kSteps = 80;
  const double reach = 4.0 * blur + 0.5;  // pixels
  const auto weight = [blur](double off) {
    const double scale = blur * std::sqrt(2.0);
    return std::erf((off + 0.5) / scale) - std::erf((off - 0.5) / scale);
  };
  double white = 0.0;
  double whole = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double u = reach * (2.0 * (i + 0.5) / kSteps - 1.0);
      const double v = reach * (2.0 * (j + 0.5) / kSteps - 1.0);
      const Eigen::Vector2d place = pixel.middle + u * pixel.side_u + v * pixel.side_v;
      const auto module = [&](double coordinate) {
        return std::clamp(static_cast<int>(std::floor(coordinate)), 0, pattern.width() - 1);
      };
      const double share = weight(u) * weight(v);
      whole += share;
      white += share * pattern.whiteAt(module(place.x()), module(place.y()));
    }
  }
  return white / whole;
}

TEST(TagPatternTest, ABlurredWindowSeesWhatAGaussianDoes) {
  const TagPattern pattern("tag36h11", 5);
  for (const double blur : {0.5, 0.8, 1.2, 2.0}) {
    double sum = 0.0;
    double largest = 0.0;
    int count = 0;
    for (const Parallelogram& one : randomParallelograms(pattern.width(), 150, 0.7)) {
      // No marker that is worth looking at images this skewed.
      const Eigen::Vector2d squares = one.side_u.cwiseAbs2() + one.side_v.cwiseAbs2();
      const double mixed = one.side_u.prod() + one.side_v.prod();
      if (std::abs(mixed) > 0.6 * std::sqrt(squares.prod())) continue;
      const TagPattern::Window window(one.side_u, one.side_v, blur * blur);
      const double off =
          pattern.averageOver(one.middle, window).share - blurredShare(pattern, one, blur);
      sum += off * off;
      largest = std::max(largest, std::abs(off));
      ++count;
    }
    EXPECT_GT(count, 50);
    EXPECT_LT(std::sqrt(sum / count), 0.01) << blur;
    EXPECT_LT(largest, 0.05) << blur;
  }
}

TEST(TagPatternTest, ASweptWindowSeesTheMeanOfItsWay) {
  const TagPattern pattern("tag36h11", 5);
  for (const double blur_variance : {0.0, 1.0}) {
    for (const Eigen::Vector2d& sweep : {Eigen::Vector2d(1.2, 0.0), Eigen::Vector2d(-0.5, 0.9)}) {
      const Eigen::Vector2d side_u(0.3, 0.05);
      const Eigen::Vector2d side_v(-0.04, 0.35);
      const TagPattern::Window still(side_u, side_v, blur_variance);
      const TagPattern::Window swept(side_u, side_v, blur_variance, sweep);
      for (double x = 3.0; x < 7.0; x += 0.37) {
        const Eigen::Vector2d middle(x, 10.0 - x);
        constexpr int kSteps = 200;
        double expected = 0.0;
        for (int i = 0; i < kSteps; ++i) {
          const Eigen::Vector2d place = middle + ((i + 0.5) / kSteps - 0.5) * sweep;
          expected += pattern.averageOver(place, still).share / kSteps;
        }
        EXPECT_NEAR(pattern.averageOver(middle, swept).share, expected, 0.04)
            << middle.transpose() << ", swept " << sweep.transpose();
      }
    }
  }
}

TEST(TagPatternTest, DerivativesOfABlurredWindowAreThoseOfItsAverage) {
  const TagPattern pattern("tag36h11", 42);
  constexpr double kStep = 1e-2;
  for (const Parallelogram& one : randomParallelograms(pattern.width(), 60, 0.7)) {
    const TagPattern::Window window(one.side_u, one.side_v, 1.0, {0.4, 0.2});
    const Eigen::Vector2d found = pattern.averageOver(one.middle, window).by_position;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      const double difference = pattern.averageOver(one.middle + step, window).share -
                                pattern.averageOver(one.middle - step, window).share;
      EXPECT_NEAR(found[axis], difference / (2.0 * kStep), 0.01);
    }
  }
}

TEST(TagPatternTest, DataSharesOfABlurredWindowAddUpToItsAverage) {
  const TagPattern pattern("tag36h11", 5);
  const TagPattern other("tag36h11", 99);
  for (const Parallelogram& one : randomParallelograms(pattern.width(), 60, 0.7)) {
    const TagPattern::Window window(one.side_u, one.side_v, 1.0, {0.4, 0.2});
    std::vector<TagPattern::DataShare> shares;
    pattern.appendDataShares(one.middle, window, &shares);
    double expected = 0.0;
    for (const TagPattern::DataShare& share : shares) {
      expected += share.share * 0.5 * (pattern.dataAt(share.module) - other.dataAt(share.module));
    }
    EXPECT_NEAR(
        pattern.averageOver(one.middle, window).share - other.averageOver(one.middle, window).share,
        expected, 1e-9);
  }
}

TEST(TagPatternsTest, HoldThePatternOfEveryMarker) {
  MarkerMap map;
  for (const auto& [family, id] : {std::pair("tag36h11", 4), std::pair("tag16h5", 4),
                                   std::pair("tag36h11", 9), std::pair("tag36h11", 4)}) {
    Marker marker;
    marker.family = family;
    marker.id = id;
    map.markers.push_back(marker);
  }
  const TagPatterns patterns(map);
  for (const Marker& marker : map.markers) {
    const test::TagBitmap bitmap = test::tagBitmap(marker.family, marker.id);
    const TagPattern& pattern = patterns.of(marker);
    ASSERT_EQ(pattern.width(), bitmap.total_width);
    for (int i = 0; i < bitmap.total_width * bitmap.total_width; ++i) {
      EXPECT_EQ(pattern.whiteAt(i % bitmap.total_width, i / bitmap.total_width) > 0.5,
                bitmap.white[static_cast<std::size_t>(i)]);
    }
  }
  map.markers[1].id = 30;
  EXPECT_THROW(TagPatterns{map}, InputError);
}

TEST(TagPatternTest, EveryFamilyHasPatterns) {
  for (const std::string& family : tagFamilies()) {
    for (const int id : {0, tagCount(family) - 1}) {
      const TagPattern pattern(family, id);
      EXPECT_GE(pattern.width(), pattern.widthBetweenCorners()) << family;
      EXPECT_GT(pattern.widthBetweenCorners(), 0) << family;
      const double width = pattern.width();
      const double share = pattern.average({0.5 * width, 0.5 * width}, {width, width}).share;
      EXPECT_GT(share, 0.1) << family;
      EXPECT_LT(share, 0.9) << family;
    }
  }
}

std::string refusal(const std::string& family, int id) {
  try {
    TagPattern(family, id);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TagPatternTest, RefusesWhatTheLibraryDoesNotHaveByName) {
  EXPECT_NE(refusal("tag99h99", 0).find("'tag99h99'"), std::string::npos);
  for (const int id : {-1, 587}) {
    const std::string message = refusal("tag36h11", id);
    EXPECT_NE(message.find("tag36h11"), std::string::npos);
    EXPECT_NE(message.find("0 to 586"), std::string::npos);
    EXPECT_NE(message.find("found " + std::to_string(id)), std::string::npos);
  }
}

}  // namespace
}  // namespace omnitag
