#pragma once

#include <memory>
#include <optional>

#include "camera/shutter.h"
#include "localization/patrol.h"
#include "marker/glance_reader.h"
#include "marker/marker_reader.h"
#include "marker/sharpening.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/disagreement.h"
#include "photometry/blur_filter.h"
#include "photometry/lasting_disagreement.h"

namespace omnitag {

/// What a camera's images have shown of the camera itself and of how they fit the map.
struct ImageKnowledge {
  BlurFilter blur;
  LastingDisagreement disagreement;
  /// s: stamp of the last image.
  std::optional<double> last_stamp;
  /// Whether markers gave the pose of the last image, and the number of images since they did.
  bool was_tracked = false;
  int lost_images = 0;
};

/// One of a localizer's cameras: how its images are read, and what they have shown.
struct CameraState {
  std::shared_ptr<const CameraModel> model;
  ShutterConfig shutter;
  MarkerReader reader;
  GlanceReader glance_reader;
  Patrol patrol;
  ImageKnowledge knowledge;
  /// The last image as decoders read it.
  ReadableImage readable;

  CameraState(std::shared_ptr<const CameraModel> camera, const ShutterConfig& shutter_config,
              const MarkerMap& map, const LocalizerConfig& config)
      : model(std::move(camera)),
        shutter(shutter_config),
        reader(model, kWorkingDistance, config.detector, familiesOf(map), config.threads),
        glance_reader(model, config.detector, reader.detector(), config.threads),
        knowledge{BlurFilter(config.estimation.blur * config.estimation.blur), {}, {}} {}
};

}  // namespace omnitag
