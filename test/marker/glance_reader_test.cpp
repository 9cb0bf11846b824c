#include "marker/glance_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

constexpr double kWorkingDistance = 3.0;  // m

struct Setup {
  std::string name;
  std::shared_ptr<const CameraModel> (*camera)();
  Eigen::Isometry3d base_from_camera;
  double height;
  double size;
  bool is_mirrored;
};

/// How gtest names a setup.
void PrintTo(const Setup& setup, std::ostream* out) { *out << setup.name; }

std::vector<Setup> setups() {
  return {{"Sphere", test::sphericalCamera, test::lookingDown(), 1.25, 0.5, true},
          {"LargeSphere", test::largeSphericalCamera, test::lookingDown(), 1.25, 0.55, true},
          {"Hyperboloid", test::hyperbolicCamera, test::lookingUp(), 0.3, 0.5, true},
          {"Fisheye", test::equidistantCamera, test::lookingUp(), 1.6, 0.5, false}};
}

class GlanceReaderTest : public testing::TestWithParam<Setup> {
 protected:
  /// Markers all around that face the robot and are large in the image.
  static MarkerMap mapOf(double height) {
    MarkerMap map{"map", {}};
    for (int i = 0; i < 5; ++i) {
      const double direction = 0.3 + i * 2.0 * kPi / 5.0;
      Marker marker = test::wallMarker(
          20 + i, {2.0 * std::cos(direction), 2.0 * std::sin(direction), height}, direction + kPi);
      marker.size = GetParam().size;
      map.markers.push_back(marker);
    }
    return map;
  }

  std::shared_ptr<const CameraModel> model_ = GetParam().camera();
  MountedCamera camera_{model_, GetParam().base_from_camera};
  MarkerMap map_ = mapOf(GetParam().height);
  Pose truth_{0.2, -0.1, 0.7};
  ViewWarper warper_{model_, kWorkingDistance};
  TagDetector detector_{{}, {"tag36h11"}};
  GlanceReader reader_{model_, {}, detector_};
};

TEST_P(GlanceReaderTest, MirrorsMirror) { EXPECT_EQ(isMirrored(*model_), GetParam().is_mirrored); }

TEST_P(GlanceReaderTest, ReadsLargeMarkersWithExactCorners) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  const Glance seen = reader_.read(panorama, reader_.count() - 1, warper_, camera_.axisUp());
  ASSERT_EQ(seen.readings.size(), map_.markers.size());
  ASSERT_EQ(seen.views.size(), seen.readings.size());
  ASSERT_EQ(seen.view_images.size(), seen.readings.size());
  for (const MarkerReading& reading : seen.readings) {
    const auto marker =
        std::find_if(map_.markers.begin(), map_.markers.end(),
                     [&](const Marker& candidate) { return candidate.id == reading.id; });
    ASSERT_NE(marker, map_.markers.end());
    const MarkerReading exact = *test::exactReading(*marker, camera_, truth_);
    for (std::size_t k = 0; k < exact.corners.size(); ++k) {
      EXPECT_LT((reading.corners[k] - exact.corners[k]).norm(), 0.2) << reading.id << ", " << k;
    }
    EXPECT_LT((reading.center - exact.center).norm(), 0.2) << reading.id;
    EXPECT_EQ(seen.view_images[reading.view].size(), seen.views[reading.view].size);
  }
}

