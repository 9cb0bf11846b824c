#include "adjustment/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "../support/sweep.h"
#include "adjustment/observability.h"
#include "adjustment/perturbed_cameras.h"
#include "drive.h"
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
  const Eigen::Isometry3d mounting = test::mounting(1.1, 0.1, -0.05);
  const CalibrationModel model = modelOf(GetParam(), mounting);
  PerturbedCameras cameras(model, model.guess(), allOf(model));
  const std::vector<double> offsets(model.parameters().size(), 0.0);
  ASSERT_TRUE(cameras.moveTo(offsets.data(), true));
  const Eigen::Vector3d point(2.0, 1.5, 0.4);
  const Pose pose{0.2, -0.3, 0.8, 0.02, 0.05, -0.03};
  PixelDerivatives found;
  ASSERT_TRUE(cameras.project(pose.toIsometry(), mounting, point, &found));

  // Five-point differences of the camera in the file, with a larger step.
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
    EXPECT_LT((found.by_offsets.col(static_cast<Eigen::Index>(i)) - expected).norm(),
              1e-5 * (1.0 + expected.norm()))
        << model.parameters()[i].name;
  }
  for (int i = 0; i < 6; ++i) {
    const auto at = [&](double offset) {
      return *model.mounted(model.guess())
                  .pixelFromMap(moved(pose, offset * PoseVector::Unit(i)), point);
    };
    EXPECT_LT((found.by_pose.col(i) - difference(at, 1e-3)).norm(), 1e-4) << i;
  }
  for (int i = 0; i < 3; ++i) {
    const auto at = [&](double offset) {
      return *model.mounted(model.guess())
                  .pixelFromMap(pose, point + offset * Eigen::Vector3d::Unit(i));
    };
    EXPECT_LT((found.by_point.col(i) - difference(at, 1e-3)).norm(), 1e-4) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, PerturbedCamerasTest, testing::Values(kTrueSphere, kEquidistant));

/// Adjustments of a drive whose truth is known.
class BundleAdjustmentTest : public testing::Test {
 protected:
  static constexpr double kExactly = 10.0;  // pixels: as good as least squares

  void SetUp() override {
    truth.model = std::make_shared<CalibrationModel>(modelOf(kTrueSphere, mounting));
    truth.values = truth.model->guess();
    for (const Marker& marker : test::roomMap().markers) {
      truth.landmarks.push_back({marker, PlacePrior::exact(marker), false});
    }
    const MountedCamera camera = truth.model->mounted(truth.values);
    for (const Pose& pose : test::posesInRoom(15, 2.5, &generator)) {
      for (std::size_t i = 0; i < truth.landmarks.size(); ++i) {
        const auto reading = test::exactReading(truth.landmarks[i].marker, camera, pose);
        if (!reading) continue;
        truth.observations.push_back({truth.frames.size(), i, stacked(reading->corners)});
      }
      truth.frames.push_back({mounting, pose, false, 0.0});
    }
  }

  Bundle noisy(double noise) {
    std::normal_distribution<double> normal(0.0, noise);
    Bundle bundle = truth;
    for (Bundle::Observation& observation : bundle.observations) {
      for (Eigen::Index i = 0; i < 8; ++i) observation.pixels(i) += normal(generator);
    }
    return bundle;
  }

  /// All of the camera's parameters except those of a sphere that images hardly determine.
  BundleConfig freeCamera(double noise) const {
    BundleConfig config;
    config.noise = noise;
    for (const Eigen::Index index : allOf(*truth.model)) {
      const std::string& name = parameter(index).name;
      if (name != "conic_constant" && name != "radius_of_curvature") config.free.push_back(index);
    }
    return config;
  }

  const CalibrationParameter& parameter(Eigen::Index index) const {
    return truth.model->parameters()[static_cast<std::size_t>(index)];
  }

