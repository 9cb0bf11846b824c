#include "ros/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ros/xmlrpc_yaml.h"

namespace omnitag {
namespace {

const std::string kManual = PACKAGE_DIR "/config/localizer.yaml";

std::string refusalOf(const YamlReader& reader) {
  try {
    readParameters(reader);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The keys that a mapping may have, as listed when an unknown one is refused.
std::set<std::string> knownKeys(const std::string& text) {
  const std::string refusal = refusalOf(YamlReader::fromText(text, "text"));
  const std::string start = "expected one of: ";
  EXPECT_NE(refusal.find(start), std::string::npos) << refusal;
  std::istringstream list(refusal.substr(refusal.find(start) + start.size()));
  std::set<std::string> keys;
  for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
  return keys;
}

std::set<std::string> keysOf(const YAML::Node& mapping) {
  std::set<std::string> keys;
  for (const auto& entry : mapping) keys.insert(entry.first.as<std::string>());
  return keys;
}

TEST(Parameters, ManualNamesEveryParameter) {
  const YAML::Node manual = YAML::LoadFile(kManual);
  std::set<std::string> expected = knownKeys("no_such_key: 1");
  for (const char* key : {"camera_file", "map_file", "num_worker_threads"}) {
    expected.erase(key);
  }
  EXPECT_EQ(keysOf(manual), expected);
  int groups = 0;
  for (const auto& entry : manual) {
    if (!entry.second.IsMap()) continue;
    ++groups;
    const auto group = entry.first.as<std::string>();
    EXPECT_EQ(keysOf(entry.second), knownKeys(group + ": {no_such_key: 1}")) << group;
  }
  EXPECT_GT(groups, 10);
}

TEST(Parameters, OfSeveralCameras) {
  const LocalizerParameters parameters = readParameters(YamlReader::fromText(R"(
image_transport: compressed
exposure_time: 0.004
cameras:
  - {name: front, camera_file: f.yaml, image: /front/image}
  - {name: back_2, camera_file: b.yaml, image: /back/image, image_transport: raw, frame: back_optical,
     row_readout_time: 2e-5}
)",
                                                                             "text"));
  ASSERT_EQ(parameters.cameras.size(), 2U);
  const CameraParameters& front = parameters.cameras[0];
  EXPECT_EQ(front.name, "front");
  EXPECT_EQ(front.camera_file, "f.yaml");
  EXPECT_EQ(front.image, "/front/image");
  EXPECT_EQ(front.image_transport, "compressed");
  EXPECT_EQ(front.frame, "");
  EXPECT_FALSE(front.shutter);
  const CameraParameters& back = parameters.cameras[1];
  EXPECT_EQ(back.image_transport, "raw");
  EXPECT_EQ(back.frame, "back_optical");
  ASSERT_TRUE(back.shutter);
  EXPECT_EQ(back.shutter->row_readout_time, 2e-5);
  EXPECT_EQ(back.shutter->exposure_time, 0.004);
}

TEST(Parameters, RefuseBadLists) {
  const std::string good = "{name: a, camera_file: a.yaml, image: /a}";
  const auto refusal = [](const std::string& text) {
    return refusalOf(YamlReader::fromText(text, "text"));
  };
  EXPECT_EQ(refusal("cameras: []"), "");
  EXPECT_EQ(refusal("cameras: [" + good + "]"), "");
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"cameras: [" + good + ", " + good + "]", "cameras[1].name"},
      {"cameras: [{name: 1a, camera_file: a.yaml, image: /a}]", "cameras[0].name"},
      {"cameras: [{name: a/b, camera_file: a.yaml, image: /a}]", "cameras[0].name"},
      {"cameras: [{name: a, image: /a}]", "cameras[0].camera_file"},
      {"cameras: [{name: a, camera_file: '', image: /a}]", "cameras[0].camera_file"},
      {"cameras: [{name: a, camera_file: a.yaml}]", "cameras[0].image"},
      {"cameras: [{name: a, camera_file: a.yaml, image: /a, frame: /f}]", "cameras[0].frame"},
      {"cameras: [{name: a, camera_file: a.yaml, image: /a, topic: /a}]", "cameras[0].topic"},
      {"cameras: [{name: a, camera_file: a.yaml, image: /a, exposure_time: -1}]",
       "cameras[0].exposure_time"},
      {"camera_file: c.yaml\ncameras: [" + good + "]", "camera_file"},
      {"cameras: front", "cameras"},
  };
  for (const auto& [text, place] : bad) {
    EXPECT_NE(refusal(text).find(place), std::string::npos) << text << ": " << refusal(text);
  }
}

TEST(Parameters, ManualHasTheDefaults) {
  const LocalizerParameters manual = readParameters(YamlReader::fromFile(kManual));
  const LocalizerParameters defaults;
  EXPECT_EQ(manual.frames.map, defaults.frames.map);
  EXPECT_EQ(manual.frames.odom, defaults.frames.odom);
  EXPECT_EQ(manual.frames.base, defaults.frames.base);
  EXPECT_FALSE(manual.initial_pose);
  EXPECT_EQ(manual.ignore_markers, defaults.ignore_markers);
  EXPECT_EQ(manual.drag_markers, defaults.drag_markers);
  EXPECT_EQ(manual.pose_file, defaults.pose_file);
  EXPECT_EQ(manual.save_pose_period, defaults.save_pose_period);
  EXPECT_EQ(manual.cameras.size(), 1U);
  EXPECT_FALSE(manual.hasCameraList());
  EXPECT_EQ(manual.cameras.front().image_transport, defaults.cameras.front().image_transport);
  EXPECT_EQ(manual.queue_size, defaults.queue_size);
  EXPECT_EQ(manual.publish_tf, defaults.publish_tf);
  EXPECT_EQ(manual.publish_marker_tf, defaults.publish_marker_tf);
  EXPECT_EQ(manual.transform_timeout, defaults.transform_timeout);
  EXPECT_EQ(manual.transform_tolerance, defaults.transform_tolerance);
  EXPECT_EQ(manual.transform_period, defaults.transform_period);
  EXPECT_EQ(manual.restart_time_jump, defaults.restart_time_jump);
  EXPECT_EQ(manual.path_min_step, defaults.path_min_step);
  EXPECT_EQ(manual.path_max_poses, defaults.path_max_poses);
  EXPECT_EQ(manual.robot_radius, defaults.robot_radius);
  EXPECT_EQ(manual.localizer.threads, defaults.localizer.threads);

  const ShutterConfig& shutter = manual.localizer.shutter;
  const ShutterConfig& shutter_default = defaults.localizer.shutter;
  EXPECT_EQ(shutter.image_time_offset, shutter_default.image_time_offset);
  EXPECT_EQ(shutter.row_readout_time, shutter_default.row_readout_time);
  EXPECT_EQ(shutter.exposure_time, shutter_default.exposure_time);

  const VisibilityConfig& visibility = manual.localizer.visibility;
  const VisibilityConfig& visibility_default = defaults.localizer.visibility;
  EXPECT_EQ(visibility.max_range, visibility_default.max_range);
  EXPECT_DOUBLE_EQ(visibility.max_incidence, visibility_default.max_incidence);
  EXPECT_EQ(visibility.min_edge_pixels, visibility_default.min_edge_pixels);
  EXPECT_EQ(visibility.min_decodable_edge_pixels, visibility_default.min_decodable_edge_pixels);
  EXPECT_EQ(visibility.margin_deviations, visibility_default.margin_deviations);
  EXPECT_EQ(visibility.min_margin_pixels, visibility_default.min_margin_pixels);

  const ViewPlannerConfig& view = manual.localizer.view;
  const ViewPlannerConfig& view_default = defaults.localizer.view;
  EXPECT_EQ(view.oversampling, view_default.oversampling);
  EXPECT_EQ(view.max_size, view_default.max_size);
  EXPECT_DOUBLE_EQ(view.max_merged_half_width, view_default.max_merged_half_width);

  const TagDetectorConfig& detector = manual.localizer.detector;
  const TagDetectorConfig& detector_default = defaults.localizer.detector;
  EXPECT_EQ(detector.quad_decimate, detector_default.quad_decimate);
  EXPECT_EQ(detector.quad_sigma, detector_default.quad_sigma);
  EXPECT_EQ(detector.refine_edges, detector_default.refine_edges);
  EXPECT_EQ(detector.decode_sharpening, detector_default.decode_sharpening);
  EXPECT_EQ(detector.min_cluster_pixels, detector_default.min_cluster_pixels);
  EXPECT_EQ(detector.max_nmaxima, detector_default.max_nmaxima);
  EXPECT_EQ(detector.critical_angle, detector_default.critical_angle);
  EXPECT_EQ(detector.max_line_fit_mse, detector_default.max_line_fit_mse);
  EXPECT_EQ(detector.min_white_black_diff, detector_default.min_white_black_diff);
  EXPECT_EQ(detector.deglitch, detector_default.deglitch);
  EXPECT_EQ(detector.max_hamming, detector_default.max_hamming);
  EXPECT_EQ(detector.min_decision_margin, detector_default.min_decision_margin);

  const AssociationConfig& association = manual.localizer.association;
  const AssociationConfig& association_default = defaults.localizer.association;
  EXPECT_EQ(association.max_offset, association_default.max_offset);
  EXPECT_EQ(association.max_scale, association_default.max_scale);
  EXPECT_DOUBLE_EQ(association.max_roll, association_default.max_roll);

  const EstimatorConfig& estimation = manual.localizer.estimation;
  const EstimatorConfig& estimation_default = defaults.localizer.estimation;
  EXPECT_EQ(estimation.kind, estimation_default.kind);
  EXPECT_EQ(estimation.reprojection.corner_noise, estimation_default.reprojection.corner_noise);
  EXPECT_EQ(estimation.reprojection.poor_corner_noise,
            estimation_default.reprojection.poor_corner_noise);
  EXPECT_EQ(estimation.reprojection.robust_misfit, estimation_default.reprojection.robust_misfit);
  EXPECT_EQ(estimation.max_misfit, estimation_default.max_misfit);
  EXPECT_EQ(estimation.blur, estimation_default.blur);
  EXPECT_EQ(estimation.photometric.min_noise, estimation_default.photometric.min_noise);
  EXPECT_EQ(estimation.photometric.alignment_deviation,
            estimation_default.photometric.alignment_deviation);
  EXPECT_EQ(estimation.photometric.max_pixels, estimation_default.photometric.max_pixels);
  EXPECT_EQ(estimation.photometric.max_final_pixels,
            estimation_default.photometric.max_final_pixels);

  const RecognitionConfig& recognition = manual.localizer.recognition;
  const RecognitionConfig& recognition_default = defaults.localizer.recognition;
  EXPECT_EQ(recognition.max_margin, recognition_default.max_margin);
  EXPECT_EQ(recognition.false_accept_rate, recognition_default.false_accept_rate);
  EXPECT_EQ(recognition.min_contrast, recognition_default.min_contrast);

  const AttentionConfig& attention = manual.localizer.attention;
  const AttentionConfig& attention_default = defaults.localizer.attention;
  EXPECT_EQ(attention.period, attention_default.period);
  EXPECT_EQ(attention.max_pixels, attention_default.max_pixels);
  EXPECT_EQ(attention.hidden_way, attention_default.hidden_way);
  EXPECT_EQ(attention.hidden_time, attention_default.hidden_time);

  const EvidenceConfig& evidence = manual.localizer.evidence;
  const EvidenceConfig& evidence_default = defaults.localizer.evidence;
  EXPECT_EQ(evidence.carried, evidence_default.carried);
  EXPECT_EQ(evidence.carried_without_odometry, evidence_default.carried_without_odometry);
  EXPECT_EQ(evidence.misread, evidence_default.misread);
  EXPECT_EQ(evidence.moved, evidence_default.moved);
  EXPECT_EQ(evidence.moved_per_second, evidence_default.moved_per_second);
  EXPECT_EQ(evidence.together, evidence_default.together);
  EXPECT_EQ(evidence.mistaken_start, evidence_default.mistaken_start);
  EXPECT_EQ(evidence.mistaken, evidence_default.mistaken);
  EXPECT_EQ(evidence.missed, evidence_default.missed);
  EXPECT_EQ(evidence.in_place, evidence_default.in_place);
  EXPECT_EQ(evidence.odds, evidence_default.odds);
  EXPECT_EQ(evidence.odds_at_start, evidence_default.odds_at_start);
  EXPECT_EQ(evidence.open_deviation, evidence_default.open_deviation);

  const LookAroundConfig& look_around = manual.localizer.look_around;
  const LookAroundConfig& look_around_default = defaults.localizer.look_around;
  EXPECT_EQ(look_around.glance, look_around_default.glance);
  EXPECT_DOUBLE_EQ(look_around.step, look_around_default.step);
  EXPECT_DOUBLE_EQ(look_around.overlap, look_around_default.overlap);
  EXPECT_EQ(look_around.oversampling, look_around_default.oversampling);
  EXPECT_EQ(look_around.max_size, look_around_default.max_size);

  const RelocalizationConfig& relocalization = manual.localizer.relocalization;
  const RelocalizationConfig& relocalization_default = defaults.localizer.relocalization;
  EXPECT_EQ(relocalization.min_lead, relocalization_default.min_lead);
  EXPECT_EQ(relocalization.max_misfit_of_one, relocalization_default.max_misfit_of_one);
  EXPECT_EQ(relocalization.max_hamming_of_one, relocalization_default.max_hamming_of_one);
  EXPECT_EQ(relocalization.max_deviation_of_one, relocalization_default.max_deviation_of_one);

  const MotionModelConfig& motion = manual.localizer.motion;
  const MotionModelConfig& motion_default = defaults.localizer.motion;
  EXPECT_EQ(motion.pose_model, motion_default.pose_model);
  EXPECT_EQ(motion.floor.lean_deviation, motion_default.floor.lean_deviation);
  EXPECT_EQ(motion.floor.height_deviation, motion_default.floor.height_deviation);
  EXPECT_EQ(motion.floor.settling_time, motion_default.floor.settling_time);
  EXPECT_EQ(motion.acceleration_deviation, motion_default.acceleration_deviation);
  EXPECT_EQ(motion.angular_acceleration_deviation, motion_default.angular_acceleration_deviation);
  EXPECT_EQ(motion.initial_speed_deviation, motion_default.initial_speed_deviation);
  EXPECT_EQ(motion.initial_turn_rate_deviation, motion_default.initial_turn_rate_deviation);
  EXPECT_EQ(motion.odometry_rotation_per_rotation, motion_default.odometry_rotation_per_rotation);
  EXPECT_EQ(motion.odometry_rotation_per_metre, motion_default.odometry_rotation_per_metre);
  EXPECT_EQ(motion.odometry_translation_per_metre, motion_default.odometry_translation_per_metre);
  EXPECT_EQ(motion.odometry_translation_per_rotation,
            motion_default.odometry_translation_per_rotation);
  EXPECT_EQ(motion.initial_position_deviation, motion_default.initial_position_deviation);
  EXPECT_DOUBLE_EQ(motion.initial_heading_deviation, motion_default.initial_heading_deviation);
  EXPECT_DOUBLE_EQ(motion.initial_height_deviation, motion_default.initial_height_deviation);
  EXPECT_EQ(motion.max_dead_reckoning_time, motion_default.max_dead_reckoning_time);
  EXPECT_EQ(motion.max_position_deviation, motion_default.max_position_deviation);
  EXPECT_DOUBLE_EQ(motion.max_heading_deviation, motion_default.max_heading_deviation);
  EXPECT_EQ(motion.max_initial_time, motion_default.max_initial_time);
  EXPECT_EQ(motion.max_initial_position_deviation, motion_default.max_initial_position_deviation);
  EXPECT_DOUBLE_EQ(motion.max_initial_heading_deviation,
                   motion_default.max_initial_heading_deviation);

  EXPECT_EQ(manual.mapping, defaults.mapping);
  EXPECT_EQ(manual.mapper.views_per_frame, defaults.mapper.views_per_frame);
  EXPECT_EQ(manual.mapper.size, defaults.mapper.size);
  EXPECT_EQ(manual.mapper.estimate_sizes, defaults.mapper.estimate_sizes);
  EXPECT_EQ(manual.mapper.corner_noise, defaults.mapper.corner_noise);
  EXPECT_EQ(manual.mapper.max_pose_deviation, defaults.mapper.max_pose_deviation);
  EXPECT_EQ(manual.mapper.max_sightings, defaults.mapper.max_sightings);
  EXPECT_EQ(manual.mapper.min_step, defaults.mapper.min_step);
  EXPECT_EQ(manual.mapper.min_sightings, defaults.mapper.min_sightings);
  EXPECT_DOUBLE_EQ(manual.mapper.min_parallax, defaults.mapper.min_parallax);
  EXPECT_EQ(manual.mapper.min_agreement, defaults.mapper.min_agreement);
  EXPECT_EQ(manual.mapper.max_position_deviation, defaults.mapper.max_position_deviation);
  EXPECT_DOUBLE_EQ(manual.mapper.max_orientation_deviation,
                   defaults.mapper.max_orientation_deviation);
  // Without mapping, markers that the map does not have are not looked for.
  EXPECT_EQ(manual.localizer.exploring_views, 0);
}

TEST(Parameters, InitialPose) {
  const auto read = [](const std::string& text) {
    return readParameters(YamlReader::fromText(text, "text")).initial_pose;
  };
  const std::optional<Pose> pose = read("initial_pose: [1, -2.5, 3]");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->x, 1.0);
  EXPECT_EQ(pose->y, -2.5);
  EXPECT_EQ(pose->yaw, 3.0);
  EXPECT_FALSE(read("initial_pose: []"));
  EXPECT_FALSE(read("queue_size: 3"));
}

