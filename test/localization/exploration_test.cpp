#include "localization/exploration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "localization/look_around.h"
#include "omnitag/localization/localizer.h"
#include "view/view_warper.h"

namespace omnitag {
namespace {

constexpr double kWorkingDistance = 3.0;  // m

double pixelsOf(const std::vector<View>& views) {
  double sum = 0.0;
  for (const View& view : views) sum += view.size.area();
  return sum;
}

class ExplorationTest : public testing::Test {
 protected:
  ExplorationTest() { config_.exploring_views = 2; }

  std::vector<View> next() {
    return exploration_.views(all_, camera_, pose_, warper_.table(), {}, config_);
  }

  bool isFromAll(const View& view) const {
    return std::any_of(all_.begin(), all_.end(), [&](const View& other) {
      return other.azimuth == view.azimuth && other.elevation == view.elevation &&
             other.size == view.size;
    });
  }

  /// Whether one of the views, other than those of everything, shows a whole marker.
  bool isShown(const Marker& marker, const std::vector<View>& views) const {
    const auto reading = test::exactReading(marker, camera_, pose_);
    return std::any_of(views.begin(), views.end(), [&](const View& view) {
      return !isFromAll(view) &&
             std::all_of(reading->corners.begin(), reading->corners.end(),
                         [&](const Eigen::Vector2d& corner) {
                           const auto at = warper_.viewFromPanorama(view, corner);
                           return at && at->x() > 0.0 && at->y() > 0.0 &&
                                  at->x() < view.size.width - 1 && at->y() < view.size.height - 1;
                         });
    });
  }

  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  MountedCamera camera_{model_, test::lookingDown()};
  ViewWarper warper_{model_, kWorkingDistance};
  LocalizerConfig config_;
  Pose pose_{0.3, -0.2, 0.4};
  std::vector<View> all_ = viewsOfEverything(camera_, warper_.table(), config_.look_around);
  Exploration exploration_;
};

TEST_F(ExplorationTest, WithoutSoughtMarkersLooksAtEverythingInTurn) {
  std::set<double> azimuths;
  std::size_t views = 0;
  const std::size_t frames = (all_.size() + 1) / 2 + 1;
  for (std::size_t i = 0; i < frames; ++i) {
    for (const View& view : next()) {
      EXPECT_TRUE(isFromAll(view));
      azimuths.insert(view.azimuth + 10.0 * view.elevation);
      ++views;
    }
  }
  EXPECT_EQ(azimuths.size(), all_.size());
  EXPECT_LE(views, 2 * frames);
}

TEST_F(ExplorationTest, LooksAtAllSoughtMarkersAndGoesOnLookingAtEverything) {
  const std::vector<Marker> markers = test::roomMarkers();
  exploration_.seek(markers);
  std::vector<int> shown(markers.size());
  std::set<double> azimuths;
  constexpr int kFrames = 20;
  double pixels = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const std::vector<View> views = next();
    pixels += pixelsOf(views);
    for (std::size_t m = 0; m < markers.size(); ++m) shown[m] += isShown(markers[m], views) ? 1 : 0;
    for (const View& view : views) {
      if (isFromAll(view)) azimuths.insert(view.azimuth + 10.0 * view.elevation);
    }
  }
  EXPECT_GE(*std::min_element(shown.begin(), shown.end()), 5);
  EXPECT_EQ(azimuths.size(), all_.size());
  // No more than if no marker were sought.
  const double of_everything = pixelsOf(all_) / static_cast<double>(all_.size());
  EXPECT_LE(pixels, (2.0 * kFrames + 1.0) * of_everything);
}

TEST_F(ExplorationTest, AGlanceCostsAView) {
  exploration_.seek(test::roomMarkers());
  constexpr int kFrames = 20;
  for (const int views_per_frame : {1, 2}) {
    config_.exploring_views = views_per_frame;
    int glances = 0;
    double pixels = 0.0;
    for (int i = 0; i < kFrames; ++i) {
      glances += exploration_.wantsGlance(config_) ? 1 : 0;
      pixels += pixelsOf(next());
    }
    EXPECT_EQ(glances, views_per_frame == 1 ? kFrames / 2 : kFrames);
    const double of_everything = pixelsOf(all_) / static_cast<double>(all_.size());
    EXPECT_LE(pixels, (views_per_frame * kFrames - glances + 1.0) * of_everything);
    EXPECT_GE(pixels, (views_per_frame * kFrames - glances - 1.0) * of_everything);
  }
}

TEST_F(ExplorationTest, DoesNotLookAgainWhereAMarkerWasJustRead) {
  const Marker marker = test::roomMarkers().front();
  exploration_.seek({marker});
  const MarkerReading reading = *test::exactReading(marker, camera_, pose_);
  for (const View& view :
       exploration_.views(all_, camera_, pose_, warper_.table(), {reading}, config_)) {
    EXPECT_TRUE(isFromAll(view));
  }
}

TEST_F(ExplorationTest, LeavesRoomForHowFarAMarkerMayBeOff) {
  Marker marker = test::roomMarkers().front();
  marker.deviation = 0.15;
  Marker elsewhere = marker;
  elsewhere.map_from_marker.translation().y() += 0.4;
  exploration_.seek({marker});
  EXPECT_TRUE(isShown(elsewhere, next()));
  marker.deviation = 0.0;
  exploration_.seek({marker});
  EXPECT_FALSE(isShown(elsewhere, next()));
}

TEST_F(ExplorationTest, DoesNotLookWhereAMarkerCannotBeRead) {
  Marker turned_away = test::roomMarkers().front();
  turned_away.map_from_marker.rotate(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY()));
  Marker far = test::roomMarkers().front();
  far.map_from_marker.translation().x() = 40.0;
  exploration_.seek({turned_away, far});
  for (const View& view : next()) EXPECT_TRUE(isFromAll(view));
}