  /// Moves each marker at random by these deviations, which become its prior's.
  void disturbMap(double deviation, double orientation_deviation, Bundle* bundle) {
    std::normal_distribution<double> normal(0.0, 1.0);
    for (Bundle::Landmark& landmark : bundle->landmarks) {
      MarkerIncrement increment;
      for (Eigen::Index i = 0; i < 6; ++i) {
        increment(i) = (i < 3 ? deviation : orientation_deviation) * normal(generator);
      }
      landmark.marker.map_from_marker = moved(landmark.marker.map_from_marker, increment);
      landmark.marker.deviation = deviation;
      landmark.marker.orientation_deviation = orientation_deviation;
      landmark.prior = PlacePrior::surveyed(landmark.marker);
    }
  }

  std::mt19937 generator{11};
  const Eigen::Isometry3d mounting = test::mounting(1.1, 0.1, -0.05);
  Bundle truth;
};

TEST_F(BundleAdjustmentTest, FindsBackToTheTruth) {
  Bundle bundle = truth;
  const BundleConfig config = freeCamera(0.1);
  for (const Eigen::Index index : config.free) bundle.values(index) += 0.3 * parameter(index).scale;
  for (Bundle::Frame& frame : bundle.frames) frame.map_from_base.x += 0.02;
  ASSERT_TRUE(adjust(&bundle, freeCamera(kExactly)));
  ASSERT_TRUE(adjust(&bundle, config));
  for (const Eigen::Index index : config.free) {
    EXPECT_NEAR(bundle.values(index), parameter(index).value, 1e-3 * parameter(index).scale)
        << parameter(index).name;
  }
  for (std::size_t i = 0; i < truth.frames.size(); ++i) {
    EXPECT_LT(test::positionError(bundle.frames[i].map_from_base, truth.frames[i].map_from_base),
              1e-5);
  }
}

TEST_F(BundleAdjustmentTest, DeviationsAreThoseOfManyDrives) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  constexpr double kNoise = 0.05;
  constexpr int kDrives = 30;
  const BundleConfig config = freeCamera(kNoise);
  Eigen::MatrixXd errors(kDrives, static_cast<Eigen::Index>(config.free.size()));
  Eigen::VectorXd deviations = Eigen::VectorXd::Zero(errors.cols());
  for (int i = 0; i < kDrives; ++i) {
    Bundle bundle = noisy(kNoise);
    ASSERT_TRUE(adjust(&bundle, config));
    const auto told = information(bundle, config);
    ASSERT_TRUE(told);
    EXPECT_NEAR(told->noise, kNoise, 0.1 * kNoise);
    deviations += uncertaintyOf(*truth.model, config.free, {told->camera}).deviations / kDrives;
    for (Eigen::Index k = 0; k < errors.cols(); ++k) {
      const Eigen::Index index = config.free[static_cast<std::size_t>(k)];
      errors(i, k) = bundle.values(index) - truth.values(index);
    }
  }
  // The deviation of 30 samples is itself only known to 13 %.
  for (Eigen::Index k = 0; k < errors.cols(); ++k) {
    const double measured = std::sqrt(errors.col(k).squaredNorm() / kDrives);
    EXPECT_NEAR(deviations(k) / measured, 1.0, 0.4)
        << parameter(config.free[static_cast<std::size_t>(k)]).name;
  }
}

TEST_F(BundleAdjustmentTest, KnowsWhatACommonErrorDoes) {
  constexpr double kError = 0.02;  // pixels, along the radius
  Bundle bundle = truth;
  const Eigen::Vector2d centre(251.2, 248.4);
  for (Bundle::Observation& observation : bundle.observations) {
    for (Eigen::Index k = 0; k < 4; ++k) {
      observation.pixels.segment<2>(2 * k) +=
          kError * (observation.pixels.segment<2>(2 * k) - centre).normalized();
    }
  }
  const BundleConfig config = freeCamera(0.1);
  auto told = information(truth, config);
  ASSERT_TRUE(told);
  // No error in the other direction.
  told->common_error_gradient.col(1).setZero();
  const Eigen::VectorXd alone = uncertaintyOf(*truth.model, config.free, {told->camera}).deviations;
  const Eigen::VectorXd both =
      uncertaintyOf(*truth.model, config.free, {told->camera, told->common_error_gradient, kError})
          .deviations;
  const Eigen::VectorXd predicted = (both.cwiseAbs2() - alone.cwiseAbs2()).cwiseSqrt();
  ASSERT_TRUE(adjust(&bundle, config));
  for (const char* name : {"fx", "fy", "apex_distance", "z"}) {
    const Eigen::Index index = *truth.model->indexOf(name);
    const auto place = std::find(config.free.begin(), config.free.end(), index);
    const double shift = std::abs(bundle.values(index) - truth.values(index));
    EXPECT_NEAR(shift / predicted(place - config.free.begin()), 1.0, 0.1) << name;
  }
}

