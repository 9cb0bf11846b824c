#include "adjustment/camera_template.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "drive.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

const Eigen::Vector3d kPoint(2.0, -1.0, -0.2);

Eigen::VectorXd valuesOf(const CameraTemplate& camera) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(camera.parameters().size()));
  for (std::size_t i = 0; i < camera.parameters().size(); ++i) {
    values(static_cast<Eigen::Index>(i)) = camera.parameters()[i].value;
  }
  return values;
}

Eigen::Index indexOf(const CameraTemplate& camera, const std::string& name) {
  for (std::size_t i = 0; i < camera.parameters().size(); ++i) {
    if (camera.parameters()[i].name == name) return static_cast<Eigen::Index>(i);
  }
  ADD_FAILURE() << name;
  return 0;
}

class ShippedCameras : public testing::TestWithParam<std::string> {};

TEST_P(ShippedCameras, AreWrittenAsTheyWereRead) {
  const std::string path = std::string(PACKAGE_DIR) + "/config/cameras/" + GetParam();
  const CameraTemplate camera = CameraTemplate::fromFile(path);
  const auto again = parseCamera(camera.text(valuesOf(camera)), "written");
  const auto original = loadCamera(path);
  const Eigen::Vector3d across(2.0, -1.0, 0.1);
  const auto pixel = original->pixelFromPoint(across);
  ASSERT_TRUE(pixel);
  EXPECT_EQ(again->pixelFromPoint(across), pixel);
  EXPECT_EQ(again->maxRadius(), original->maxRadius());
}

INSTANTIATE_TEST_SUITE_P(All, ShippedCameras,
                         testing::Values("paper.yaml", "hyperbolic.yaml", "fisheye.yaml"));

TEST(CameraTemplateTest, ReplacesWhatItsNamesSay) {
  const std::string unified =
      "model: unified\nimage: {width: 700, height: 700}\n"
      "lens: {fx: 440, fy: 442, cx: 347.7, cy: 351.2, skew: 0.8}\nxi: 1.4\n"
      "distortion: [-0.08, 0.03, 0.0004, -0.0006]\nmax_angle: 1.6\n";
  const CameraTemplate camera = CameraTemplate::fromText(unified, "guess");
  Eigen::VectorXd values = valuesOf(camera);
  values(indexOf(camera, "fy")) = 443.0;
  values(indexOf(camera, "xi")) = 1.5;
  values(indexOf(camera, "k2")) = 0.04;
  values(indexOf(camera, "p1")) = 0.0005;
  std::string edited = unified;
  edited.replace(edited.find("442"), 3, "443");
  edited.replace(edited.find("1.4"), 3, "1.5");
  edited.replace(edited.find("0.03"), 4, "0.04");
  edited.replace(edited.find("0.0004"), 6, "0.0005");
  const Eigen::Vector3d point(2.0, -1.0, 0.5);
  const auto expected = parseCamera(edited, "edited")->pixelFromPoint(point);
  ASSERT_TRUE(expected);
  const auto found = camera.camera(values)->pixelFromPoint(point);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - *expected).norm(), 1e-9);
}

TEST(CameraTemplateTest, KnowsEveryModelsNumbers) {
  const std::string lens =
      "image: {width: 700, height: 700}\nlens: {fx: 440, fy: 442, cx: 347.7, cy: 351.2}\n";
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"model: double_sphere\n" + lens + "xi: -0.2\nalpha: 0.6\n", "alpha"},
      {"model: eucm\n" + lens + "alpha: 0.6\nbeta: 1.1\n", "beta"},
      {"model: pinhole\n" + lens + "distortion: [-0.1, 0.02, 0.001, 0, 0.3]\n", "k2"},
      {"model: pinhole\n" + lens, "fx"}};
  for (const auto& [text, name] : changes) {
    const CameraTemplate camera = CameraTemplate::fromText(text, "guess");
    Eigen::VectorXd values = valuesOf(camera);
    const Eigen::Vector3d point(0.5, -0.4, 1.0);
    const auto before = parseCamera(text, "guess")->pixelFromPoint(point);
    EXPECT_EQ(camera.camera(values)->pixelFromPoint(point), before) << text;
    values(indexOf(camera, name)) *= 1.01;
    EXPECT_NE(camera.camera(values)->pixelFromPoint(point), before) << text;
  }
}

