#include "adjustment/leaning_mounting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../support/sample_cameras.h"
#include "camera/mounted_camera.h"
#include "drive.h"

namespace omnitag {
namespace {

TEST(LeaningMountingTest, GivesBackWhatItWasMadeFrom) {
  for (const Eigen::Isometry3d& mounting : {test::lookingDown(), test::lookingUp()}) {
    const LeaningMounting leaning(mounting);
    EXPECT_TRUE(leaning.at(leaning.values()).isApprox(mounting, 1e-12));
  }
}

TEST(LeaningMountingTest, TakesTfsAngles) {
  // The matrix of roll, pitch and yaw, written out.
  const double roll = 0.2, pitch = -0.15, yaw = 2.0;
  const double cr = std::cos(roll), sr = std::sin(roll), cp = std::cos(pitch), sp = std::sin(pitch),
               cy = std::cos(yaw), sy = std::sin(yaw);
  Eigen::Matrix3d rotation;
  rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,          //
      -sp, cp * sr, cp * cr;
  Eigen::Isometry3d mounting(Eigen::Translation3d(0.1, 0.2, 0.7));
  mounting.linear() = rotation;
  const LeaningMounting leaning(mounting);
  EXPECT_TRUE(leaning.values().isApprox(Eigen::Vector3d(0.7, roll, pitch), 1e-12));
  EXPECT_TRUE(fromRollPitchYaw({roll, pitch, yaw}).isApprox(rotation, 1e-12));
}

TEST(LeaningMountingTest, WhatItKeepsIsAnotherPoseOfTheRobot) {
  const auto camera = test::sphericalCamera();
  const Eigen::Isometry3d truth = test::mounting(1.1, 0.2, -0.1);
  const Pose offset{0.3, -0.2, 0.4};
  const LeaningMounting believed(offset.toIsometry() * truth);
  const MountedCamera moved(camera, believed.at(believed.values()));
  const Pose pose{1.0, 0.5, -0.7};
  const Eigen::Vector3d point(3.0, 2.0, 1.2);
  const auto expected = MountedCamera(camera, truth).pixelFromMap(pose, point);
  ASSERT_TRUE(expected);
  const auto found = moved.pixelFromMap(pose * inverse(offset), point);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - *expected).norm(), 1e-9);
  EXPECT_TRUE(believed.values().isApprox(LeaningMounting(truth).values(), 1e-12));
}

TEST(LeaningMountingTest, TakesACameraThatLooksAheadButNotOneOnItsSide) {
  // Its x axis to the robot's right, its y axis down.
  const Eigen::Isometry3d ahead(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));
  const LeaningMounting leaning(ahead);
  EXPECT_TRUE(leaning.at(leaning.values()).isApprox(ahead, 1e-12));
  EXPECT_FALSE(isUpright(ahead));
  EXPECT_TRUE(isUpright(test::lookingDown()));

  const Eigen::Isometry3d on_side(ahead * Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()));
  EXPECT_NE(test::refusalOf([&] { const LeaningMounting mounting(on_side); }).find("69"),
            std::string::npos);
}

}  // namespace
}  // namespace omnitag