TEST_F(BundleAdjustmentTest, ACornerFarOffHardlyCounts) {
  Bundle bundle = truth;
  bundle.observations[3].pixels.segment<2>(2) += Eigen::Vector2d(20.0, -15.0);
  ASSERT_TRUE(adjust(&bundle, freeCamera(0.1)));
  const Eigen::Index cx = *truth.model->indexOf("cx");
  EXPECT_NEAR(bundle.values(cx), truth.values(cx), 2e-3);
}

TEST_F(BundleAdjustmentTest, HoldsTheMirrorsSizeFirst) {
  BundleConfig config;
  config.free = allOf(*truth.model);
  config.noise = 0.5;
  const auto told = information(truth, config);
  ASSERT_TRUE(told);
  const Observability split = observability(*truth.model, config.free, {told->camera});
  ASSERT_FALSE(split.held.empty());
  EXPECT_EQ(split.held.front().first, *truth.model->indexOf("radius_of_curvature"));
  for (const char* name : {"fx", "fy", "cx", "cy", "roll", "pitch"}) {
    EXPECT_NE(std::find(split.observed.begin(), split.observed.end(), *truth.model->indexOf(name)),
              split.observed.end())
        << name;
  }
}

TEST_F(BundleAdjustmentTest, FindsMapAndCameraTogether) {
  constexpr double kNoise = 0.05;
  Bundle bundle = noisy(kNoise);
  disturbMap(0.02, radians(3.0), &bundle);
  BundleConfig config = freeCamera(kNoise);
  config.height_deviation = 0.005;
  config.lean_deviation = 0.009;
  for (const Eigen::Index index : config.free) bundle.values(index) += 0.2 * parameter(index).scale;
  BundleConfig wide = config;
  wide.noise = 3.0;
  ASSERT_TRUE(adjust(&bundle, wide));
  ASSERT_TRUE(adjust(&bundle, config));
  const auto told = information(bundle, config);
  ASSERT_TRUE(told);
  EXPECT_NEAR(told->noise, kNoise, 0.15 * kNoise);

  const ParameterUncertainty left = uncertaintyOf(*truth.model, config.free, {told->camera});
  for (std::size_t k = 0; k < config.free.size(); ++k) {
    const Eigen::Index index = config.free[k];
    EXPECT_LT(std::abs(bundle.values(index) - truth.values(index)),
              4.0 * left.deviations(static_cast<Eigen::Index>(k)))
        << parameter(index).name;
  }
  // Markers: within the map, once it is aligned with the truth.
  std::vector<Eigen::Vector3d> errors;
  Eigen::Matrix3Xd found(3, 10);
  Eigen::Matrix3Xd true_places(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i) {
    found.col(i) = bundle.landmarks[static_cast<std::size_t>(i)].marker.center();
    true_places.col(i) = truth.landmarks[static_cast<std::size_t>(i)].marker.center();
  }
  const Eigen::Isometry3d laid(Eigen::umeyama(found, true_places, false));
  double squares = 0.0;
  for (Eigen::Index i = 0; i < 10; ++i) {
    const Eigen::Vector3d error = laid * found.col(i) - true_places.col(i);
    EXPECT_LT(error.norm(), 0.003) << i;
    const Eigen::Matrix3d covariance =
        told->landmarks_within[static_cast<std::size_t>(i)].topLeftCorner<3, 3>();
    squares += error.dot(covariance.completeOrthogonalDecomposition().solve(error));
  }
  // Chi-square of 30 numbers, six of which were fitted.
  EXPECT_GT(squares / 24.0, 0.3);
  EXPECT_LT(squares / 24.0, 2.2);
}

