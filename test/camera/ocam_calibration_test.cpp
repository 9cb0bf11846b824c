#include "camera/ocam_calibration.h"

#include <gtest/gtest.h>

#include <string>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

const std::string kResults =
    R"(#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). These are used by cam2world

5 -2.895569e+02 0.000000e+00 1.538894e-03 -3.140320e-06 7.206996e-09

#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). These are used by world2cam

3 434.372025 226.016722 -31.205890

#center: "row" and "column", starting from 0 (C convention)

390.949324 423.714757

#affine parameters "c", "d", "e"

0.999134 -0.000325 -0.000071

#image size: "height" and "width"

800 848
)";

std::string refusalOf(const std::string& text) {
  try {
    parseOcamCalibration(text, "results.txt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kResults;
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

TEST(OcamCalibration, isReadInTheToolboxsOrder) {
  const OcamCalibration calibration = parseOcamCalibration(kResults, "results.txt");
  EXPECT_EQ(calibration.polynomial,
            (std::vector<double>{-289.5569, 0.0, 1.538894e-3, -3.14032e-6, 7.206996e-9}));
  EXPECT_EQ(calibration.center_row, 390.949324);
  EXPECT_EQ(calibration.center_column, 423.714757);
  EXPECT_EQ(calibration.c, 0.999134);
  EXPECT_EQ(calibration.d, -0.000325);
  EXPECT_EQ(calibration.e, -0.000071);
  EXPECT_EQ(calibration.image_size.height, 800);
  EXPECT_EQ(calibration.image_size.width, 848);
}

TEST(OcamCalibration, isRefusedInOneLineThatTellsWhere) {
  EXPECT_EQ(refusalOf(""),
            "results.txt:1: number of coefficients: expected an integer from 1 to 64, found the "
            "file's end");
  EXPECT_EQ(refusalOf(replaced("1.538894e-03", "1.5e-3x")),
            "results.txt:3: coefficient a2: expected a number, found '1.5e-3x'");
  EXPECT_EQ(refusalOf(replaced("-3.140320e-06", "nan")),
            "results.txt:3: coefficient a3: expected a number, found 'nan'");
  EXPECT_EQ(refusalOf(replaced("5 -2.89", "5.5 -2.89")),
            "results.txt:3: number of coefficients: expected an integer from 1 to 64, found '5.5'");
  EXPECT_EQ(refusalOf(replaced("800 848", "800")),
            "results.txt:19: image width: expected an integer from 1 to 32768, found the file's "
            "end");
  EXPECT_EQ(refusalOf(replaced("800 848", "800 848 7")),
            "results.txt:19: after the image size: expected nothing more, found '7'");
  EXPECT_EQ(refusalOf(replaced("800 848", "0 848")),
            "results.txt:19: image height: expected an integer from 1 to 32768, found '0'");
}

}  // namespace
}  // namespace omnitag