TEST(CameraTemplateTest, TakesTheCalibrationOfOcamIntoTheFile) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "template_calib_results.txt")
      << "5 -213 0 1.1e-3 -9e-7 3e-9\n0\n347.1 352.3\n1.004 0.0006 -0.0007\n700 720\n";
  const std::string text =
      "model: ocam\ncalibration_file: template_calib_results.txt\nmax_angle: 1.6\n";
  const CameraTemplate camera = CameraTemplate::fromText(text, folder + "camera.yaml");
  const auto original = parseCamera(text, folder + "camera.yaml");
  Eigen::VectorXd values = valuesOf(camera);
  const auto again = parseCamera(camera.text(values), "elsewhere/camera.yaml");
  EXPECT_EQ(again->imageSize().width, 720);
  EXPECT_EQ(again->maxRadius(), original->maxRadius());
  const Eigen::Vector3d point(0.5, -0.4, 0.2);
  const auto pixel = original->pixelFromPoint(point);
  ASSERT_TRUE(pixel);
  EXPECT_EQ(again->pixelFromPoint(point), pixel);
  values(indexOf(camera, "cx")) += 3.0;
  values(indexOf(camera, "cy")) -= 2.0;
  const auto shifted = camera.camera(values)->pixelFromPoint(point);
  ASSERT_TRUE(shifted);
  EXPECT_LT((*shifted - *pixel - Eigen::Vector2d(3.0, -2.0)).norm(), 1e-9);
  for (const char* name : {"a0", "a2", "a3", "a4", "c", "d", "e"}) {
    Eigen::VectorXd changed = valuesOf(camera);
    const Eigen::Index index = indexOf(camera, name);
    changed(index) += 0.1 * camera.parameters()[static_cast<std::size_t>(index)].scale;
    EXPECT_NE(camera.camera(changed)->pixelFromPoint(point), pixel) << name;
  }
}

TEST(CameraTemplateTest, NamesTheProfileOfAConicConstant) {
  const CameraTemplate camera = CameraTemplate::fromText(
      test::catadioptricFile(1195, 250, 250, 0.21, test::kSphere), "guess");
  EXPECT_TRUE(camera.impliesConicConstant());
  Eigen::VectorXd values = valuesOf(camera);
  for (const auto& [constant, profile] : std::vector<std::pair<double, std::string>>{
           {0.0, "spherical"}, {-1.0, "parabolic"}, {-1.5, "hyperbolic"}, {-0.5, "aspheric"}}) {
    values(indexOf(camera, "conic_constant")) = constant;
    EXPECT_NE(camera.text(values).find("profile: " + profile), std::string::npos) << constant;
    EXPECT_TRUE(camera.camera(values)->pixelFromPoint(kPoint)) << constant;
  }
}

TEST(CameraTemplateTest, WidensTheMirrorOnly) {
  const CameraTemplate camera = CameraTemplate::fromText(
      test::catadioptricFile(1195, 250, 250, 0.21,
                             "profile: spherical, radius_of_curvature: 0.04, rim_radius: 0.03"),
      "guess");
  const Eigen::VectorXd values = valuesOf(camera);
  const auto wide = camera.widened(values);
  EXPECT_GT(wide->maxRadius(), 1.2 * camera.camera(values)->maxRadius());
  const auto pixel = camera.camera(values)->pixelFromPoint({2.0, -1.0, 0.3});
  ASSERT_TRUE(pixel);
  EXPECT_LT((*wide->pixelFromPoint({2.0, -1.0, 0.3}) - *pixel).norm(), 1e-9);
}

TEST(CameraTemplateTest, FindsTheRimOfACircle) {
  const CameraTemplate camera = CameraTemplate::fromText(
      test::catadioptricFile(1195, 250, 250, 0.21, test::kSphere), "guess");
  const Eigen::VectorXd values = valuesOf(camera);
  const auto narrower = parseCamera(camera.text(values, camera.rimAt(values, 150.0)), "narrower");
  EXPECT_NEAR(1195.0 * narrower->maxRadius(), 150.0, 1e-6);
}

TEST(CameraTemplateTest, RefusesWhatIsNotCalibrated) {
  const std::string message = test::refusalOf([] {
    CameraTemplate::fromText("model: equirectangular\nimage: {width: 200, height: 100}\n",
                             "guess.yaml");
  });
  EXPECT_NE(message.find("guess.yaml"), std::string::npos) << message;
  EXPECT_NE(message.find("model"), std::string::npos) << message;
}

}  // namespace
}  // namespace omnitag