TEST(Parameters, RefusesWhatOneKeyDoesNotTake) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"map_fram: map", "map_fram"},
      {"base_frame: ''", "base_frame"},
      {"map_frame: /map", "map_frame"},
      {"initial_pose: [1, 2]", "initial_pose"},
      {"initial_pose: [1, 2, .nan]", "initial_pose"},
      {"initial_pose: [1, 2, east]", "initial_pose"},
      {"initial_pose: 1", "initial_pose"},
      {"queue_size: 0", "queue_size"},
      {"queue_size: 1.5", "queue_size"},
      {"path_max_poses: 0", "path_max_poses"},
      {"robot_radius: 0", "robot_radius"},
      {"threads: 0", "threads"},
      {"estimator: magic", "estimator"},
      {"detector: {max_hamming: 99}", "detector.max_hamming"},
  };
  for (const auto& [text, key] : cases) {
    const std::string refusal = refusalOf(YamlReader::fromText(text, "params.yaml"));
    EXPECT_EQ(refusal.rfind("params.yaml:1: " + key + ": ", 0), 0U) << text << " -> " << refusal;
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
  }
}

/// The manual with another value for one key; `group` is empty for a top-level key.
std::string manualWith(const std::string& group, const std::string& key, const std::string& value) {
  YAML::Node manual = YAML::LoadFile(kManual);
  YAML::Node mapping = group.empty() ? manual : manual[group];
  mapping[key] = YAML::Load(value);
  return YAML::Dump(manual);
}

