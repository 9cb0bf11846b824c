#include "omnitag/ros/health_monitor.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <optional>
#include <string>

namespace omnitag {
namespace {

using diagnostic_msgs::DiagnosticStatus;

MarkerMap oneMarker() {
  MarkerMap map;
  map.frame_id = "map";
  map.markers.resize(1);
  map.markers[0].id = 7;
  return map;
}

class HealthMonitorTest : public testing::Test {
 protected:
  HealthMonitorTest()
      : private_node_("~"),
        input_(node_, private_node_, "raw", 1),
        monitor_(node_, private_node_, input_, oneMarker()),
        subscriber_(node_.subscribe("/diagnostics", 10, &HealthMonitorTest::onReports, this)) {}

  /// What is reported of the marker map from now on.
  DiagnosticStatus nextReportOfMap() {
    constexpr double kWait = 0.1;  // s
    // A report that is under way may tell of what was before.
    for (int i = 0; i < 2; ++i) {
      of_map_.reset();
      while (!of_map_) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kWait));
    }
    return *of_map_;
  }

  void onReports(const diagnostic_msgs::DiagnosticArray& reports) {
    for (const DiagnosticStatus& status : reports.status) {
      if (status.name.find(": marker map") != std::string::npos) of_map_ = status;
    }
  }

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  ImageInput input_;
  HealthMonitor monitor_;
  std::optional<DiagnosticStatus> of_map_;
  ros::Subscriber subscriber_;
};

TEST_F(HealthMonitorTest, ForgetsDisplacedMarkersWhereTheLocalizerStartsAnew) {
  FrameResult displaced;
  displaced.displaced = {{0, 0.4}};
  for (int i = 0; i < 3; ++i) monitor_.localized(LocalizationStatus(), displaced, "");
  const DiagnosticStatus before = nextReportOfMap();
  EXPECT_EQ(before.level, DiagnosticStatus::WARN);
  EXPECT_EQ(before.message, "marker 7 is 0.40 m from where the map has it");

  monitor_.startedAnew();
  monitor_.localized(LocalizationStatus(), FrameResult(), "");
  EXPECT_EQ(nextReportOfMap().level, DiagnosticStatus::OK);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "health_monitor_test");
  return RUN_ALL_TESTS();
}
