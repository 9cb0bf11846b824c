#include "omnitag/localization/localizer_config.h"

#include <string>

#include "common/yaml_reader.h"

namespace omnitag {

namespace {

PoseModel readPoseModel(const YamlReader& reader) {
  const std::string model = reader.text("pose_model");
  if (model != "floor" && model != "free") reader.refuse("pose_model", "floor or free");
  return model == "free" ? PoseModel::kFree : PoseModel::kFloor;
}

}  // namespace

LocalizerConfig readLocalizerConfig(const YamlReader& reader) {
  LocalizerConfig config;
  if (reader.has("visibility")) {
    config.visibility = readVisibilityConfig(reader.mapping("visibility"));
  }
  if (reader.has("view")) config.view = readViewPlannerConfig(reader.mapping("view"));
  if (reader.has("detector")) config.detector = readTagDetectorConfig(reader.mapping("detector"));
  if (reader.has("association")) {
    config.association = readAssociationConfig(reader.mapping("association"));
  }
  if (reader.has("recognition")) {
    config.recognition = readRecognitionConfig(reader.mapping("recognition"));
  }
  if (reader.has("estimation")) {
    config.estimation = readEstimatorConfig(reader.mapping("estimation"));
  }
  if (reader.has("look_around")) {
    config.look_around = readLookAroundConfig(reader.mapping("look_around"));
  }
  if (reader.has("attention")) {
    config.attention = readAttentionConfig(reader.mapping("attention"));
  }
  if (reader.has("evidence")) {
    config.evidence = readEvidenceConfig(reader.mapping("evidence"));
  }
  if (reader.has("relocalization")) {
    config.relocalization = readRelocalizationConfig(reader.mapping("relocalization"));
  }
  if (reader.has("motion")) config.motion = readMotionModelConfig(reader.mapping("motion"));
  if (reader.has("floor")) config.motion.floor = readFloorConfig(reader.mapping("floor"));
  if (reader.has("pose_model")) config.motion.pose_model = readPoseModel(reader);
  config.shutter = readShutterConfig(reader);
  reader.read("threads", &config.threads, {1, 64});
  if (reader.has("estimator")) {
    const std::string estimator = reader.text("estimator");
    if (estimator == "triangulation") {
      config.estimation.kind = EstimatorKind::kTriangulation;
    } else if (estimator == "reprojection") {
      config.estimation.kind = EstimatorKind::kReprojection;
    } else if (estimator == "photometric") {
      config.estimation.kind = EstimatorKind::kPhotometric;
    } else {
      reader.refuse("estimator", "triangulation, reprojection or photometric");
    }
  }
  if (!config.motion.isOnFloor() && config.estimation.kind == EstimatorKind::kTriangulation) {
    // Bearings seen from above determine neither the height nor the lean.
    reader.refuse("estimator", "reprojection or photometric with pose_model: free");
  }
  return config;
}

LocalizerConfig loadLocalizerConfig(const std::string& path) {
  return readLocalizerConfig(YamlReader::fromFile(path));
}

}  // namespace omnitag
