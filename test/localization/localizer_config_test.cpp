#include "omnitag/localization/localizer_config.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

LocalizerConfig read(const std::string& text) {
  return readLocalizerConfig(YamlReader::fromText(text, "params.yaml"));
}

TEST(LocalizerConfigTest, AbsentKeysKeepTheirDefaults) {
  const LocalizerConfig defaults;
  const LocalizerConfig config = read("{camera_file: other.yaml}");
  EXPECT_EQ(config.estimation.kind, EstimatorKind::kPhotometric);
  EXPECT_EQ(config.view.oversampling, defaults.view.oversampling);
  EXPECT_EQ(config.detector.min_white_black_diff, defaults.detector.min_white_black_diff);
}

TEST(LocalizerConfigTest, LoadsAFile) {
  const LocalizerConfig config = loadLocalizerConfig(PACKAGE_DIR "/config/localizer.yaml");
  EXPECT_EQ(config.evidence.odds, LocalizerConfig().evidence.odds);
  EXPECT_THROW(loadLocalizerConfig("no_such_file.yaml"), InputError);
}

TEST(LocalizerConfigTest, ReadsEveryGroup) {
  const LocalizerConfig config = read(R"(
estimator: reprojection
visibility: {max_range: 7}
view: {oversampling: 2}
detector: {quad_decimate: 2}
association: {max_roll: 0.2}
recognition: {max_margin: 2, false_accept_rate: 1e-3, min_contrast: 5}
attention: {period: 3, max_pixels: 5000, hidden_way: 0.5, hidden_time: 2}
evidence: {moved: 1e-3, odds: 1000}
estimation: {corner_noise: 0.3, blur: 0.7}
look_around: {step: 0.5}
relocalization: {min_lead: 20}
motion: {acceleration_deviation: 3}
pose_model: free
floor: {lean_deviation: 0.02, height_deviation: 0.01, settling_time: 5}
)");
  EXPECT_EQ(config.motion.pose_model, PoseModel::kFree);
  EXPECT_EQ(config.motion.floor.lean_deviation, 0.02);
  EXPECT_EQ(config.motion.floor.height_deviation, 0.01);
  EXPECT_EQ(config.motion.floor.settling_time, 5.0);
  EXPECT_EQ(config.estimation.kind, EstimatorKind::kReprojection);
  EXPECT_EQ(config.visibility.max_range, 7.0);
  EXPECT_EQ(config.view.oversampling, 2.0);
  EXPECT_EQ(config.detector.quad_decimate, 2.0);
  EXPECT_EQ(config.association.max_roll, 0.2);
  EXPECT_EQ(config.recognition.max_margin, 2.0);
  EXPECT_EQ(config.recognition.false_accept_rate, 1e-3);
  EXPECT_EQ(config.recognition.min_contrast, 5.0);
  EXPECT_EQ(config.attention.period, 3.0);
  EXPECT_EQ(config.attention.max_pixels, 5000);
  EXPECT_EQ(config.attention.hidden_way, 0.5);
  EXPECT_EQ(config.attention.hidden_time, 2.0);
  EXPECT_EQ(config.evidence.moved, 1e-3);
  EXPECT_EQ(config.evidence.odds, 1000.0);
  EXPECT_EQ(config.estimation.reprojection.corner_noise, 0.3);
  EXPECT_EQ(config.estimation.blur, 0.7);
  EXPECT_EQ(config.look_around.step, 0.5);
  EXPECT_EQ(config.relocalization.min_lead, 20.0);
  EXPECT_EQ(config.motion.acceleration_deviation, 3.0);
}

struct BadInput {
  const char* text;
  std::vector<std::string> fragments;
};

TEST(LocalizerConfigTest, RefusesWhatIsWrongAndNamesIt) {
  const std::vector<BadInput> inputs = {
      {"estimator: magic",
       {"params.yaml:1", "estimator", "triangulation, reprojection or photometric", "magic"}},
      {"{estimator: triangulation, pose_model: free}",
       {"params.yaml:1", "estimator", "reprojection or photometric with pose_model: free"}},
      {"visibility: {max_range: -1}", {"visibility.max_range", "> 0", "'-1'"}},
      {"visibility: 7", {"visibility", "mapping", "'7'"}},
      {"view: {oversampling: .nan}", {"view.oversampling", "nan"}},
      {"view: {max_size: 1.5}", {"view.max_size", "integer", "'1.5'"}},
      {"detector: {refine_edges: perhaps}", {"detector.refine_edges", "true or false", "perhaps"}},
      {"association: {max_scale: 0.5}", {"association.max_scale", ">= 1"}},
      {"recognition: {max_margin: -1}", {"recognition.max_margin", ">= 0", "'-1'"}},
      {"recognition: {false_accept_rate: 0}", {"recognition.false_accept_rate", "0.1", "'0'"}},
      {"recognition: {false_accept_rate: 0.5}", {"recognition.false_accept_rate", "'0.5'"}},
      {"recognition: {min_contrast: 0}", {"recognition.min_contrast", "> 0", "'0'"}},
      {"recognition: {period: 0.25}", {"recognition.period", "attention/period"}},
      {"evidence: {moved: 1.5}", {"evidence.moved", "'1.5'"}},
      {"evidence: {odds: 0.5}", {"evidence.odds", "'0.5'"}},
      {"attention: {period: soon}", {"attention.period", "'soon'"}},
      {"attention: {max_pixels: 0}", {"attention.max_pixels", "'0'"}},
      {"recognition: {threshold: 0.5}", {"recognition.threshold", "unknown key"}},
      {"recognition: 3", {"recognition", "mapping", "'3'"}},
      {"estimation: {corner_noise: [1]}", {"estimation.corner_noise", "a list"}},
      {"look_around: {step: 0}", {"look_around.step", "'0'"}},
      {"relocalization: {max_hamming_of_one: 4}", {"relocalization.max_hamming_of_one", "'4'"}},
      {"motion: {speed: 1}", {"motion.speed", "unknown key"}},
  };
  for (const BadInput& input : inputs) {
    try {
      read(input.text);
      ADD_FAILURE() << "accepted: " << input.text;
    } catch (const InputError& error) {
      for (const std::string& fragment : input.fragments) {
        EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos)
            << "'" << fragment << "' not in: " << error.what();
      }
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(LocalizerConfigTest, TellsWhatStandsForSettingsThatAreNoMore) {
  const std::vector<std::pair<std::string, std::string>> replaced = {
      {"estimation: {max_residual: 1.5}", "max_misfit"},
      {"estimation: {robust_width: 0.25}", "robust_misfit"},
      {"estimation: {placement_deviation: 1e-3}", "deviation in the map file"},
      {"relocalization: {corner_noise: 0.1}", "estimation/poor_corner_noise"},
      {"relocalization: {max_residual_of_one: 0.5}", "max_misfit_of_one"}};
  for (const auto& [text, replacement] : replaced) {
    try {
      read(text);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("is no more; use"), std::string::npos)
          << error.what();
      EXPECT_NE(std::string(error.what()).find(replacement), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace omnitag