TEST_P(GlanceReaderTest, ReadsWhatIsInTheAnnulusAndNothingElse) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  const auto radiusOf = [this](const Eigen::Vector2d& pixel) {
    return model_->imagePlane().idealFromPixel(pixel)->norm();
  };
  const std::size_t last = reader_.count() - 1;
  const double module = 1.0 / 8.0;  // of the edge
  for (const Marker& marker : map_.markers) {
    const MarkerReading exact = *test::exactReading(marker, camera_, truth_);
    Annulus annulus{radiusOf(exact.corners[0]), radiusOf(exact.corners[0])};
    for (const Eigen::Vector2d& corner : exact.corners) {
      const double border = 2.0 * module * meanEdge(exact.corners) / model_->imagePlane().scale();
      annulus.min_radius = std::min(annulus.min_radius, radiusOf(corner) - border);
      annulus.max_radius = std::max(annulus.max_radius, radiusOf(corner) + border);
    }
    const Glance seen = reader_.read(panorama, last, warper_, camera_.axisUp(), {annulus});
    EXPECT_TRUE(std::any_of(seen.readings.begin(), seen.readings.end(), [&](const auto& reading) {
      return reading.id == marker.id && (reading.center - exact.center).norm() < 0.2;
    })) << marker.id;
    for (const Annulus& beside : {Annulus{0.0, radiusOf(exact.center)},
                                  Annulus{radiusOf(exact.center), annulus.max_radius + 1.0}}) {
      const Glance without = reader_.read(panorama, last, warper_, camera_.axisUp(), {beside});
      EXPECT_TRUE(std::none_of(without.readings.begin(), without.readings.end(),
                               [&](const auto& reading) { return reading.id == marker.id; }))
          << marker.id;
    }
  }
}

TEST_P(GlanceReaderTest, ReadsWhatIsInTheSectorAndNothingElse) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  const std::size_t last = reader_.count() - 1;
  for (const Marker& marker : map_.markers) {
    const MarkerReading exact = *test::exactReading(marker, camera_, truth_);
    const Eigen::Vector2d ideal = *model_->imagePlane().idealFromPixel(exact.center);
    const double azimuth = std::atan2(ideal.y(), ideal.x());
    const auto isRead = [&](const Sector& sector) {
      const Glance seen =
          reader_.read(panorama, last, warper_, camera_.axisUp(), {Annulus{}, sector});
      return std::any_of(seen.readings.begin(), seen.readings.end(), [&](const auto& reading) {
        return reading.id == marker.id && (reading.center - exact.center).norm() < 0.2;
      });
    };
    for (const double half_width : {0.5, 1.2, 2.5}) {
      for (const double off : {-0.7, 0.0, 0.7}) {
        const bool is_whole = std::abs(off) < half_width - 0.3;
        EXPECT_EQ(isRead({azimuth + off, half_width}), is_whole)
            << marker.id << ", " << half_width << ", " << off;
      }
      // The sector ends in its middle.
      EXPECT_FALSE(isRead({azimuth + half_width, half_width})) << marker.id << ", " << half_width;
    }
  }
}

TEST_P(GlanceReaderTest, LooksFirstWhereTheMarkersAre) {
  constexpr double kOverlap = 0.3;
  for (const Marker& marker : map_.markers) {
    cv::Mat panorama = test::renderPanorama({"map", {marker}}, camera_, truth_);
    // Noise all over the image, and stronger contrasts where no marker can be.
    cv::Mat noise(panorama.size(), CV_8S);
    cv::randn(noise, 0.0, 10.0);
    cv::add(panorama, noise, panorama, cv::noArray(), CV_8U);
    const ImagePlane& plane = model_->imagePlane();
    const Eigen::Vector2d center = plane.principalPoint();
    const double inner = 0.3 * plane.scale() * model_->maxRadius();
    for (int x = -static_cast<int>(inner); x < inner; x += 8) {
      cv::line(panorama, cv::Point2d(center.x() + x, center.y() - 0.5 * inner),
               cv::Point2d(center.x() + x, center.y() + 0.5 * inner), x % 16 == 0 ? 0 : 255, 4);
    }
    const MarkerReading exact = *test::exactReading(marker, camera_, truth_);
    const Eigen::Vector2d ideal = *plane.idealFromPixel(exact.center);
    const Annulus annulus{0.45 * model_->maxRadius(), model_->maxRadius()};
    ASSERT_GT(ideal.norm(), annulus.min_radius);
    const std::vector<Sector> sectors = sectorsToGlanceAt(panorama, annulus, plane, kOverlap);
    ASSERT_EQ(sectors.size(), 4U);
    std::set<long> turns;
    for (const Sector& sector : sectors) {
      EXPECT_NEAR(sector.half_width, kPi / 4.0 + 0.5 * kOverlap, 1e-12);
      turns.insert(std::lround(10.0 * sector.azimuth));
    }
    EXPECT_EQ(turns.size(), sectors.size()) << "all around, each quarter once";
    const double off = normalizeAngle(std::atan2(ideal.y(), ideal.x()) - sectors[0].azimuth);
    EXPECT_LT(std::abs(off), sectors[0].half_width) << marker.id;
  }
}

