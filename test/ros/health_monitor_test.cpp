#include "ros/health_monitor.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <map>
#include <string>

namespace omnitag {
namespace {

using diagnostic_msgs::DiagnosticStatus;

MarkerMap threeMarkers() {
  MarkerMap map;
  map.frame_id = "map";
  map.markers.resize(3);
  for (int i = 0; i < 3; ++i) {
    map.markers[i].family = "tag36h11";
    map.markers[i].id = 7 + i;
  }
  return map;
}

class HealthMonitorTest : public testing::Test {
 protected:
  HealthMonitorTest()
      : private_node_("~"),
        input_(node_, private_node_, {{}}, 1),
        monitor_(node_, private_node_, input_, threeMarkers()),
        subscriber_(node_.subscribe("/diagnostics", 10, &HealthMonitorTest::onReports, this)) {}

  /// The next report of a task, given by the end of its name.
  DiagnosticStatus nextReport(const std::string& task) {
    constexpr double kWait = 0.1;  // s
    // A report on its way may describe the state before.
    for (int i = 0; i < 2; ++i) {
      reports_.clear();
      while (reports_.count(task) == 0) {
        ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kWait));
      }
    }
    return reports_[task];
  }

  void onReports(const diagnostic_msgs::DiagnosticArray& reports) {
    for (const DiagnosticStatus& status : reports.status) {
      reports_[status.name.substr(status.name.rfind(": ") + 2)] = status;
    }
  }

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  ImageInput input_;
  HealthMonitor monitor_;
  std::map<std::string, DiagnosticStatus> reports_;
  ros::Subscriber subscriber_;
};

TEST_F(HealthMonitorTest, ForgetsDisplacedMarkersWhereTheLocalizerStartsAnew) {
  FrameResult displaced;
  displaced.displaced = {{0, 0.4}};
  for (int i = 0; i < 3; ++i) monitor_.localized(LocalizationStatus(), displaced, "");
  const DiagnosticStatus before = nextReport("marker map");
  EXPECT_EQ(before.level, DiagnosticStatus::WARN);
  EXPECT_EQ(before.message, "marker tag36h11:7 is 0.40 m from where the map has it");

  monitor_.startedAnew();
  monitor_.localized(LocalizationStatus(), FrameResult(), "");
  EXPECT_EQ(nextReport("marker map").level, DiagnosticStatus::OK);
}

TEST_F(HealthMonitorTest, MarkersThatWereMovedAsOneAreToldAsOne) {
  FrameResult result;
  result.displaced = {{0, 0.4}, {1, 0.5}, {2, 0.4}};
  result.displaced_groups = {{{0, 2}, {0.4, -0.12, 0.0}, 0.1}};
  for (int i = 0; i < 3; ++i) monitor_.localized(LocalizationStatus(), result, "");
  EXPECT_EQ(
      nextReport("marker map").message,
      "markers tag36h11:7, tag36h11:9 were moved as one, by (0.40, -0.12, 0.00) m and 5.73 deg; "
      "marker tag36h11:8 is 0.50 m from where the map has it");
}

TEST_F(HealthMonitorTest, OneCameraDoesNotSettleWhatAnotherLacks) {
  LocalizationStatus front;
  front.camera = "front";
  monitor_.imageCame(0);
  monitor_.transformMissing("no transform from 'back_optical'", "back");
  monitor_.localized(front, FrameResult(), "");
  const DiagnosticStatus missing = nextReport("transforms");
  EXPECT_EQ(missing.level, DiagnosticStatus::ERROR);
  EXPECT_NE(missing.message.find("back: waiting for tf"), std::string::npos) << missing.message;
  LocalizationStatus back;
  back.camera = "back";
  back.advice = {"focus the lens"};
  back.has_pose = 1;
  FrameResult found;
  found.map_from_base.emplace();
  monitor_.localized(back, found, "");
  front.has_pose = 1;
  front.mode = LocalizationStatus::TRACKING;
  monitor_.localized(front, found, "");
  EXPECT_EQ(nextReport("transforms").level, DiagnosticStatus::OK);
  EXPECT_NE(nextReport("localization").message.find("back: focus the lens"), std::string::npos);
}

TEST_F(HealthMonitorTest, WarnsOfImagesThatAreLateWhileTheyAre) {
  monitor_.localized(LocalizationStatus(), FrameResult(), "");
  nextReport("images");
  monitor_.imageLate();
  reports_.clear();
  while (reports_.count("images") == 0) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  }
  const DiagnosticStatus late = reports_["images"];
  EXPECT_EQ(late.level, DiagnosticStatus::WARN);
  EXPECT_NE(late.message.find("their stamps are not after"), std::string::npos);
  // Images continue; otherwise they would soon count as gone.
  monitor_.localized(LocalizationStatus(), FrameResult(), "");
  EXPECT_EQ(nextReport("images").level, DiagnosticStatus::OK);
}

TEST_F(HealthMonitorTest, AnotherParentInTfIsAnError) {
  monitor_.localized(LocalizationStatus(), FrameResult(), "");
  monitor_.parentChecked("set odom_frame");
  const DiagnosticStatus report = nextReport("transforms");
  EXPECT_EQ(report.level, DiagnosticStatus::ERROR);
  EXPECT_EQ(report.message, "set odom_frame");
  monitor_.parentChecked("");
  EXPECT_EQ(nextReport("transforms").level, DiagnosticStatus::OK);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "health_monitor_test");
  return RUN_ALL_TESTS();
}
