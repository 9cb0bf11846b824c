#include "ros/image_localizer.h"

#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "ros/conversions.h"
#include "ros/localizer_settings.h"

namespace omnitag {
namespace {

const std::string kPackage = PACKAGE_DIR;

/// The robot stands among the paper's markers; its initial pose is wrong.
class ImageLocalizerTest : public testing::Test {
 protected:
  ImageLocalizerTest() : transforms_(ros::Duration(10.0)) {
    geometry_msgs::TransformStamped mounting;
    mounting.header.frame_id = "base_link";
    mounting.child_frame_id = "camera";
    mounting.transform = toMessage(base_from_camera_);
    transforms_.setTransform(mounting, "test", true);
  }

  static LocalizerParameters parameters() {
    LocalizerParameters parameters;
    parameters.map_file = kPackage + "/maps/paper.yaml";
    parameters.initial_pose = Pose{3.0, -3.0, 1.0};
    return parameters;
  }

  std::optional<LocalizedImage> localize(double stamp, const cv::Mat& pixels,
                                         std::size_t camera = 0) {
    auto image = boost::make_shared<cv_bridge::CvImage>();
    image->header.frame_id = "camera";
    image->header.stamp = ros::Time(stamp);
    image->image = pixels;
    return localizer_.localize(image, transforms_, {}, camera);
  }

  /// Sends images until the robot is tracked; the last is stamped 100.3 s.
  void follow() {
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(localize(100.0 + 0.1 * i, panorama_));
    ASSERT_EQ(localize(100.3, panorama_)->result.mode, Mode::kTracking);
  }

