#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "omnitag/localization/localizer.h"
#include "panorama_renderer.h"
#include "sample_markers.h"

namespace omnitag::test {

/// A camera on a robot in a room of markers, whose images are rendered where the robot truly is.
class CameraInRoom : public testing::Test {
 protected:
  CameraInRoom(std::shared_ptr<const CameraModel> model, const Eigen::Isometry3d& mounting,
               MarkerMap map)
      : model_(std::move(model)), camera_(model_, mounting), map_(std::move(map)) {}

  Frame frame(double stamp) const {
    return {stamp, renderPanorama(map_, camera_, truth_), camera_.baseFromCamera(), std::nullopt};
  }

  static std::set<int> acceptedIds(const FrameResult& result) {
    std::set<int> ids;
    for (const MarkerDetection& detection : result.detections) {
      if (detection.accepted) ids.insert(detection.id);
    }
    return ids;
  }

  void expectTruth(const FrameResult& result) const {
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(positionError(result.map_from_base->pose, truth_), 2e-3);
    EXPECT_NEAR(result.map_from_base->pose.yaw, truth_.yaw, 5e-4);
  }

  std::shared_ptr<const CameraModel> model_;
  MountedCamera camera_;
  MarkerMap map_;
  Pose truth_{0.25, 0.22, 0.5};
};

}  // namespace omnitag::test
