#include "omnitag/adjustment/camera_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "../../src/adjustment/perturbed_cameras.h"
#include "drive.h"
#include "omnitag/adjustment/observability.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

const std::string kTrueSphere = test::catadioptricFile(1195, 251.2, 248.4, 0.21, test::kSphere);
const std::string kEquidistant =
    "model: equidistant\nimage: {width: 500, height: 500}\n"
    "lens: {fx: 146, fy: 147, cx: 250, cy: 249}\ndistortion: [-0.01, 0.003, -0.0008, 0.0001]\n"
    "max_angle: 1.66\n";

CalibrationModel modelOf(const std::string& camera, const Eigen::Isometry3d& mounting) {
  return {CameraTemplate::fromText(camera, "camera"), LeaningMounting(mounting)};
}

std::vector<Eigen::Index> allOf(const CalibrationModel& model) {
  std::vector<Eigen::Index> indices;
  for (std::size_t i = 0; i < model.parameters().size(); ++i) {
    indices.push_back(static_cast<Eigen::Index>(i));
  }
  return indices;
}

class PerturbedCamerasTest : public testing::TestWithParam<std::string> {};

TEST_P(PerturbedCamerasTest, DerivativesAreThoseOfTheProjection) {
  const CalibrationModel model = modelOf(GetParam(), test::mounting(1.1, 0.1, -0.05));
  PerturbedCameras cameras(model, model.guess(), allOf(model));
  const std::vector<double> offsets(model.parameters().size(), 0.0);
  ASSERT_TRUE(cameras.moveTo(offsets.data(), true));
  const Eigen::Vector3d point(2.0, 1.5, 0.4);
  const Pose pose{0.2, -0.3, 0.8};
  Eigen::Matrix2Xd by_offsets;
  Eigen::Matrix<double, 2, 3> by_pose;
  ASSERT_TRUE(cameras.project(pose, point, &by_offsets, &by_pose));

  // Five-point differences of the camera that the file describes, with a larger step.
  const auto difference = [](const auto& at, double step) {
    return Eigen::Vector2d((8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) /
                           (12.0 * step));
  };
  for (std::size_t i = 0; i < model.parameters().size(); ++i) {
    const auto at = [&](double offset) {
      Eigen::VectorXd values = model.guess();
      values(static_cast<Eigen::Index>(i)) += offset * model.parameters()[i].scale;
      const MountedCamera camera(model.camera().camera(model.cameraValues(values)),
                                 model.baseFromCamera(values));
      return *camera.pixelFromMap(pose, point);
    };
    const Eigen::Vector2d expected = difference(at, 3e-3);
    EXPECT_LT((by_offsets.col(static_cast<Eigen::Index>(i)) - expected).norm(),
              1e-5 * (1.0 + expected.norm()))
        << model.parameters()[i].name;
  }
  for (int i = 0; i < 3; ++i) {
    const auto at = [&](double offset) {
      const Pose moved{pose.x + (i == 0 ? offset : 0.0), pose.y + (i == 1 ? offset : 0.0),
                       pose.yaw + (i == 2 ? offset : 0.0)};
      return *model.mounted(model.guess()).pixelFromMap(moved, point);
    };
    EXPECT_LT((by_pose.col(i) - difference(at, 1e-3)).norm(), 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, PerturbedCamerasTest, testing::Values(kTrueSphere, kEquidistant));

/// Adjustments of a drive whose truth is known.
class BundleAdjustmentTest : public testing::Test {
 protected:
  void SetUp() override {
    std::mt19937 generator(11);
    poses = test::posesInRoom(15, 2.5, &generator);
    data = selectObservations(
        map, test::drive(map, model.mounted(model.guess()), poses, 0.0, mounting, &generator));
  }

  std::vector<CalibrationFrame> noisy(double noise, std::mt19937* generator) const {
    std::normal_distribution<double> normal(0.0, noise);
    std::vector<CalibrationFrame> frames = data.frames;
    for (CalibrationFrame& frame : frames) {
      for (MarkerObservation& observation : frame.observations) {
        for (Eigen::Vector2d& corner : observation.corners) {
          corner += Eigen::Vector2d(normal(*generator), normal(*generator));
        }
      }
    }
    return frames;
  }

  AdjustmentConfig allBut(const std::string& held) const {
    AdjustmentConfig config;
    for (const Eigen::Index index : allOf(model)) {
      const std::string& name = model.parameters()[static_cast<std::size_t>(index)].name;
      if (name != held && name != "radius_of_curvature") config.free.push_back(index);
    }
    return config;
  }

  const Eigen::Isometry3d mounting = test::mounting(1.1, 0.1, -0.05);
  const MarkerMap map = test::roomMap();
  const CalibrationModel model = modelOf(kTrueSphere, mounting);
  std::vector<Pose> poses;
  CalibrationData data;
};

TEST_F(BundleAdjustmentTest, FindsBackToTheTruth) {
  const BundleAdjustment adjustment(map, data.frames, model);
  CalibrationState start{model.guess(), poses};
  const AdjustmentConfig config = allBut("conic_constant");
  for (const Eigen::Index index : config.free) {
    start.values(index) += 0.3 * model.parameters()[static_cast<std::size_t>(index)].scale;
  }
  for (Pose& pose : start.poses) pose.x += 0.02;
  AdjustmentConfig wide = config;
  wide.robust_width = 30.0;
  const CalibrationState rough = adjustment.minimize(start, wide);
  const CalibrationState found = adjustment.minimize(rough, config);
  for (const Eigen::Index index : config.free) {
    const CalibrationParameter& parameter = model.parameters()[static_cast<std::size_t>(index)];
    EXPECT_NEAR(found.values(index), parameter.value, 1e-3 * parameter.scale) << parameter.name;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(test::positionError(found.poses[i], poses[i]), 1e-5);
  }
}

TEST_F(BundleAdjustmentTest, DeviationsAreThoseOfManyDrives) {
  constexpr double kNoise = 0.05;
  constexpr int kDrives = 30;
  std::mt19937 generator(13);
  AdjustmentConfig config = allBut("conic_constant");
  config.robust_width = 10.0;  // as good as least squares
  Eigen::MatrixXd errors(kDrives, static_cast<Eigen::Index>(config.free.size()));
  Eigen::VectorXd deviations = Eigen::VectorXd::Zero(errors.cols());
  for (int i = 0; i < kDrives; ++i) {
    const std::vector<CalibrationFrame> frames = noisy(kNoise, &generator);
    const BundleAdjustment adjustment(map, frames, model);
    const CalibrationState found = adjustment.minimize({model.guess(), poses}, config);
    const AdjustmentInformation information = adjustment.information(found, config);
    EXPECT_NEAR(information.noise, kNoise, 0.1 * kNoise);
    deviations += uncertaintyOf(model, config.free, information).deviations / kDrives;
    for (Eigen::Index k = 0; k < errors.cols(); ++k) {
      const Eigen::Index index = config.free[static_cast<std::size_t>(k)];
      errors(i, k) = found.values(index) - model.guess()(index);
    }
  }
  // The deviation of 30 samples is itself known to 13 %.
  for (Eigen::Index k = 0; k < errors.cols(); ++k) {
    const double measured = std::sqrt(errors.col(k).squaredNorm() / kDrives);
    const Eigen::Index index = config.free[static_cast<std::size_t>(k)];
    EXPECT_NEAR(deviations(k) / measured, 1.0, 0.4)
        << model.parameters()[static_cast<std::size_t>(index)].name;
  }
}

TEST_F(BundleAdjustmentTest, KnowsWhatACommonErrorDoes) {
  constexpr double kError = 0.02;  // pixels, along the radius
  std::vector<CalibrationFrame> frames = data.frames;
  const Eigen::Vector2d centre(251.2, 248.4);
  for (CalibrationFrame& frame : frames) {
    for (MarkerObservation& observation : frame.observations) {
      for (Eigen::Vector2d& corner : observation.corners) {
        corner += kError * (corner - centre).normalized();
      }
    }
  }
  AdjustmentConfig config = allBut("conic_constant");
  config.robust_width = 10.0;
  const BundleAdjustment truth(map, data.frames, model);
  AdjustmentInformation information = truth.information({model.guess(), poses}, config);
  information.noise = 0.0;
  information.common_error = kError;
  information.common_error_gradient.col(1).setZero();
  const Eigen::VectorXd predicted = uncertaintyOf(model, config.free, information).deviations;

  const BundleAdjustment adjustment(map, frames, model);
  const CalibrationState found = adjustment.minimize({model.guess(), poses}, config);
  for (const char* name : {"fx", "fy", "apex_distance", "z"}) {
    const Eigen::Index index = *model.indexOf(name);
    const auto place = std::find(config.free.begin(), config.free.end(), index);
    const double shift = std::abs(found.values(index) - model.guess()(index));
    EXPECT_NEAR(shift / predicted(place - config.free.begin()), 1.0, 0.1) << name;
  }
}

TEST_F(BundleAdjustmentTest, ACornerFarOffHardlyCounts) {
  std::vector<CalibrationFrame> frames = data.frames;
  frames[3].observations[0].corners[1] += Eigen::Vector2d(20.0, -15.0);
  const BundleAdjustment adjustment(map, frames, model);
  const AdjustmentConfig config = allBut("conic_constant");
  const CalibrationState found = adjustment.minimize({model.guess(), poses}, config);
  const Eigen::Index cx = *model.indexOf("cx");
  EXPECT_NEAR(found.values(cx), model.guess()(cx), 2e-3);
}

TEST_F(BundleAdjustmentTest, HoldsTheMirrorsSizeFirst) {
  const BundleAdjustment adjustment(map, data.frames, model);
  AdjustmentConfig config;
  config.free = allOf(model);
  AdjustmentInformation information = adjustment.information({model.guess(), poses}, config);
  information.noise = 0.5;
  const Observability split = observability(model, config.free, information);
  ASSERT_FALSE(split.held.empty());
  EXPECT_EQ(split.held.front().first, *model.indexOf("radius_of_curvature"));
  for (const char* name : {"fx", "fy", "cx", "cy", "roll", "pitch"}) {
    EXPECT_NE(std::find(split.observed.begin(), split.observed.end(), *model.indexOf(name)),
              split.observed.end())
        << name;
  }
}

}  // namespace
}  // namespace omnitag
