#include "ros/image_conversion.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr std::uint32_t kWidth = 12;
constexpr std::uint32_t kHeight = 8;

/// A color's luma (ITU-R BT.601).
double luma(double red, double green, double blue) {
  return 0.299 * red + 0.587 * green + 0.114 * blue;
}

/// An image whose rows are `padding` bytes longer than their pixels; the padding is not black.
sensor_msgs::ImagePtr makeImage(const std::string& encoding, std::size_t bytes_per_pixel,
                                const std::function<std::vector<std::uint8_t>(int, int)>& pixel,
                                std::uint32_t padding = 0) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.frame_id = "camera";
  image->header.stamp = ros::Time(12, 34);
  image->encoding = encoding;
  image->width = kWidth;
  image->height = kHeight;
  image->step = kWidth * static_cast<std::uint32_t>(bytes_per_pixel) + padding;
  for (int v = 0; v < static_cast<int>(kHeight); ++v) {
    for (int u = 0; u < static_cast<int>(kWidth); ++u) {
      const std::vector<std::uint8_t> bytes = pixel(u, v);
      EXPECT_EQ(bytes.size(), bytes_per_pixel);
      image->data.insert(image->data.end(), bytes.begin(), bytes.end());
    }
    image->data.insert(image->data.end(), padding, 77);
  }
  return image;
}

std::uint8_t ramp(int u, int v) { return static_cast<std::uint8_t>(10 * u + 15 * v); }

