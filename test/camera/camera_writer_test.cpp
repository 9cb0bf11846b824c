#include "camera/camera_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "camera/ocam_calibration.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/common/error.h"
#include "toolbox_ocam.h"

namespace omnitag {
namespace {

const std::string kHead =
    "image: {width: 700, height: 640}\nlens: {fx: 210.1, fy: 209.3, cx: 352.3, cy: 317.1}\n";
const std::string kEquidistant =
    "model: equidistant\n" + kHead + "distortion: [-0.012, 0.003, -0.0008, 0.0001]\n";
const std::string kUnified =
    "model: unified\n" + kHead + "xi: 1.4\ndistortion: [-0.08, 0.03, 0.0004, -0.0006]\n";
const std::string kPinhole =
    "model: pinhole\n" + kHead + "distortion: [-0.08, 0.03, 0.0004, -0.0006]\n";
const std::string kDoubleSphere = "model: double_sphere\n" + kHead + "xi: -0.18\nalpha: 0.59\n";
const std::string kEucm = "model: eucm\n" + kHead + "alpha: 0.62\nbeta: 1.08\n";

std::string written(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

std::string converted(const std::string& text, const std::string& format) {
  const std::string output = testing::TempDir() + "camera_writer_out";
  return writtenCamera(written("camera_writer_in.yaml", text), format, output).text;
}

/// The largest distance between the images of rays of two cameras, in pixels.
double differenceOf(const CameraModel& a, const CameraModel& b) {
  double worst = 0.0;
  int compared = 0;
  for (double u = 1.0; u < a.imageSize().width - 1; u += 13.0) {
    for (double v = 1.0; v < a.imageSize().height - 1; v += 13.0) {
      const auto ray = a.rayFromPixel({u, v});
      if (!ray) continue;
      const auto pixel = b.pixelFromPoint(3.0 * ray->direction);
      EXPECT_TRUE(pixel) << u << ", " << v;
      if (!pixel) return INFINITY;
      worst = std::max(worst, (*pixel - Eigen::Vector2d(u, v)).norm());
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
  return worst;
}

TEST(CameraWriter, writesWhatItReadsAgain) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cameras = {
      {kEquidistant, {"omnitag", "kalibr", "opencv", "camera_info"}},
      {kUnified, {"omnitag", "kalibr", "opencv"}},
      {kPinhole, {"omnitag", "kalibr", "opencv", "camera_info"}},
      {kDoubleSphere, {"omnitag", "kalibr"}},
      {kEucm, {"omnitag", "kalibr"}}};
  for (const auto& [text, formats] : cameras) {
    const auto original = parseCamera(text, "original");
    for (const std::string& format : formats) {
      const auto again = parseCamera(converted(text, format), format);
      EXPECT_EQ(again->imageSize().width, 700);
      EXPECT_EQ(again->imageSize().height, 640);
      EXPECT_LT(differenceOf(*original, *again), 1e-9) << format << "\n" << text;
    }
  }
}

TEST(CameraWriter, writesWhatOpenCvReads) {
  const cv::FileStorage fisheye(converted(kEquidistant, "opencv"),
                                cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat matrix;
  cv::Mat distortion;
  fisheye["camera_matrix"] >> matrix;
  fisheye["distortion_coefficients"] >> distortion;
  EXPECT_EQ(static_cast<int>(fisheye["image_width"]), 700);
  EXPECT_EQ(matrix.at<double>(0, 0), 210.1);
  EXPECT_EQ(matrix.at<double>(1, 2), 317.1);
  ASSERT_EQ(distortion.total(), 4U);
  EXPECT_EQ(distortion.at<double>(2), -0.0008);
  EXPECT_EQ(static_cast<int>(fisheye["fisheye_model"]), 1);
  const cv::FileStorage omnidir(converted(kUnified, "opencv"),
                                cv::FileStorage::READ | cv::FileStorage::MEMORY);
  EXPECT_EQ(static_cast<double>(omnidir["xi"]), 1.4);
}

TEST(CameraWriter, keepsTheWordsOfAKalibrChain) {
  EXPECT_EQ(converted(kEucm, "kalibr"),
            "cam0:\n"
            "  camera_model: eucm\n"
            "  intrinsics: [0.62, 1.08, 210.1, 209.3, 352.3, 317.1]\n"
            "  distortion_model: none\n"
            "  distortion_coeffs: []\n"
            "  resolution: [700, 640]\n");
}

TEST(CameraWriter, followsFisheyesWithOcamsPolynomials) {
  for (const std::string& text : {kEquidistant, kDoubleSphere, kEucm}) {
    const auto original = parseCamera(text + "max_angle: 1.6\n", "original");
    const std::string ocam = converted(text + "max_angle: 1.6\n", "ocam");
    const auto again = loadCamera(written("camera_writer_calib_results.txt", ocam));
    EXPECT_LT(differenceOf(*original, *again), 0.025) << text;
    // By the toolbox's own functions, and with its inverse polynomial.
    const OcamCalibration calibration = parseOcamCalibration(ocam, "ocam");
    for (double u = 20.0; u < 680.0; u += 31.0) {
      const auto ray = original->rayFromPixel({u, 300.0});
      if (!ray) continue;
      EXPECT_LT((test::cam2world(calibration, {u, 300.0}) - ray->direction).norm(), 2e-4);
    }
  }
}

TEST(CameraWriter, writesTheToolboxsInversePolynomial) {
  std::istringstream lines(converted(kEquidistant + "max_angle: 1.6\n", "ocam"));
  std::string line;
  for (int numbers = 0; numbers < 2 && std::getline(lines, line);) {
    if (!line.empty() && line[0] != '#') ++numbers;
  }
  std::istringstream numbers(line);
  std::size_t count = 0;
  numbers >> count;
  std::vector<double> polynomial(count);
  for (double& each : polynomial) numbers >> each;
  ASSERT_TRUE(numbers);
  const auto camera = parseCamera(kEquidistant, "original");
  for (double angle = 0.05; angle < 1.55; angle += 0.1) {
    double radius = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      radius += polynomial[i] * std::pow(angle - 1.57079632679489662, static_cast<double>(i));
    }
    const auto pixel = camera->pixelFromPoint({std::sin(angle), 0.0, std::cos(angle)});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(radius, pixel->x() - 352.3, 0.025);
  }
}

TEST(CameraWriter, writesACameraFileOfAnothersFile) {
  EXPECT_EQ(converted(converted(kEquidistant, "kalibr"), "omnitag"),
            "model: equidistant\n"
            "image: {width: 700, height: 640}\n"
            "lens: {fx: 210.1, fy: 209.3, cx: 352.3, cy: 317.1}\n"
            "distortion: [-0.012, 0.003, -0.0008, 0.0001]\n");
}

TEST(CameraWriter, saysWhatAFormatHasNoPlaceFor) {
  const std::string path =
      written("camera_writer_in.yaml", kEquidistant + "max_angle: 1.5\nuncertainty: none\n");
  EXPECT_EQ(writtenCamera(path, "kalibr", "").left_out,
            (std::vector<std::string>{"max_angle", "uncertainty"}));
  EXPECT_TRUE(writtenCamera(path, "omnitag", "").left_out.empty());
}

TEST(CameraWriter, refusesWhatAFormatHasNoWordsFor) {
  const auto refusal = [](const std::string& text, const std::string& format) -> std::string {
    try {
      converted(text, format);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(testing::TempDir().size());
    }
    return "";
  };
  const std::string in = "camera_writer_in.yaml";
  const std::string panorama = "model: equirectangular\nimage: {width: 20, height: 10}\n";
  EXPECT_EQ(refusal(kEucm, "opencv"),
            in + ":1: model: expected equidistant, unified or pinhole to write it as opencv, found "
                 "'eucm'");
  EXPECT_EQ(refusal(kUnified, "camera_info"),
            in + ":1: model: expected equidistant or pinhole to write it as camera_info, found "
                 "'unified'");
  EXPECT_EQ(refusal(panorama, "kalibr"),
            in + ":1: model: expected equidistant, pinhole, unified, double_sphere or eucm to "
                 "write it as kalibr, found 'equirectangular'");
  EXPECT_EQ(refusal(kUnified, "ocam"),
            in + ": expected a camera whose image depends on the angle off its axis alone, as "
                 "OCamCalib has it, found a distorted one");
  const std::string skewed =
      std::string(kEquidistant).replace(kEquidistant.find("317.1"), 5, "317.1, skew: 0.3");
  EXPECT_EQ(refusal(skewed, "kalibr"),
            in + ":3: lens.skew: expected 0 or none to write it as kalibr, found '0.3'");
  EXPECT_EQ(refusal(skewed, "opencv"), "");
  const std::string third =
      std::string(kPinhole).replace(kPinhole.find("-0.0006"), 7, "-0.0006, 0.1");
  EXPECT_EQ(refusal(third, "kalibr"),
            in + ":4: distortion: expected k3 of 0 to write it as kalibr, found a list of 5");
  const std::string mirror =
      "model: catadioptric\n" + kHead +
      "mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: "
      "0.0375}\n";
  EXPECT_EQ(refusal(mirror, "ocam"),
            in + ":1: model: expected a central camera, of which all lines of sight meet, to write "
                 "it as ocam, found 'catadioptric'");
}

}  // namespace
}  // namespace omnitag
