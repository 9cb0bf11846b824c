#include "ros/live_tuning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

dynamic_reconfigure::Config config(const std::string& name, double value) {
  dynamic_reconfigure::Config message;
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = name;
  parameter.value = value;
  message.doubles.push_back(parameter);
  return message;
}

TEST(LiveTuningTest, EveryKnobTurnsSomethingOfItsOwn) {
  const std::vector<Knob> all = knobs();
  std::set<std::string> names;
  for (const Knob& knob : all) {
    EXPECT_TRUE(names.insert(knob.name).second) << knob.name;
    EXPECT_FALSE(knob.description.empty()) << knob.name;
    const Tunables before;
    EXPECT_GE(knob.get(before), knob.min) << knob.name;
    EXPECT_LE(knob.get(before), knob.max) << knob.name;
    Tunables after = before;
    knob.set(&after, knob.get(before) == knob.max ? knob.min : knob.max);
    for (const Knob& other : all) {
      EXPECT_EQ(other.get(after) != other.get(before), other.name == knob.name)
          << knob.name << ' ' << other.name;
    }
  }
}

TEST(LiveTuningTest, TakesValuesWithinTheirLimits) {
  const std::vector<Knob> all = knobs();
  EXPECT_EQ(withChanges(all, {}, config("exposure_time", 0.02)).config.shutter.exposure_time, 0.02);
  EXPECT_EQ(withChanges(all, {}, config("exposure_time", 5.0)).config.shutter.exposure_time, 1.0);
  const Tunables tuned = withChanges(all, {}, config("max_misfit", 5.5));
  EXPECT_EQ(withChanges(all, tuned, toMessage(all, tuned)).config.estimation.max_misfit, 5.5);
}

TEST(LiveTuningTest, RefusesWhatThereIsNot) {
  const std::vector<Knob> all = knobs();
  EXPECT_THROW(withChanges(all, {}, config("exposure", 0.02)), InputError);
  // A value of another type.
  EXPECT_THROW(withChanges(all, {}, config("threads", 2.0)), InputError);
  EXPECT_THROW(withChanges(all, {}, config("exposure_time", std::nan(""))), InputError);
  dynamic_reconfigure::Config estimator;
  estimator.strs.resize(1);
  estimator.strs[0].name = "estimator";
  estimator.strs[0].value = "guess";
  EXPECT_THROW(withChanges(all, {}, estimator), InputError);
  Tunables free;
  free.config.motion.pose_model = PoseModel::kFree;
  estimator.strs[0].value = "triangulation";
  EXPECT_THROW(withChanges(all, free, estimator), InputError);
}

}  // namespace
}  // namespace omnitag
