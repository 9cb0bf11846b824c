#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>
#include <string>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"
#include "ros/debug_image.h"
#include "ros/debug_image_layout.h"
#include "ros/frame_markers.h"
#include "ros/map_markers.h"
#include "ros/path_recorder.h"

namespace omnitag {
namespace {

MarkerMap twoMarkers() {
  MarkerMap map;
  map.frame_id = "map";
  for (const double x : {2.0, 3.0}) {
    Marker marker;
    marker.family = "tag36h11";
    marker.id = static_cast<int>(x);
    marker.size = 0.3;
    marker.map_from_marker = Eigen::Translation3d(x, 0.5, 1.0) * uprightOrientation(kPi, 0.0);
    map.markers.push_back(marker);
  }
  map.markers[1].name = "door";
  return map;
}

LocalizedImage localizedImage() {
  LocalizedImage localized;
  localized.input.frame.base_from_camera.translation().z() = 0.8;
  localized.result.map_from_base =
      floorEstimate({1.0, 0.5, 0.0}, Eigen::Vector3d(1e-6, 4e-6, 1e-6).asDiagonal());
  MarkerDetection seen;
  seen.id = 2;
  seen.map_entry = 0;
  seen.accepted = true;
  seen.range = 1.0;
  MarkerDetection wrong;
  wrong.id = 9;
  wrong.reason = "not expected here";
  wrong.bearing = kPi / 2.0;
  wrong.range = std::numeric_limits<double>::quiet_NaN();
  localized.result.detections = {seen, wrong};
  localized.result.predicted.resize(1);
  return localized;
}

std::map<std::string, visualization_msgs::Marker> byNamespace(
    const visualization_msgs::MarkerArray& array) {
  std::map<std::string, visualization_msgs::Marker> markers;
  for (const visualization_msgs::Marker& marker : array.markers) {
    markers.emplace(marker.ns, marker);
  }
  return markers;
}

TEST(FrameMarkers, LinesLeadToTheMarkers) {
  FrameMarkers frame_markers("map", 0.2);
  const auto markers = byNamespace(frame_markers.draw(localizedImage(), twoMarkers()));
  for (const std::string name :
       {"robot", "predicted", "accepted", "rejected", "reasons", "covariance"}) {
    ASSERT_EQ(markers.count(name), 1U) << name;
    EXPECT_EQ(markers.at(name).header.frame_id, "map");
    EXPECT_EQ(markers.at(name).action, visualization_msgs::Marker::ADD);
  }
  const auto& accepted = markers.at("accepted").points;
  ASSERT_EQ(accepted.size(), 2U);
  EXPECT_NEAR(accepted[0].z, 0.8, 1e-12) << "begins at the camera";
  EXPECT_NEAR(accepted[1].x, 2.0, 1e-12);
  EXPECT_NEAR(accepted[1].y, 0.5, 1e-12);
  EXPECT_NEAR(accepted[1].z, 1.0, 1e-12);
  const auto& rejected = markers.at("rejected").points;
  EXPECT_NEAR(rejected[1].x, 1.0, 1e-9);
  EXPECT_GT(rejected[1].y, 1.0) << "to the left";
  EXPECT_NE(markers.at("reasons").text.find("not expected here"), std::string::npos);
}

TEST(FrameMarkers, EllipseHasThreeStandardDeviations) {
  FrameMarkers frame_markers("map", 0.2);
  const auto markers = byNamespace(frame_markers.draw(localizedImage(), twoMarkers()));
  double x = 0.0;
  double y = 0.0;
  for (const geometry_msgs::Point& point : markers.at("covariance").points) {
    x = std::max(x, std::abs(point.x - 1.0));
    y = std::max(y, std::abs(point.y - 0.5));
  }
  EXPECT_NEAR(x, 3e-3, 1e-5);
  EXPECT_NEAR(y, 6e-3, 1e-5);
}

TEST(FrameMarkers, ShowAllPosesWhereSeveralArePossible) {
  FrameMarkers frame_markers("map", 0.2);
  LocalizedImage localized = localizedImage();
  WeightedPose likely{*localized.result.map_from_base, 0.75};
  WeightedPose other = likely;
  other.map_from_base.pose.x = 4.0;
  other.probability = 0.25;
  localized.result.hypotheses = {likely};
  EXPECT_EQ(byNamespace(frame_markers.draw(localized, twoMarkers())).count("hypotheses"), 0U);

  localized.result.hypotheses = {likely, other};
  std::vector<visualization_msgs::Marker> arrows;
  std::vector<std::string> words;
  for (const auto& marker : frame_markers.draw(localized, twoMarkers()).markers) {
    if (marker.ns != "hypotheses") continue;
    if (marker.type == visualization_msgs::Marker::ARROW) arrows.push_back(marker);
    if (!marker.text.empty()) words.push_back(marker.text);
  }
  ASSERT_EQ(arrows.size(), 2U);
  EXPECT_NEAR(arrows[0].pose.position.x, 1.0, 1e-12);
  EXPECT_NEAR(arrows[1].pose.position.x, 4.0, 1e-12);
  EXPECT_GT(arrows[0].color.a, arrows[1].color.a);
  EXPECT_EQ(words, (std::vector<std::string>{"75 %", "25 %"}));
}

TEST(FrameMarkers, RemovesWhatIsGone) {
  FrameMarkers frame_markers("map", 0.2);
  LocalizedImage localized = localizedImage();
  std::set<std::pair<std::string, int>> shown;
  for (const auto& marker : frame_markers.draw(localized, twoMarkers()).markers) {
    shown.emplace(marker.ns, marker.id);
  }
  localized.result.map_from_base.reset();
  for (const auto& marker : frame_markers.draw(localized, twoMarkers()).markers) {
    if (marker.ns == "remark") continue;
    EXPECT_EQ(marker.action, visualization_msgs::Marker::DELETE);
    shown.erase({marker.ns, marker.id});
  }
  EXPECT_TRUE(shown.empty());
  EXPECT_EQ(frame_markers.draw(localized, twoMarkers()).markers.size(), 1U) << "the remark";
}

TEST(FrameMarkers, SayWhyThereIsNoPose) {
  FrameMarkers frame_markers("map", 0.2);
  LocalizedImage localized = localizedImage();
  localized.result.map_from_base.reset();
  localized.result.remark = "no marker of the map was read";
  const auto lost = byNamespace(frame_markers.draw(localized, twoMarkers()));
  ASSERT_EQ(lost.count("remark"), 1U);
  EXPECT_EQ(lost.at("remark").text, "searching: no marker of the map was read");
  EXPECT_NEAR(lost.at("remark").pose.position.x, 2.5, 1e-12) << "in the middle of the map";
  const auto found = byNamespace(frame_markers.draw(localizedImage(), twoMarkers()));
  EXPECT_EQ(found.at("remark").action, visualization_msgs::Marker::DELETE);
}

TEST(MapMarkers, TagsAreWhereTheMapHasThem) {
  const visualization_msgs::MarkerArray array = mapMarkers(twoMarkers(), {}, "map");
  const auto markers = byNamespace(array);
  const visualization_msgs::Marker& tags = markers.at("tags");
  ASSERT_EQ(tags.points.size(), tags.colors.size());
  ASSERT_EQ(tags.points.size() % 3, 0U);
  for (const geometry_msgs::Point& point : tags.points) {
    const double nearer = std::min(std::abs(point.x - 2.0), std::abs(point.x - 3.0));
    EXPECT_LT(nearer, 0.011) << "on the marker's plane, or on its back";
    EXPECT_NEAR(point.y, 0.5, 0.19);
    EXPECT_NEAR(point.z, 1.0, 0.19);
  }
  std::set<std::string> names;
  for (const auto& marker : array.markers) {
    if (marker.ns == "names") names.insert(marker.text);
  }
  EXPECT_EQ(names, (std::set<std::string>{"2", "3  door"}));
}

TEST(MapMarkers, WhatMappingHasFoundHasItsOwnColours) {
  MarkerMap map = twoMarkers();
  ProvisionalMarker used;
  used.estimate.marker = map.markers[1];
  used.is_used = true;
  ProvisionalMarker unsure;
  unsure.estimate.marker = map.markers[0];
  unsure.estimate.marker.id = 40;
  std::map<std::string, std_msgs::ColorRGBA> colors;
  for (const auto& marker : mapMarkers(map, {used, unsure}, "map").markers) {
    if (marker.ns == "names") colors[marker.text] = marker.color;
  }
  ASSERT_EQ(colors.size(), 3U);
  const std_msgs::ColorRGBA& of_file = colors.at("2");
  const std_msgs::ColorRGBA& of_used = colors.at("3  door");
  const std_msgs::ColorRGBA& of_unsure = colors.at("40");
  EXPECT_EQ(of_file.r, of_file.g);
  EXPECT_GT(of_used.g, of_used.r + 0.3);
  EXPECT_GT(of_unsure.r, of_unsure.g + 0.3);
}

TEST(MapDrawing, SmallMovesAddUp) {
  const MarkerMap map = twoMarkers();
  MapDrawing drawing(map, "map");
  ProvisionalMarker found;
  found.estimate.marker = map.markers[0];
  found.estimate.marker.id = 40;
  EXPECT_TRUE(drawing.update(map, {found}));
  EXPECT_FALSE(drawing.update(map, {found}));

  const double start = found.estimate.marker.center().x();
  double drawn = start;
  for (int i = 0; i < 10; ++i) {
    found.estimate.marker.map_from_marker.translation().x() += 0.004;
    if (drawing.update(map, {found})) drawn = found.estimate.marker.center().x();
    EXPECT_LT(found.estimate.marker.center().x() - drawn, 0.01);
  }
  EXPECT_GT(drawn, start + 0.03);
  const geometry_msgs::Point tip = byNamespace(drawing.markers()).at("normals").points.back();
  EXPECT_NEAR(tip.x, drawn - found.estimate.marker.size / 2.0, 1e-9) << "out of the face";

  found.is_used = true;
  EXPECT_TRUE(drawing.update(map, {found}));
  EXPECT_TRUE(drawing.update(map, {}));
}

TEST(DebugImageLayout, CellsAreDistinctAndInOrder) {
  for (const int count : {1, 2, 7, 16, debug_layout::kSlots}) {
    for (const double spread : {2.0 * kPi, 0.5}) {
      std::vector<double> directions;
      for (int i = 0; i < count; ++i) directions.push_back(3.0 + spread * i / count);
      const std::vector<cv::Rect> cells = debug_layout::cellsFor(directions);
      ASSERT_EQ(cells.size(), directions.size());
      double turned = 0.0;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        EXPECT_EQ((cells[i] & debug_layout::middle()).area(), 0);
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(cells[i], cells[j]);
        const auto angle = [](const cv::Rect& cell) {
          const cv::Point2d center =
              cv::Point2d(debug_layout::middle().tl() + debug_layout::middle().br()) / 2.0;
          return std::atan2(cell.y + cell.height / 2.0 - center.y,
                            cell.x + cell.width / 2.0 - center.x);
        };
        const double step = normalizeAngle(angle(cells[(i + 1) % cells.size()]) - angle(cells[i]));
        turned += step < 0.0 ? step + 2.0 * kPi : step;
      }
      EXPECT_NEAR(turned, count > 1 ? 2.0 * kPi : 0.0, 1e-9) << "once round, in order";
    }
  }
}

TEST(DebugImage, PaintsAnyNumberOfViews) {
  const auto camera = parseCamera(
      "model: catadioptric\n"
      "image: {width: 200, height: 160}\n"
      "lens: {fx: 500, fy: 500, cx: 99.5, cy: 79.5}\n"
      "mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21,"
      " rim_radius: 0.0375}\n",
      "camera");
  const DebugImagePainter painter(camera, twoMarkers());
  const cv::Mat panorama(160, 200, CV_8UC1, cv::Scalar(90));
  FrameResult result;
  const cv::Mat empty = painter.paint(panorama, result);
  ASSERT_EQ(empty.type(), CV_8UC3);
  for (int i = 0; i < 30; ++i) {
    View view;
    view.azimuth = 0.2 * i;
    view.distance = 3.0;
    view.focal_length = 100.0;
    view.size = {60, 40};
    result.views.push_back(view);
    result.view_images.emplace_back(40, 60, CV_8UC1, cv::Scalar(120));
    EXPECT_EQ(painter.paint(panorama, result).size(), empty.size());
  }
  result.map_from_base.emplace();
  EXPECT_GT(cv::norm(painter.paint(panorama, result), empty, cv::NORM_L1), 0.0);
}

geometry_msgs::PoseStamped poseAt(double x) {
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "map";
  pose.pose.position.x = x;
  return pose;
}

TEST(PathRecorder, KeepsStepsAndForgetsTheOldest) {
  PathRecorder recorder(0.1, 10);
  EXPECT_TRUE(recorder.add(poseAt(0.0)));
  EXPECT_FALSE(recorder.add(poseAt(0.05)));
  EXPECT_TRUE(recorder.add(poseAt(0.11)));
  EXPECT_EQ(recorder.path().poses.size(), 2U);
  EXPECT_EQ(recorder.path().header.frame_id, "map");
  for (int i = 2; i < 1000; ++i) {
    recorder.add(poseAt(i));
    ASSERT_LE(recorder.path().poses.size(), 10U);
  }
  EXPECT_EQ(recorder.path().poses.back().pose.position.x, 999.0);
  recorder.clear();
  EXPECT_TRUE(recorder.path().poses.empty());
}

TEST(PathRecorder, HoldsOnePoseAtLeast) {
  PathRecorder recorder(0.0, 1);
  EXPECT_TRUE(recorder.add(poseAt(1.0)));
  EXPECT_TRUE(recorder.add(poseAt(2.0)));
  ASSERT_EQ(recorder.path().poses.size(), 1U);
  EXPECT_EQ(recorder.path().poses[0].pose.position.x, 2.0);
}

}  // namespace
}  // namespace omnitag
