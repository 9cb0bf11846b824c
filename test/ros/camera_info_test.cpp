#include "ros/camera_info.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "camera/equidistant_camera.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

sensor_msgs::CameraInfo fisheyeInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "equidistant";
  info.D = {-0.02, 0.004, -0.001, 0.0002};
  info.K = {201.0, 0.4, 322.5, 0.0, 199.0, 238.0, 0.0, 0.0, 1.0};
  return info;
}

TEST(CameraInfo, describesAFisheye) {
  const DescribedCamera described = cameraFromInfo(fisheyeInfo(), "/eye/camera_info");
  EXPECT_EQ(described.origin, "/eye/camera_info");
  const auto camera = std::dynamic_pointer_cast<const EquidistantCamera>(described.model);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->imageSize().width, 640);
  EXPECT_EQ(camera->imageSize().height, 480);
  EXPECT_EQ(camera->coefficients(),
            (EquidistantCamera::Coefficients{-0.02, 0.004, -0.001, 0.0002}));
  Eigen::Matrix2d affine;
  affine << 201.0, 0.4, 0.0, 199.0;
  EXPECT_EQ(camera->imagePlane().affine(), affine);
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(322.5, 238.0));
}

TEST(CameraInfo, mayStateThatItsImagesAreWhole) {
  sensor_msgs::CameraInfo info = fisheyeInfo();
  info.roi.width = 640;
  info.roi.height = 480;
  info.binning_x = info.binning_y = 1;
  EXPECT_TRUE(cameraFromInfo(info, "/eye/camera_info").model);
}

TEST(CameraInfo, describesTheImagesWhereTheyAreBinnedOrAPart) {
  sensor_msgs::CameraInfo info = fisheyeInfo();
  info.roi.x_offset = 20;
  info.roi.y_offset = 10;
  info.roi.width = 600;
  info.roi.height = 460;
  info.binning_x = info.binning_y = 2;
  const auto whole = cameraFromInfo(fisheyeInfo(), "/eye/camera_info").model;
  const auto part = cameraFromInfo(info, "/eye/camera_info").model;
  EXPECT_EQ(part->imageSize().width, 300);
  EXPECT_EQ(part->imageSize().height, 230);
  // A pixel of the image is the mean of four, whose middle lies between them.
  const Eigen::Vector3d point(0.7, -0.4, 1.0);
  const Eigen::Vector2d expected =
      (*whole->pixelFromPoint(point) - Eigen::Vector2d(20.5, 10.5)) / 2.0;
  EXPECT_LT((*part->pixelFromPoint(point) - expected).norm(), 1e-9);
}

TEST(CameraInfo, describesLensesByTheirOtherNames) {
  sensor_msgs::CameraInfo info = fisheyeInfo();
  info.distortion_model = "fisheye";
  EXPECT_TRUE(std::dynamic_pointer_cast<const EquidistantCamera>(
      cameraFromInfo(info, "/eye/camera_info").model));
  info.distortion_model = "plumb_bob";
  info.D = {-0.2, 0.05, 0.001, -0.002, 0.03};
  const auto camera = cameraFromInfo(info, "/eye/camera_info").model;
  EXPECT_EQ(camera->imagePlane().distortion(),
            (ImagePlane::Distortion{-0.2, 0.05, 0.001, -0.002, 0.03}));
  // As uncertain as any calibration that does not say how exact it is.
  EXPECT_NEAR(camera->uncertainty().scale, 0.48, 1e-12);
}

TEST(CameraInfo, isRefusedInOneLineThatTellsWhy) {
  const auto refusal = [](const std::function<void(sensor_msgs::CameraInfo*)>& spoil) {
    sensor_msgs::CameraInfo info = fisheyeInfo();
    spoil(&info);
    try {
      cameraFromInfo(info, "/eye/camera_info");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  using Info = sensor_msgs::CameraInfo;
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos && text.find('\n') == std::string::npos;
  };
  EXPECT_PRED2(has, refusal([](Info* info) { *info = Info(); }),
               "/eye/camera_info: width, height: expected the image's size, found 0 x 0");
  EXPECT_PRED2(has, refusal([](Info* info) { info->K = {}; }),
               "/eye/camera_info: K: expected a camera matrix with focal lengths > 0, found none; "
               "calibrate the camera, or give a camera file");
  EXPECT_PRED2(has,
               refusal([](Info* info) { info->K[2] = std::numeric_limits<double>::quiet_NaN(); }),
               "K: expected");
  EXPECT_PRED2(has, refusal([](Info* info) { info->distortion_model = "fov"; }),
               "/eye/camera_info: distortion_model: expected one of equidistant, fisheye, "
               "plumb_bob, rational_polynomial, found 'fov'");
  EXPECT_PRED2(has, refusal([](Info* info) { info->D.push_back(0.0); }),
               "D: expected 4 numbers, found 5");
  EXPECT_PRED2(has, refusal([](Info* info) { info->roi.x_offset = 640; }),
               "/eye/camera_info: roi: expected a part of the image of 640 pixels");
  EXPECT_PRED2(has, refusal([](Info* info) { info->D[0] = -1e300; }),
               "/eye/camera_info: distortion: expected one that grows");
}

}  // namespace
}  // namespace omnitag