TEST(ExploringLocalizerTest, ReadsMostOfWhatIsLargeAtAGlance) {
  const std::vector<Marker> all = test::roomMarkers();
  MarkerMap map{"map", {all.begin(), all.begin() + 4}};
  map.default_family = "tag36h11";
  LocalizerConfig config;
  config.exploring_views = 1;
  const auto camera = test::sphericalCamera();
  const Eigen::Isometry3d mounting = test::lookingDown();
  const Pose pose{0.3, -0.2, 0.4};
  const cv::Mat image = test::renderPanorama({"map", all}, {camera, mounting}, pose, 2);
  Localizer localizer(camera, map, config);
  localizer.setPose(pose);
  const FrameResult result = localizer.process({0.0, image, mounting, std::nullopt});
  ASSERT_GT(result.acceptedMarkers(), 2);
  EXPECT_GE(result.explored.size(), 5U);
  for (const MarkerReading& reading : result.explored) {
    const auto exact =
        test::exactReading(all[static_cast<std::size_t>(reading.id)], {camera, mounting}, pose);
    EXPECT_LT((reading.center - exact->center).norm(), 0.3) << reading.id;
  }
}

TEST(ExploringLocalizerTest, ReadsASoughtMarkerInTheNextFrame) {
  const std::vector<Marker> all = test::roomMarkers();
  LocalizerConfig config;
  config.exploring_views = 1;
  config.look_around.glance = false;
  const auto camera = test::sphericalCamera();
  const Eigen::Isometry3d mounting = test::lookingDown();
  const Pose pose{0.3, -0.2, 0.4};
  const cv::Mat image = test::renderPanorama({"map", all}, {camera, mounting}, pose, 2);
  for (const Marker& sought : all) {
    MarkerMap map;
    map.default_family = "tag36h11";
    for (const Marker& marker : all) {
      if (marker.id != sought.id) map.markers.push_back(marker);
    }
    Localizer localizer(camera, map, config);
    localizer.setPose(pose);
    localizer.seek({sought});
    const FrameResult result = localizer.process({0.0, image, mounting, std::nullopt});
    EXPECT_TRUE(std::any_of(result.explored.begin(), result.explored.end(),
                            [&](const MarkerReading& reading) { return reading.id == sought.id; }))
        << sought.id;
  }
}

TEST(ExploringLocalizerTest, ADoubtfulLookAllAroundIsNotLostToExploring) {
  const std::vector<Marker> all = test::roomMarkers();
  // Three are known, and one of them is taken down: the other two are too few for an undoubted
  // pose.
  std::vector<Marker> before = all;
  before.push_back(test::wallMarker(40, {-4.0, 3.4, 1.4}, 0.0));
  MarkerMap map{"map", {all[0], all[1], before.back()}};
  map.default_family = "tag36h11";
  LocalizerConfig config;
  config.exploring_views = 1;
  config.look_around.glance = false;
  const auto camera = test::sphericalCamera();
  const Eigen::Isometry3d mounting = test::lookingDown();
  Localizer localizer(camera, map, config);
  const Pose pose{0.3, -0.2, 0.4};
  const auto render = [&](const std::vector<Marker>& seen) {
    return test::renderPanorama({"map", seen}, {camera, mounting}, pose, 2);
  };
  localizer.setPose(pose);
  ASSERT_EQ(localizer.process({0.0, render(before), mounting, std::nullopt}).acceptedMarkers(), 3);
  const FrameResult result = localizer.process({0.1, render(all), mounting, std::nullopt});
  ASSERT_EQ(result.mode, Mode::kTracking);
  ASSERT_EQ(result.acceptedMarkers(), 2);
  // A single view shows at most three of them.
  EXPECT_GE(result.explored.size(), 7U);
}

}  // namespace
}  // namespace omnitag