TEST_P(GlanceReaderTest, LooksEverywhereAtOnceWhereMarkersCanBeAtTheAxis) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  const std::vector<Sector> sectors =
      sectorsToGlanceAt(panorama, Annulus{}, model_->imagePlane(), 0.3);
  ASSERT_EQ(sectors.size(), 1U);
  EXPECT_GE(sectors[0].half_width, kPi);
}

TEST_P(GlanceReaderTest, MayStartWithWhatStandsOut) {
  cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  // One marker in deep shade, with its surroundings: it has hardly any contrast.
  const MarkerReading exact = *test::exactReading(map_.markers[0], camera_, truth_);
  const double reach = meanEdge(exact.corners);
  const cv::Rect shade =
      cv::Rect(cvRound(exact.center.x() - reach), cvRound(exact.center.y() - reach),
               cvRound(2.0 * reach), cvRound(2.0 * reach)) &
      cv::Rect({}, panorama.size());
  panorama(shade) = 0.25 * panorama(shade) + 20.0;
  GlanceAim obvious;
  obvious.starts_with_the_obvious = true;
  const auto isRead = [](const Glance& seen, int id) {
    return std::any_of(seen.readings.begin(), seen.readings.end(),
                       [id](const MarkerReading& reading) { return reading.id == id; });
  };
  const Glance first = reader_.read(panorama, 0, warper_, camera_.axisUp(), obvious);
  EXPECT_FALSE(isRead(first, map_.markers[0].id));
  EXPECT_GE(first.readings.size(), 2U);
  const std::size_t last = reader_.count() - 1;
  EXPECT_TRUE(isRead(reader_.read(panorama, last, warper_, camera_.axisUp()), map_.markers[0].id));
}

TEST_P(GlanceReaderTest, ReadsTheLargestWhereSomeAreEnough) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  std::vector<double> edges;
  for (const Marker& marker : map_.markers) {
    edges.push_back(meanEdge(test::exactReading(marker, camera_, truth_)->corners));
  }
  std::sort(edges.begin(), edges.end());
  GlanceAim aim;
  aim.at_most = 2;
  const Glance seen = reader_.read(panorama, reader_.count() - 1, warper_, camera_.axisUp(), aim);
  ASSERT_EQ(seen.readings.size(), 2U);
  for (const MarkerReading& reading : seen.readings) {
    constexpr double kAlike = 0.97;  // the largest are chosen before corners are refined
    EXPECT_GT(meanEdge(reading.corners), kAlike * edges[edges.size() - 2]);
  }
}

TEST_P(GlanceReaderTest, LeavesThePanoramaAsItIs) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  const cv::Mat before = panorama.clone();
  for (std::size_t glance = 0; glance < reader_.count(); ++glance) {
    reader_.read(panorama, glance, warper_, camera_.axisUp());
    EXPECT_EQ(cv::norm(panorama, before, cv::NORM_L1), 0.0);
  }
}

TEST_P(GlanceReaderTest, LargeImagesAreReducedAtFirst) {
  const int side = std::min(model_->imageSize().width, model_->imageSize().height);
  EXPECT_EQ(reader_.count() > 1, side >= 1000);
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  EXPECT_GE(reader_.read(panorama, 0, warper_, camera_.axisUp()).readings.size(), 3U);
}

INSTANTIATE_TEST_SUITE_P(Cameras, GlanceReaderTest, testing::ValuesIn(setups()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace omnitag
