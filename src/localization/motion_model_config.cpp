#include "omnitag/localization/motion_model_config.h"

#include "common/yaml_reader.h"

namespace omnitag {

FloorConfig readFloorConfig(const YamlReader& reader) {
  reader.allowOnly({"lean_deviation", "height_deviation", "settling_time"});
  FloorConfig config;
  reader.read("lean_deviation", &config.lean_deviation, {0.0, 0.5});
  reader.read("height_deviation", &config.height_deviation, kNonNegative);
  reader.read("settling_time", &config.settling_time, kPositive);
  return config;
}

MotionModelConfig readMotionModelConfig(const YamlReader& reader) {
  reader.allowOnly({"acceleration_deviation", "angular_acceleration_deviation",
                    "initial_speed_deviation", "initial_turn_rate_deviation",
                    "odometry_rotation_per_rotation", "odometry_rotation_per_metre",
                    "odometry_translation_per_metre", "odometry_translation_per_rotation",
                    "initial_position_deviation", "initial_heading_deviation",
                    "initial_height_deviation", "max_dead_reckoning_time", "max_position_deviation",
                    "max_heading_deviation", "max_initial_time", "max_initial_position_deviation",
                    "max_initial_heading_deviation"});
  MotionModelConfig config;
  reader.read("acceleration_deviation", &config.acceleration_deviation, kPositive);
  reader.read("angular_acceleration_deviation", &config.angular_acceleration_deviation, kPositive);
  reader.read("initial_speed_deviation", &config.initial_speed_deviation, kPositive);
  reader.read("initial_turn_rate_deviation", &config.initial_turn_rate_deviation, kPositive);
  reader.read("odometry_rotation_per_rotation", &config.odometry_rotation_per_rotation,
              kNonNegative);
  reader.read("odometry_rotation_per_metre", &config.odometry_rotation_per_metre, kNonNegative);
  reader.read("odometry_translation_per_metre", &config.odometry_translation_per_metre,
              kNonNegative);
  reader.read("odometry_translation_per_rotation", &config.odometry_translation_per_rotation,
              kNonNegative);
  reader.read("initial_position_deviation", &config.initial_position_deviation, kPositive);
  reader.read("initial_heading_deviation", &config.initial_heading_deviation, kPositive);
  reader.read("initial_height_deviation", &config.initial_height_deviation, kPositive);
  reader.read("max_dead_reckoning_time", &config.max_dead_reckoning_time, kNonNegative);
  reader.read("max_position_deviation", &config.max_position_deviation, kPositive);
  reader.read("max_heading_deviation", &config.max_heading_deviation, kPositive);
  reader.read("max_initial_time", &config.max_initial_time, kNonNegative);
  reader.read("max_initial_position_deviation", &config.max_initial_position_deviation, kPositive);
  reader.read("max_initial_heading_deviation", &config.max_initial_heading_deviation, kPositive);
  return config;
}

}  // namespace omnitag
