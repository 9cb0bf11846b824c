#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "camera/central_camera.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

const cv::Matx33d kMatrix{312.4, 0.0, 322.1, 0.0, 311.8, 238.6, 0.0, 0.0, 1.0};
const std::vector<cv::Point3d> kPoints = {
    {0.3, -0.2, 1.0}, {-0.5, 0.4, 1.1}, {0.05, 0.3, 0.7}, {-0.9, -0.1, 1.3}};
const cv::Vec3d kNone{0.0, 0.0, 0.0};

/// Expects a camera to image points where OpenCV does.
void expectImages(const CameraModel& camera, const std::vector<cv::Point2d>& expected,
                  double tolerance = 1e-8) {
  ASSERT_EQ(expected.size(), kPoints.size());
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    const auto pixel = camera.pixelFromPoint({kPoints[i].x, kPoints[i].y, kPoints[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[i].x, tolerance);
    EXPECT_NEAR(pixel->y(), expected[i].y, tolerance);
  }
}

std::vector<cv::Point2d> byFisheye(const cv::Vec4d& d, const cv::Matx33d& matrix = kMatrix) {
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(kPoints, pixels, kNone, kNone, matrix, d);
  return pixels;
}

std::vector<cv::Point2d> byPinhole(const std::vector<double>& d) {
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(kPoints, kNone, kNone, kMatrix, d, pixels);
  return pixels;
}

std::vector<cv::Point2d> byOmnidir(const cv::Vec4d& d, double xi,
                                   const cv::Matx33d& matrix = kMatrix) {
  std::vector<cv::Point2d> pixels;
  cv::omnidir::projectPoints(kPoints, pixels, kNone, kNone, matrix, xi, d);
  return pixels;
}

std::shared_ptr<const CameraModel> parsed(const std::string& text) {
  return parseCamera(text, "camera.yaml");
}

std::string written(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

constexpr char kChain[] =
    "cam0:\n"
    "  cam_overlaps: [1]\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [-0.01, 0.02, -0.008, 0.001]\n"
    "  distortion_model: equidistant\n"
    "  intrinsics: [312.4, 311.8, 322.1, 238.6]\n"
    "  resolution: [640, 480]\n"
    "  rostopic: /cam0/image_raw\n"
    "cam1:\n"
    "  T_cn_cnm1:\n"
    "  - [1.0, 0.0, 0.0, -0.1]\n"
    "  - [0.0, 1.0, 0.0, 0.0]\n"
    "  - [0.0, 0.0, 1.0, 0.0]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  camera_model: omni\n"
    "  distortion_coeffs: [-0.2, 0.1, 0.001, -0.0005]\n"
    "  distortion_model: radtan\n"
    "  intrinsics: [1.3, 712.4, 711.8, 322.1, 238.6]\n"
    "  resolution: [640, 480]\n";

TEST(Kalibr, hasSeveralCamerasInAFile) {
  const std::string path = written("foreign_chain.yaml", kChain);
  const auto first = loadCamera(path + "#cam0");
  EXPECT_EQ(first->imageSize().width, 640);
  EXPECT_EQ(first->imageSize().height, 480);
  // The usual uncertainty: half a pixel of 500.
  EXPECT_NEAR(first->uncertainty().scale, 0.48, 1e-12);
  expectImages(*first, byFisheye({-0.01, 0.02, -0.008, 0.001}));
  cv::Matx33d matrix = kMatrix;
  matrix(0, 0) = 712.4;
  matrix(1, 1) = 711.8;
  expectImages(*loadCamera(path + "#cam1"), byOmnidir({-0.2, 0.1, 0.001, -0.0005}, 1.3, matrix));
}

TEST(Kalibr, isReadWithoutANameWhereThereIsOneCamera) {
  const std::string chain(kChain);
  expectImages(*parsed(chain.substr(0, chain.find("cam1"))),
               byFisheye({-0.01, 0.02, -0.008, 0.001}));
}

std::string kalibr(const std::string& model, const std::string& intrinsics,
                   const std::string& distortion_model, const std::string& coefficients) {
  return "cam0:\n  camera_model: " + model + "\n  intrinsics: [" + intrinsics +
         "]\n  distortion_model: " + distortion_model + "\n  distortion_coeffs: [" + coefficients +
         "]\n  resolution: [640, 480]\n";
}

TEST(Kalibr, hasPinholes) {
  const std::string lens = "312.4, 311.8, 322.1, 238.6";
  expectImages(*parsed(kalibr("pinhole", lens, "radtan", "-0.2, 0.05, 0.001, -0.002")),
               byPinhole({-0.2, 0.05, 0.001, -0.002}));
  expectImages(*parsed(kalibr("pinhole", lens, "none", "")), byPinhole({0, 0, 0, 0}));
}

TEST(Kalibr, hasSpheresAndEllipsoids) {
  // With xi = 0, or beta = 1, both are the unified model.
  const auto unified = byOmnidir({0, 0, 0, 0}, 0.6 / 0.4);
  const double fx = 0.4 * 312.4;
  const double fy = 0.4 * 311.8;
  const std::string lens = std::to_string(fx) + ", " + std::to_string(fy) + ", 322.1, 238.6";
  expectImages(*parsed(kalibr("ds", "0.0, 0.6, " + lens, "none", "")), unified, 1e-3);
  expectImages(*parsed(kalibr("eucm", "0.6, 1.0, " + lens, "none", "")), unified, 1e-3);
}

/// What OpenCV's own samples store.
std::string stored(const cv::Mat& distortion, const std::string& more) {
  cv::FileStorage file(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "image_width" << 640 << "image_height" << 480;
  file << "camera_matrix" << cv::Mat(kMatrix) << "distortion_coefficients" << distortion;
  return file.releaseAndGetString() + more;
}

TEST(OpenCv, storesFisheyes) {
  const cv::Vec4d d{-0.01, 0.02, -0.008, 0.001};
  const cv::Mat column = (cv::Mat_<double>(4, 1) << d[0], d[1], d[2], d[3]);
  for (const std::string more : {"", "fisheye_model: 1\n"}) {
    expectImages(*parsed(stored(column, more)), byFisheye(d));
    expectImages(*parsed(stored(column.t(), more)), byFisheye(d));
  }
}

TEST(OpenCv, storesPinholes) {
  const cv::Mat five = (cv::Mat_<double>(1, 5) << -0.2, 0.05, 0.001, -0.002, 0.03);
  expectImages(*parsed(stored(five, "")), byPinhole({-0.2, 0.05, 0.001, -0.002, 0.03}));
  const cv::Mat eight = (cv::Mat_<double>(8, 1) << -0.2, 0.05, 0.001, -0.002, 0.03, 0, 0, 0);
  expectImages(*parsed(stored(eight, "fisheye_model: 0\n")),
               byPinhole({-0.2, 0.05, 0.001, -0.002, 0.03}));
  const cv::Mat four = (cv::Mat_<double>(1, 4) << -0.2, 0.05, 0.001, -0.002);
  expectImages(*parsed(stored(four, "fisheye_model: 0\n")), byPinhole({-0.2, 0.05, 0.001, -0.002}));
}

TEST(OpenCv, storesOmnidirectionalCameras) {
  const cv::Vec4d d{-0.2, 0.1, 0.001, -0.0005};
  const cv::Mat row = (cv::Mat_<double>(1, 4) << d[0], d[1], d[2], d[3]);
  expectImages(*parsed(stored(row, "xi: 1.1\n")), byOmnidir(d, 1.1));
  expectImages(*parsed(stored(row,
                              "xi: !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n"
                              "   data: [ 1.1 ]\n")),
               byOmnidir(d, 1.1));
}

/// As camera_calibration writes it.
std::string infoFile(const std::string& model, const std::string& d, int count) {
  return "image_width: 640\nimage_height: 480\ncamera_name: eye\n"
         "camera_matrix:\n  rows: 3\n  cols: 3\n"
         "  data: [312.4, 0., 322.1, 0., 311.8, 238.6, 0., 0., 1.]\n"
         "distortion_model: " +
         model + "\ndistortion_coefficients:\n  rows: 1\n  cols: " + std::to_string(count) +
         "\n  data: [" + d +
         "]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "projection_matrix:\n  rows: 3\n  cols: 4\n"
         "  data: [300, 0, 320, 0, 0, 300, 240, 0, 0, 0, 1, 0]\n";
}

TEST(CameraInfoFile, describesFisheyesByEitherName) {
  for (const std::string model : {"equidistant", "fisheye"}) {
    expectImages(*parsed(infoFile(model, "-0.01, 0.02, -0.008, 0.001", 4)),
                 byFisheye({-0.01, 0.02, -0.008, 0.001}));
  }
}

TEST(CameraInfoFile, describesPinholes) {
  expectImages(*parsed(infoFile("plumb_bob", "-0.2, 0.05, 0.001, -0.002, 0.03", 5)),
               byPinhole({-0.2, 0.05, 0.001, -0.002, 0.03}));
  expectImages(
      *parsed(infoFile("rational_polynomial", "-0.2, 0.05, 0.001, -0.002, 0.03, 0, 0, 0", 8)),
      byPinhole({-0.2, 0.05, 0.001, -0.002, 0.03}));
}

/// As rostopic shows the message.
std::string infoMessage(const std::string& binning, const std::string& roi) {
  return "header:\n  seq: 7\n  stamp:\n    secs: 3\n    nsecs: 0\n  frame_id: \"eye\"\n"
         "height: 480\nwidth: 640\ndistortion_model: \"equidistant\"\n"
         "D: [-0.01, 0.02, -0.008, 0.001]\n"
         "K: [312.4, 0.0, 322.1, 0.0, 311.8, 238.6, 0.0, 0.0, 1.0]\n"
         "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
         "P: [312.4, 0, 322.1, 0, 0, 311.8, 238.6, 0, 0, 0, 1, 0]\n" +
         binning + roi;
}

TEST(CameraInfoFile, mayBeAMessage) {
  expectImages(*parsed(infoMessage("binning_x: 0\nbinning_y: 0\n",
                                   "roi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n"
                                   "  width: 0\n  do_rectify: False\n")),
               byFisheye({-0.01, 0.02, -0.008, 0.001}));
}

TEST(CameraInfoFile, describesBinnedPartsOfTheSensor) {
  // Columns 40 to 599 of the sensor by fours, rows 30 to 449 by twos: pixel u of the image is the
  // mean of the columns 40 + 4 u to 40 + 4 u + 3, whose middle is 41.5 + 4 u.
  const auto camera = parsed(infoMessage("binning_x: 4\nbinning_y: 2\n",
                                         "roi: {x_offset: 40, y_offset: 30, width: 560, height: "
                                         "420, do_rectify: false}\n"));
  EXPECT_EQ(camera->imageSize().width, 140);
  EXPECT_EQ(camera->imageSize().height, 210);
  std::vector<cv::Point2d> expected = byFisheye({-0.01, 0.02, -0.008, 0.001});
  for (cv::Point2d& pixel : expected) pixel = {(pixel.x - 41.5) / 4.0, (pixel.y - 30.5) / 2.0};
  expectImages(*camera, expected);
}

TEST(OCamCalib, isReadByItself) {
  const std::string path = written(
      "foreign_calib_results.txt",
      "#polynomial coefficients\n\n5 -289.5569 0 1.538894e-03 -3.14032e-06 7.206996e-09\n\n"
      "#inverse\n\n2 434.4 226.0\n\n#center\n\n390.9 423.7\n\n#affine\n\n0.999 -0.0003 -0.0001\n\n"
      "#size\n\n800 848\n");
  const auto camera = loadCamera(path);
  EXPECT_EQ(camera->imageSize().width, 848);
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(423.7, 390.9));
}

struct Refusal {
  std::string name;
  std::string text;
  std::string message;
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.name; }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

class BadForeignFile : public testing::TestWithParam<Refusal> {};

TEST_P(BadForeignFile, isRefusedInOneLineThatTellsWhy) {
  std::string message;
  try {
    parsed(GetParam().text);
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find(GetParam().message), 0U) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

std::vector<Refusal> refusals() {
  const std::string info = infoFile("equidistant", "-0.01, 0.02, -0.008, 0.001", 4);
  const std::string one = std::string(kChain).substr(0, std::string(kChain).find("cam1"));
  const std::string many = stored((cv::Mat_<double>(1, 4) << 0, 0, 0, 0), "");
  return {
      {"Nobodys", "eyes: 2\n",
       "camera.yaml:1: model: expected a camera's model, or the file of another tool, with "
       "camera_model (Kalibr), camera_matrix (OpenCV) or distortion_model (camera_info), found "
       "nothing"},
      {"KalibrWithoutAName", kChain,
       "camera.yaml: expected one of its cameras behind the file's name, as camera.yaml#cam0 (it "
       "has cam0, cam1), found none"},
      {"KalibrOfAnotherModel", replaced(one, "pinhole", "fish"),
       "camera.yaml:3: cam0.camera_model: expected pinhole, omni, ds or eucm, found 'fish'"},
      {"KalibrOfAnotherDistortion", replaced(one, "equidistant", "fov"),
       "camera.yaml:5: cam0.distortion_model: expected radtan, equidistant or none with "
       "camera_model pinhole, found 'fov'"},
      {"KalibrWithTooFewIntrinsics", replaced(one, ", 238.6", ""),
       "camera.yaml:6: cam0.intrinsics: expected a list of 4 numbers, found a list of 3"},
      {"KalibrWithoutFocalLength", replaced(one, "312.4", "0"),
       "camera.yaml:6: cam0.intrinsics: expected focal lengths > 0"},
      {"KalibrOutOfTheDomain", kalibr("ds", "0.1, 1.2, 100, 100, 320, 240", "none", ""),
       "camera.yaml:3: cam0.intrinsics: expected a number >= 0 and <= 1 as alpha"},
      {"KalibrWithDistortedSpheres", kalibr("ds", "0.1, 0.2, 100, 100, 320, 240", "radtan", "1"),
       "camera.yaml:4: cam0.distortion_model: expected none with this camera_model"},
      {"KalibrWithHalfPixels", replaced(one, "[640, 480]", "[640.5, 480]"),
       "camera.yaml:7: cam0.resolution: expected the image's width and height in pixels"},
      {"OpenCvWithoutASize", replaced(many, "image_width", "width"),
       "camera.yaml:3: image_width: expected an integer >= 1 and <= 32768, found nothing"},
      {"OpenCvRational", stored((cv::Mat_<double>(1, 8) << 0, 0, 0, 0, 0, 1, 0, 0), ""),
       "camera.yaml:11: distortion_coefficients: expected k1, k2, p1, p2, k3 and 0 for all others"},
      {"OpenCvFisheyeOfFive", stored(cv::Mat::zeros(1, 5, CV_64F), "fisheye_model: 1\n"),
       "camera.yaml:11: distortion_coefficients: expected 4 numbers, as a calibration of fisheye "
       "has, found 5"},
      {"InfoOfAnotherDistortion", replaced(info, "equidistant", "fov"),
       "camera.yaml:8: distortion_model: expected one of equidistant, fisheye, plumb_bob, "
       "rational_polynomial, found 'fov'"},
      {"InfoWithoutFocalLengths", replaced(info, "312.4", "0"),
       "camera.yaml:4: camera_matrix: expected the 9 numbers of a camera matrix"},
      {"InfoOfThree", replaced(info, "-0.01, ", ""),
       "camera.yaml:9: distortion_coefficients: expected 4 numbers, found 3"},
      {"InfoOfAPartBeyondTheSensor",
       infoMessage("", "roi: {x_offset: 600, y_offset: 0, width: 100, height: 100}\n"),
       "camera.yaml:1: roi: expected a part of the image of 640 pixels, found x_offset 600, width "
       "100"},
  };
}

INSTANTIATE_TEST_SUITE_P(, BadForeignFile, testing::ValuesIn(refusals()),
                         [](const auto& info) { return info.param.name; });

TEST(ForeignFile, isNamedWithItsCamera) {
  const std::string path = written("foreign_chain.yaml", kChain);
  const auto refusal = [](const std::string& file) -> std::string {
    try {
      loadCamera(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(path + "#cam7"),
            path + ": expected one of its cameras behind the file's name, as " + path +
                "#cam0 (it has cam0, cam1), found 'cam7'");
  EXPECT_EQ(refusal("no/such.yaml#cam0"), "no/such.yaml: expected a readable file, found none");
  const std::string own =
      written("foreign_own.yaml", "{model: equirectangular, image: {width: 20, height: 10}}\n");
  EXPECT_EQ(refusal(own), "");
  EXPECT_EQ(refusal(own + "#cam0"),
            own +
                ":1: expected one of several cameras, as Kalibr writes them, by the name 'cam0', "
                "found another file");
}

}  // namespace
}  // namespace omnitag