TEST_F(BundleAdjustmentTest, SaysWhatTheImagesLeaveOpen) {
  Bundle bundle = truth;
  for (Bundle::Landmark& landmark : bundle.landmarks) landmark.prior.reset();
  BundleConfig config;
  config.height_deviation = 0.005;
  config.lean_deviation = 0.009;
  Undetermined undetermined;
  EXPECT_FALSE(information(bundle, config, &undetermined));
  EXPECT_NE(undetermined.direction.find("map"), std::string::npos) << undetermined.direction;
  bundle.landmarks[4].prior = PlacePrior::gauge(bundle.landmarks[4].marker);
  EXPECT_TRUE(information(bundle, config, &undetermined));
  // Hand-held, nothing tells which way is up.
  config.is_free = true;
  EXPECT_FALSE(information(bundle, config, &undetermined));
  EXPECT_NE(undetermined.direction.find("map"), std::string::npos) << undetermined.direction;
  // Sizes and places scale together.
  config.is_free = false;
  config.estimates_sizes = true;
  bundle.landmarks[4].prior->deviations.setConstant(1e3);
  EXPECT_FALSE(information(bundle, config, &undetermined));
}

TEST_F(BundleAdjustmentTest, HeedsWhatATapeMeasured) {
  // Markers that no image shows end up where the constraints put them.
  Bundle bundle = truth;
  bundle.landmarks[2].prior.reset();
  bundle.landmarks[2].marker.map_from_marker.translation() += Eigen::Vector3d(0.05, -0.04, 0.03);
  bundle.observations.erase(
      std::remove_if(bundle.observations.begin(), bundle.observations.end(),
                     [](const Bundle::Observation& each) { return each.landmark == 2; }),
      bundle.observations.end());
  const Eigen::Vector3d place = truth.landmarks[2].marker.center();
  for (const std::size_t other : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
    const double distance = (place - truth.landmarks[other].marker.center()).norm();
    bundle.constraints.push_back({MapConstraint::Kind::kDistance, {other, 2}, distance, 0.003});
  }
  bundle.constraints.push_back({MapConstraint::Kind::kHeight, {2}, place.z(), 0.003});
  bundle.constraints.push_back({MapConstraint::Kind::kVertical, {2}, 0.0, 0.01});
  bundle.landmarks[2].marker.map_from_marker.linear() =
      Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()).toRotationMatrix() *
      bundle.landmarks[2].marker.map_from_marker.linear();
  ASSERT_TRUE(adjust(&bundle, BundleConfig{}));
  EXPECT_LT((bundle.landmarks[2].marker.center() - place).norm(), 1e-4);
  EXPECT_NEAR(bundle.landmarks[2].marker.normal().z(), 0.0, 1e-5);
}

TEST(PlaceConstraintTest, APlaneLeavesWhatIsOffIt) {
  PlaceConstraint plane{MapConstraint::Kind::kPlane, {0, 1, 2, 3, 4}, 0.0, 0.005};
  std::vector<Eigen::Isometry3d> places;
  const Eigen::Vector3d a = Eigen::Vector3d(1.0, 2.0, 0.5).normalized();
  const Eigen::Vector3d b = a.unitOrthogonal();
  for (const auto& [s, t] : {std::pair(0.0, 0.0), std::pair(1.0, 0.2), std::pair(-0.5, 1.0),
                             std::pair(0.7, -1.1), std::pair(-1.2, -0.1)}) {
    places.emplace_back(Eigen::Translation3d(Eigen::Vector3d(3.0, 1.0, 1.0) + s * a + t * b));
  }
  EXPECT_LT(errorsOf(plane, places).norm(), 1e-12);
  places[3].translation() += 0.01 * a.cross(b);
  const double off = errorsOf(plane, places).norm();
  EXPECT_GT(off, 0.004);
  EXPECT_LT(off, 0.01);
}

}  // namespace
}  // namespace omnitag