void expectRamp(const cv_bridge::CvImageConstPtr& gray, int tolerance) {
  ASSERT_EQ(gray->image.type(), CV_8UC1);
  ASSERT_EQ(gray->image.size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(gray->header.frame_id, "camera");
  EXPECT_EQ(gray->header.stamp, ros::Time(12, 34));
  for (int v = 0; v < gray->image.rows; ++v) {
    for (int u = 0; u < gray->image.cols; ++u) {
      ASSERT_NEAR(gray->image.at<std::uint8_t>(v, u), ramp(u, v), tolerance)
          << "at " << u << ", " << v;
    }
  }
}

std::string refusalOf(const sensor_msgs::ImageConstPtr& image) {
  try {
    grayImage(image);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class Padded : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Padded, GrayOf8Bits) {
  for (const std::string& encoding : {encodings::MONO8, encodings::TYPE_8UC1}) {
    const sensor_msgs::ImagePtr image = makeImage(
        encoding, 1, [](int u, int v) { return std::vector<std::uint8_t>{ramp(u, v)}; },
        GetParam());
    const cv_bridge::CvImageConstPtr gray = grayImage(sensor_msgs::ImageConstPtr(image));
    expectRamp(gray, 0);
    EXPECT_EQ(gray->image.data, image->data.data()) << "was copied";
  }
}

TEST_P(Padded, GrayOf16Bits) {
  for (const std::string& encoding : {encodings::MONO16, encodings::TYPE_16UC1}) {
    for (const bool is_big_endian : {false, true}) {
      const sensor_msgs::ImagePtr image = makeImage(
          encoding, 2,
          [is_big_endian](int u, int v) {
            return is_big_endian ? std::vector<std::uint8_t>{ramp(u, v), 100}
                                 : std::vector<std::uint8_t>{100, ramp(u, v)};
          },
          GetParam());
      image->is_bigendian = static_cast<std::uint8_t>(is_big_endian);
      expectRamp(grayImage(sensor_msgs::ImageConstPtr(image)), 0);
    }
  }
}

TEST_P(Padded, Colors) {
  struct Case {
    std::string encoding;
    std::vector<std::size_t> red_green_blue;
    std::size_t channels;
  };
  for (const Case& c :
       {Case{encodings::RGB8, {0, 1, 2}, 3}, Case{encodings::BGR8, {2, 1, 0}, 3},
        Case{encodings::RGBA8, {0, 1, 2}, 4}, Case{encodings::BGRA8, {2, 1, 0}, 4}}) {
    const auto pixel = [&c](int u, int v) {
      std::vector<std::uint8_t> bytes(c.channels, 255);
      bytes[c.red_green_blue[0]] = ramp(u, v);
      bytes[c.red_green_blue[1]] = static_cast<std::uint8_t>(255 - ramp(u, v));
      bytes[c.red_green_blue[2]] = 40;
      return bytes;
    };
    const sensor_msgs::ImagePtr image = makeImage(c.encoding, c.channels, pixel, GetParam());
    const cv_bridge::CvImageConstPtr gray = grayImage(sensor_msgs::ImageConstPtr(image));
    for (int v = 0; v < gray->image.rows; ++v) {
      for (int u = 0; u < gray->image.cols; ++u) {
        ASSERT_NEAR(gray->image.at<std::uint8_t>(v, u), luma(ramp(u, v), 255 - ramp(u, v), 40), 1.0)
            << c.encoding;
      }
    }
  }
}

TEST_P(Padded, BayerOfOneColor) {
  static constexpr std::uint8_t kRed = 200;
  static constexpr std::uint8_t kGreen = 90;
  static constexpr std::uint8_t kBlue = 30;
  // The colors of the upper left two by two pixels, row by row.
  const std::vector<std::pair<std::string, std::string>> patterns = {
      {encodings::BAYER_RGGB8, "rggb"},
      {encodings::BAYER_BGGR8, "bggr"},
      {encodings::BAYER_GBRG8, "gbrg"},
      {encodings::BAYER_GRBG8, "grbg"}};
  for (const auto& [encoding, pattern] : patterns) {
    const auto pixel = [&pattern = pattern](int u, int v) {
      const char color = pattern[static_cast<std::size_t>(2 * (v % 2) + u % 2)];
      return std::vector<std::uint8_t>{color == 'r' ? kRed : (color == 'g' ? kGreen : kBlue)};
    };
    const sensor_msgs::ImagePtr image = makeImage(encoding, 1, pixel, GetParam());
    const cv_bridge::CvImageConstPtr gray = grayImage(sensor_msgs::ImageConstPtr(image));
    for (int v = 1; v + 1 < gray->image.rows; ++v) {
      for (int u = 1; u + 1 < gray->image.cols; ++u) {
        ASSERT_NEAR(gray->image.at<std::uint8_t>(v, u), luma(kRed, kGreen, kBlue), 2.0) << encoding;
      }
    }
  }
}

TEST_P(Padded, Yuv422) {
  const sensor_msgs::ImagePtr image = makeImage(
      encodings::YUV422, 2,
      [](int u, int v) {
        return std::vector<std::uint8_t>{128, ramp(u, v)};
      },
      GetParam());
  expectRamp(grayImage(sensor_msgs::ImageConstPtr(image)), 1);
}

TEST_P(Padded, BayerOf16Bits) {
  const sensor_msgs::ImagePtr image = makeImage(
      encodings::BAYER_RGGB16, 2,
      [](int, int) {
        return std::vector<std::uint8_t>{0, 150};
      },
      GetParam());
  const cv_bridge::CvImageConstPtr gray = grayImage(sensor_msgs::ImageConstPtr(image));
  ASSERT_EQ(gray->image.type(), CV_8UC1);
  EXPECT_NEAR(gray->image.at<std::uint8_t>(3, 3), 150, 1);
}

INSTANTIATE_TEST_SUITE_P(Rows, Padded, testing::Values(0U, 4U, 52U));

sensor_msgs::ImagePtr goodImage() {
  return makeImage(encodings::MONO8, 1,
                   [](int u, int v) { return std::vector<std::uint8_t>{ramp(u, v)}; });
}

TEST(ImageConversion, RefusesShortAndLongData) {
  const sensor_msgs::ImagePtr image = goodImage();
  image->data.pop_back();
  EXPECT_EQ(refusalOf(image), "12 x 8 mono8 image: expected 96 bytes of data, found 95");
  image->data.clear();
  EXPECT_EQ(refusalOf(image), "12 x 8 mono8 image: expected 96 bytes of data, found 0");
  image->data.resize(97);
  EXPECT_EQ(refusalOf(image), "12 x 8 mono8 image: expected 96 bytes of data, found 97");
}

TEST(ImageConversion, RefusesRowsThatAreTooShort) {
  const sensor_msgs::ImagePtr image = goodImage();
  image->encoding = encodings::BGR8;
  EXPECT_EQ(refusalOf(image),
            "12 x 8 bgr8 image: expected a step of at least 36 bytes per row, found 12");
}

TEST(ImageConversion, RefusesSizesBeyondAnyMemory) {
  const sensor_msgs::ImagePtr image = goodImage();
  image->width = image->height = image->step = 4000000000U;
  EXPECT_NE(refusalOf(image), "");
}

TEST(ImageConversion, RefusesEmptyImages) {
  const sensor_msgs::ImagePtr image = goodImage();
  image->width = 0;
  EXPECT_EQ(refusalOf(image), "0 x 8 mono8 image: expected at least one pixel");
}

TEST(ImageConversion, RefusesEncodingsThatAreNoImage) {
  const sensor_msgs::ImagePtr image = goodImage();
  image->encoding = "jpeg2000";
  EXPECT_NE(refusalOf(image).find("'jpeg2000' is unknown"), std::string::npos);
  image->encoding = "";
  EXPECT_NE(refusalOf(image).find("'' is unknown"), std::string::npos);
  const sensor_msgs::ImagePtr depth = makeImage(encodings::TYPE_32FC1, 4, [](int, int) {
    return std::vector<std::uint8_t>{0, 0, 0, 0};
  });
  EXPECT_NE(refusalOf(depth).find("'32FC1' cannot be shown in grey"), std::string::npos);
}

sensor_msgs::CompressedImageConstPtr compress(const std::string& extension) {
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) image.at<std::uint8_t>(v, u) = ramp(u, v);
  }
  auto message = boost::make_shared<sensor_msgs::CompressedImage>();
  message->header.frame_id = "camera";
  message->header.stamp = ros::Time(12, 34);
  message->format = "mono8; " + extension + " compressed";
  cv::imencode("." + extension, image, message->data);
  return message;
}

TEST(ImageConversion, DecodesCompressedImages) {
  expectRamp(grayImage(compress("png")), 0);
  expectRamp(grayImage(compress("jpg")), 4);
}

TEST(ImageConversion, RefusesWhatCannotBeDecoded) {
  auto message = boost::make_shared<sensor_msgs::CompressedImage>();
  message->format = "jpeg";
  const sensor_msgs::CompressedImageConstPtr constant = message;
  EXPECT_THROW(grayImage(constant), InputError);
  message->data = {1, 2, 3, 4, 5};
  EXPECT_THROW(grayImage(constant), InputError);
}

}  // namespace
}  // namespace omnitag
