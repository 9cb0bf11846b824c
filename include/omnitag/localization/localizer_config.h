#pragma once

#include <string>

#include "omnitag/camera/shutter_config.h"
#include "omnitag/localization/attention_config.h"
#include "omnitag/localization/estimator_config.h"
#include "omnitag/localization/evidence_config.h"
#include "omnitag/localization/look_around_config.h"
#include "omnitag/localization/motion_model_config.h"
#include "omnitag/localization/relocalization_config.h"
#include "omnitag/marker/association_config.h"
#include "omnitag/marker/tag_detector_config.h"
#include "omnitag/marker/visibility_config.h"
#include "omnitag/photometry/recognition_config.h"
#include "omnitag/view/view_planner_config.h"

namespace omnitag {

class YamlReader;

/// Every setting of the localizer; config/localizer.yaml is their manual.
struct LocalizerConfig {
  VisibilityConfig visibility;
  ViewPlannerConfig view;
  TagDetectorConfig detector;
  AssociationConfig association;
  RecognitionConfig recognition;
  EstimatorConfig estimation;
  LookAroundConfig look_around;
  AttentionConfig attention;
  EvidenceConfig evidence;
  RelocalizationConfig relocalization;
  MotionModelConfig motion;
  ShutterConfig shutter;
  /// How many cores a frame may use at once. One leaves the others to the robot's other nodes; more
  /// speed up searches and frames with many markers.
  int threads = 1;
  /// How much of each frame is searched for markers that the map does not have, in units of one of
  /// the views that together show all of the panorama (see Exploration); while searching for the
  /// pose, all of them are. 0: the map is complete.
  int exploring_views = 0;
};

/// Reads the groups `visibility`, `view`, `detector`, `association`, `recognition`, `estimation`,
/// `look_around`, `attention`, `evidence`, `relocalization`, `motion` and `floor`, and the keys
/// `threads`, `pose_model` (floor | free), `estimator` (triangulation | reprojection | photometric)
/// and those of ShutterConfig. Absent keys keep their defaults; other top-level keys are ignored.
/// Throws InputError.
LocalizerConfig readLocalizerConfig(const YamlReader& reader);

/// The same from a file such as config/localizer.yaml.
LocalizerConfig loadLocalizerConfig(const std::string& path);

}  // namespace omnitag