void expectRefusal(const std::string& group, const std::string& key, const std::string& value) {
  const std::string path = group.empty() ? key : group + "." + key;
  const std::string refusal =
      refusalOf(YamlReader::fromText(manualWith(group, key, value), "params.yaml"));
  // For a list, the item is named.
  const bool is_named = refusal.find(": " + path + ": expected ") != std::string::npos ||
                        refusal.find(": " + path + "[0]: expected ") != std::string::npos;
  EXPECT_TRUE(is_named) << path << ": " << value << " -> " << refusal;
  EXPECT_NE(refusal.find(", found "), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
}

/// Whether the manual gives the key a number, not a word, a list, true or false.
bool isNumber(const YAML::Node& value) {
  double number = 0.0;
  return value.IsScalar() && YAML::convert<double>::decode(value, number);
}

TEST(Parameters, RefusesAWrongValueOfEveryKey) {
  int keys = 0;
  const auto refuseAll = [&keys](const std::string& group, const YAML::Node& mapping) {
    for (const auto& entry : mapping) {
      const auto key = entry.first.as<std::string>();
      if (entry.second.IsMap()) {
        for (const char* wrong : {"7", "word", "[1, 2]", ""}) expectRefusal(group, key, wrong);
        continue;
      }
      ++keys;
      for (const char* wrong : {"{a: 1}", "[[1]]", ""}) expectRefusal(group, key, wrong);
      if (!isNumber(entry.second)) continue;
      for (const char* wrong : {"many", "1,5", ".nan", ".inf", "-.inf", "-1e9", "1e999", "true"}) {
        expectRefusal(group, key, wrong);
      }
    }
  };
  const YAML::Node manual = YAML::LoadFile(kManual);
  refuseAll("", manual);
  for (const auto& entry : manual) {
    if (entry.second.IsMap()) refuseAll(entry.first.as<std::string>(), entry.second);
  }
  EXPECT_GT(keys, 50);
}

TEST(XmlRpcYaml, KeepsValues) {
  XmlRpc::XmlRpcValue tree;
  tree["flag"] = true;
  tree["count"] = 3;
  tree["number"] = 0.1;
  tree["bad"] = std::numeric_limits<double>::quiet_NaN();
  tree["text"] = "odom";
  tree["list"][0] = 1;
  tree["list"][1] = 2.5;
  tree["group"]["inner"] = -1;
  const YamlReader reader(yamlFromXmlRpc(tree, "/localizer"), "/localizer");
  bool flag = false;
  reader.read("flag", &flag);
  EXPECT_TRUE(flag);
  EXPECT_EQ(reader.integer("count"), 3);
  EXPECT_EQ(reader.number("count"), 3.0);
  EXPECT_EQ(reader.number("number"), 0.1);
  EXPECT_EQ(reader.text("text"), "odom");
  EXPECT_EQ(reader.numbers("list", 2), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(reader.mapping("group").integer("inner"), -1);
  EXPECT_THROW(reader.number("bad"), InputError);
}

TEST(XmlRpcYaml, RefusesBinaryData) {
  std::string bytes = "abc";
  XmlRpc::XmlRpcValue tree;
  tree["blob"] = XmlRpc::XmlRpcValue(bytes.data(), static_cast<int>(bytes.size()));
  try {
    yamlFromXmlRpc(tree, "/localizer");
    FAIL() << "binary data was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/localizer/blob"), std::string::npos);
  }
}

}  // namespace
}  // namespace omnitag
