#include "adjustment/calibration_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "drive.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

class CalibrationDataTest : public testing::Test {
 protected:
  /// The frames with only the readings of `kept` ids.
  std::vector<FrameReadings> only(const std::set<int>& kept) const {
    std::vector<FrameReadings> left = frames;
    for (FrameReadings& frame : left) {
      auto& readings = frame.readings;
      readings.erase(
          std::remove_if(readings.begin(), readings.end(),
                         [&](const auto& reading) { return kept.count(reading.id) == 0; }),
          readings.end());
    }
    return left;
  }

  std::string refusal(const MarkerMap& of_map, const std::vector<FrameReadings>& of_frames) const {
    return test::refusalOf([&] { selectObservations(of_map, of_frames); });
  }

  std::mt19937 generator{7};
  const MarkerMap map = test::roomMap();
  const MountedCamera camera{
      parseCamera(test::catadioptricFile(1195, 250, 250, 0.21, test::kSphere), "truth"),
      test::mounting(1.1, 0.0, 0.0)};
  const std::vector<FrameReadings> frames =
      test::drive(map, camera, test::posesInRoom(12, 2.0, &generator), 0.0, camera.baseFromCamera(),
                  &generator);
};

void expectParts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  }
}

TEST_F(CalibrationDataTest, TakesWhatIsMapped) {
  const CalibrationData data = selectObservations(map, frames, false);
  ASSERT_EQ(data.frames.size(), frames.size());
  EXPECT_TRUE(data.remarks.empty());
  EXPECT_EQ(data.frames[4].observations.size(), frames[4].readings.size());
}

TEST_F(CalibrationDataTest, RefusesWithoutMarkers) {
  expectParts(refusal(map, only({})), {"no marker was read in 12 images"});
}

TEST_F(CalibrationDataTest, RefusesOneMarker) {
  expectParts(refusal(map, only({4})), {"only 1 marker of the map was read", "at least 3"});
}

TEST_F(CalibrationDataTest, RefusesTooFewImages) {
  expectParts(refusal(map, {frames.begin(), frames.begin() + 4}),
              {"4 images of 4 show 3 mapped markers", "drive longer"});
}

TEST_F(CalibrationDataTest, RefusesIdsThatTheMapHasTwice) {
  MarkerMap twice = map;
  for (Marker& marker : twice.markers) marker.id %= 2;
  std::vector<FrameReadings> readings = frames;
  for (FrameReadings& frame : readings) {
    for (MarkerReading& reading : frame.readings) reading.id %= 2;
  }
  expectParts(refusal(twice, readings), {"several markers with id 0, 1", "ids"});
}

TEST_F(CalibrationDataTest, RefusesAnotherMap) {
  MarkerMap other = map;
  for (Marker& marker : other.markers) marker.id += 100;
  expectParts(refusal(other, frames), {"none of the", "is in the map"});
}

TEST_F(CalibrationDataTest, LeavesOutWhatIsAmbiguous) {
  MarkerMap twice = map;
  twice.markers.push_back(map.markers[0]);
  std::vector<FrameReadings> readings = frames;
  readings[2].readings.push_back(readings[2].readings.back());
  const int repeated = readings[2].readings.back().id;
  const CalibrationData data = selectObservations(twice, readings, false);
  for (const CalibrationFrame& frame : data.frames) {
    for (const MarkerObservation& observation : frame.observations) {
      EXPECT_NE(map.markers[observation.map_entry].id, 0);
      if (&frame == &data.frames[2]) {
        EXPECT_NE(map.markers[observation.map_entry].id, repeated);
      }
    }
  }
  EXPECT_EQ(data.remarks.size(), 2U);
}

TEST_F(CalibrationDataTest, PrefersLargeMarkers) {
  std::vector<FrameReadings> readings = frames;
  const auto resize = [](MarkerReading* reading, double edge) {
    const double scale = edge / meanEdge(reading->corners);
    for (Eigen::Vector2d& corner : reading->corners) {
      corner = reading->center + scale * (corner - reading->center);
    }
  };
  for (FrameReadings& frame : readings) {
    ASSERT_GT(frame.readings.size(), 3U);
    for (std::size_t i = 0; i < frame.readings.size(); ++i) {
      resize(&frame.readings[i], i < 3 ? 30.0 : 10.0);
    }
  }
  EXPECT_EQ(selectObservations(map, readings).frames[0].observations.size(), 3U);
  EXPECT_GT(selectObservations(map, readings, false).frames[0].observations.size(), 3U);
  // Without enough large ones, small ones are used.
  for (FrameReadings& frame : readings) resize(&frame.readings[0], 10.0);
  EXPECT_GT(selectObservations(map, readings).frames[0].observations.size(), 3U);
}

}  // namespace
}  // namespace omnitag