  Eigen::Isometry3d base_from_camera_ =
      Eigen::Translation3d(0.1, 0.0, 1.1) * Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitX());
  Pose truth_{-2.0, 1.5, 0.7};
  DescribedCamera camera_ = cameraFromFile(kPackage + "/config/cameras/paper.yaml");
  cv::Mat panorama_ = test::renderPanorama(loadMarkerMap(kPackage + "/maps/paper.yaml"),
                                           MountedCamera(camera_.model, base_from_camera_), truth_);
  cv::Mat black_ = cv::Mat::zeros(500, 500, CV_8UC1);
  tf2::BufferCore transforms_;
  ImageLocalizer localizer_{parameters(), {camera_}};
};

TEST_F(ImageLocalizerTest, KeepsThePoseWhereTheClockIsSetBack) {
  for (const double step : {-5.0, -0.25, 60.0}) {
    SCOPED_TRACE(step);
    localizer_ = ImageLocalizer(parameters(), {camera_});
    follow();
    localizer_.clockStepped(step);
    // Without markers, there is only a pose if it was kept.
    const auto localized = localize(100.4 + step, black_);
    ASSERT_TRUE(localized);
    EXPECT_DOUBLE_EQ(localized->clock_step, step);
    EXPECT_EQ(localized->went_back, 0.0);
    EXPECT_EQ(localized->result.mode, Mode::kDeadReckoning);
    ASSERT_TRUE(localized->result.map_from_base);
    EXPECT_LT(std::hypot(localized->result.map_from_base->pose.x - truth_.x,
                         localized->result.map_from_base->pose.y - truth_.y),
              0.01);
    EXPECT_EQ(localize(100.5 + step, panorama_)->result.mode, Mode::kTracking);
  }
}

TEST_F(ImageLocalizerTest, StartsAnewWhereTheStampsAloneGoBack) {
  follow();
  const auto localized = localize(95.4, black_);
  ASSERT_TRUE(localized);
  EXPECT_NEAR(localized->went_back, 4.9, 1e-6);
  ASSERT_TRUE(localized->result.map_from_base);
  EXPECT_DOUBLE_EQ(localized->result.map_from_base->pose.x, 3.0);
}

TEST_F(ImageLocalizerTest, APoseThatIsGivenOutlivesAStartAnew) {
  follow();
  localizer_.beforeNextImage([](Localizer* localizer) { localizer->setPose(Pose{1.0, 2.0, 0.5}); });
  const auto localized = localize(95.4, black_);
  ASSERT_TRUE(localized);
  ASSERT_TRUE(localized->result.map_from_base);
  EXPECT_DOUBLE_EQ(localized->result.map_from_base->pose.x, 1.0);
}

TEST_F(ImageLocalizerTest, CountsImagesThatAreLate) {
  follow();
  EXPECT_FALSE(localize(100.3, panorama_));
  EXPECT_FALSE(localize(99.5, panorama_));
  EXPECT_EQ(localizer_.lateImages(), 2U);
  EXPECT_EQ(localize(100.4, panorama_)->result.mode, Mode::kTracking);
}

TEST_F(ImageLocalizerTest, TakesImagesOfOneCameraThatAnothersOvertook) {
  LocalizerParameters parameters = this->parameters();
  parameters.cameras.resize(2);
  parameters.cameras[0].name = "front";
  parameters.cameras[1].name = "back";
  localizer_ = ImageLocalizer(parameters, {camera_, camera_});
  follow();
  const auto late = [this](double stamp, std::size_t camera) {
    const auto localized = localize(stamp, panorama_, camera);
    EXPECT_TRUE(!localized || localized->result.mode == Mode::kTracking);
    EXPECT_TRUE(!localized || localized->input.frame.stamp == stamp);
    EXPECT_TRUE(!localized || localized->camera_name == (camera == 0 ? "front" : "back"));
    return localized ? (localized->is_newest ? "newest" : "overtaken") : "late";
  };
  EXPECT_STREQ(late(99.7, 1), "late");
  EXPECT_STREQ(late(100.0, 1), "overtaken");
  EXPECT_STREQ(late(100.0, 1), "late");
  EXPECT_STREQ(late(100.3, 1), "overtaken");
  EXPECT_STREQ(late(100.3, 0), "late");
  EXPECT_STREQ(late(100.4, 1), "newest");
  EXPECT_STREQ(late(100.35, 0), "overtaken");
  EXPECT_EQ(localizer_.lateImages(), 3U);
}

TEST_F(ImageLocalizerTest, KeepsThePoseWhereTheClockOfSeveralCamerasIsSetBack) {
  LocalizerParameters parameters = this->parameters();
  parameters.cameras.resize(2);
  parameters.cameras[0].name = "front";
  parameters.cameras[1].name = "back";
  for (const double step : {-5.0, 60.0}) {
    SCOPED_TRACE(step);
    localizer_ = ImageLocalizer(parameters, {camera_, camera_});
    follow();
    ASSERT_TRUE(localize(100.3, panorama_, 1));
    localizer_.clockStepped(step);
    // An image from before, one from after, and one from before that comes last.
    for (const auto& [stamp, camera] :
         {std::pair(100.35, 1), std::pair(100.4 + step, 0), std::pair(100.38, 1),
          std::pair(100.5 + step, 0), std::pair(100.5 + step, 1)}) {
      const auto localized = localize(stamp, panorama_, static_cast<std::size_t>(camera));
      ASSERT_TRUE(localized) << stamp;
      EXPECT_EQ(localized->went_back, 0.0) << stamp;
      EXPECT_EQ(localized->result.mode, Mode::kTracking) << stamp;
    }
  }
}

TEST_F(ImageLocalizerTest, ASuccessorOfOtherSettingsAndAnotherMapKeepsThePose) {
  follow();
  const auto seen = localize(100.4, panorama_)->result;
  std::vector<std::string> names;
  for (const MarkerDetection& detection : seen.detections) {
    if (detection.accepted) names.push_back(localizer_.map().markers[*detection.map_entry].name);
  }
  ASSERT_GE(names.size(), 3U);
  std::shared_ptr<Successor> successor;
  LocalizerSettings settings(parameters(), {camera_.model},
                             [&](std::shared_ptr<Successor> next) { successor = std::move(next); });
  EXPECT_NE(settings.ignore({names[0]}).find("ignored: " + names[0]), std::string::npos);
  settings.tune([](LocalizerConfig* config) { config->threads = 2; });
  EXPECT_NE(settings.editMap([&](MapEditor* map) { return map->remove(MarkerSelection(names[1])); })
                .find("1 removed (" + names[1] + ")"),
            std::string::npos);
  // The last one holds all three changes.
  ASSERT_TRUE(successor);
  EXPECT_EQ(successor->config.threads, 2);
  localizer_.exchange(std::move(*successor));
  const auto then = localize(100.5, panorama_)->result;
  EXPECT_EQ(then.mode, Mode::kTracking);
  EXPECT_EQ(then.acceptedMarkers(), seen.acceptedMarkers() - 2);
  for (const MarkerDetection& detection : then.detections) {
    if (!detection.map_entry) continue;
    const std::string& name = localizer_.map().markers[*detection.map_entry].name;
    EXPECT_NE(name, names[0]);
    EXPECT_NE(name, names[1]);
  }
  ASSERT_EQ(localizer_.ignoredMarkers().size(), 1U);
  EXPECT_EQ(localizer_.ignoredMarkers().front().name, names[0]);
}

TEST_F(ImageLocalizerTest, SettingsThatCannotBeChangeNothing) {
  int handed_over = 0;
  LocalizerSettings settings(parameters(), {camera_.model},
                             [&](const std::shared_ptr<Successor>&) { ++handed_over; });
  EXPECT_THROW(settings.ignore({"nobody"}), InputError);
  std::vector<std::string> all;
  for (const Marker& marker : settings.map().markers) all.push_back(marker.name);
  EXPECT_THROW(settings.ignore(all), InputError);
  EXPECT_THROW(settings.editMap([](MapEditor* map) { return map->change("none.yaml", false); }),
               InputError);
  EXPECT_EQ(settings.editMap([](MapEditor* map) { return map->reload(); }),
            settings.mapFile() + ": nothing changed; 17 markers");
  EXPECT_EQ(handed_over, 0);
}

TEST_F(ImageLocalizerTest, NamesAnIgnoredMarkerThatTheMapDoesNotHave) {
  LocalizerParameters parameters = ImageLocalizerTest::parameters();
  parameters.ignore_markers = {"nobody"};
  try {
    ImageLocalizer localizer(parameters, {camera_});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("ignore_markers"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("nobody"), std::string::npos);
  }
}

}  // namespace
}  // namespace omnitag
