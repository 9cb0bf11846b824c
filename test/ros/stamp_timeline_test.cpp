#include "ros/stamp_timeline.h"

#include <gtest/gtest.h>

#include "ros/clock_watch.h"

namespace omnitag {
namespace {

constexpr double kRestartJump = 1.0;  // s
constexpr double kPeriod = 0.1;       // s, between images

/// Images as a camera stamps them, one per period.
class StampTimelineTest : public testing::Test {
 protected:
  /// The next image; the camera's clock was set by `step` since the one before.
  StampPlace next(double step = 0.0) {
    clock_ += kPeriod + step;
    return at(clock_);
  }

  StampPlace at(double stamp) {
    const ros::Time time(stamp);
    const StampPlace place = timeline_.place(time);
    if (place.kind != StampPlace::Kind::kLate) timeline_.take(time, place);
    return place;
  }

  StampTimeline timeline_{kRestartJump};
  double clock_ = 1e6;
};

TEST_F(StampTimelineTest, RunsWithTheStamps) {
  EXPECT_DOUBLE_EQ(next().time, 1e6 + 0.1);
  for (int i = 2; i < 5; ++i) {
    const StampPlace place = next();
    EXPECT_EQ(place.kind, StampPlace::Kind::kLater);
    EXPECT_NEAR(place.time, 1e6 + kPeriod * i, 1e-6);
  }
}

TEST_F(StampTimelineTest, GoesOnWhereTheClockIsSet) {
  for (const double step : {-5.0, -0.3, -0.11, 0.7, 3600.0, -86400.0}) {
    const double before = next().time;
    timeline_.clockStepped(step);
    const StampPlace place = next(step);
    EXPECT_EQ(place.kind, StampPlace::Kind::kClockStepped) << step;
    EXPECT_DOUBLE_EQ(place.step, step);
    EXPECT_NEAR(place.time - before, kPeriod, 1e-6) << step;
    EXPECT_EQ(next().kind, StampPlace::Kind::kLater) << step;
  }
}

TEST_F(StampTimelineTest, AClockThatWasSetAndSetBackChangesNothing) {
  next();
  timeline_.clockStepped(-600.0);
  timeline_.clockStepped(600.0 + 1e-7);
  EXPECT_EQ(next().kind, StampPlace::Kind::kLater);
}

TEST_F(StampTimelineTest, ImagesOnTheirWayHaveStampsFromBeforeTheClockWasSet) {
  const double before = next().time;
  timeline_.clockStepped(-5.0);
  for (int i = 1; i < 4; ++i) {
    const StampPlace place = next();
    EXPECT_EQ(place.kind, StampPlace::Kind::kLater);
    EXPECT_NEAR(place.time - before, kPeriod * i, 1e-6);
  }
  EXPECT_EQ(next(-5.0).kind, StampPlace::Kind::kClockStepped);
}

TEST_F(StampTimelineTest, AClockThatStampsNoImageIsForgotten) {
  next();
  timeline_.clockStepped(-5.0);
  for (int i = 0; i < 110; ++i) EXPECT_EQ(next().kind, StampPlace::Kind::kLater);
  EXPECT_EQ(next(-5.0).kind, StampPlace::Kind::kWentBack);
}

TEST_F(StampTimelineTest, StampsThatGoBackAloneBeginAgain) {
  next();
  const StampPlace place = next(-20.0);
  EXPECT_EQ(place.kind, StampPlace::Kind::kWentBack);
  EXPECT_NEAR(place.step, kPeriod - 20.0, 1e-6);
  EXPECT_EQ(next().kind, StampPlace::Kind::kLater);
}

TEST_F(StampTimelineTest, AnImageThatWasOvertakenIsLate) {
  const double before = next().time;
  EXPECT_EQ(at(clock_).kind, StampPlace::Kind::kLate);
  EXPECT_EQ(at(clock_ - 0.9).kind, StampPlace::Kind::kLate);
  EXPECT_NEAR(next().time - before, kPeriod, 1e-6);
}

TEST(ClockWatchTest, ReadsAgainWhereItWasInterrupted) {
  int reads = 0;
  const ClockReading reading = readClocks([&reads] {
    const double start = steadyTime();
    while (reads == 0 && steadyTime() < start + 0.02) {
    }
    ++reads;
    return steadyTime() + 1000.0;
  });
  EXPECT_GE(reads, 2);
  EXPECT_NEAR(reading.clock - reading.steady, 1000.0, 1e-3);
}

TEST(ClockWatchTest, NoticesAClockThatIsSetAndNotOneThatIsAdjusted) {
  ClockWatch watch;
  EXPECT_EQ(watch.step(1e9, 50.0), 0.0);
  EXPECT_EQ(watch.step(1e9 + 1.0005, 51.0), 0.0);
  EXPECT_NEAR(watch.step(1e9 - 4.0, 52.0), -6.0, 1e-3);
  EXPECT_EQ(watch.step(1e9 - 3.0, 53.0), 0.0);
  EXPECT_NEAR(watch.step(1e9 + 98.0, 54.0), 100.0, 1e-3);
}

}  // namespace
}  // namespace omnitag
