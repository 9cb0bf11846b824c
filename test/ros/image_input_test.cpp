#include "omnitag/ros/image_input.h"

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <cstdint>
#include <optional>
#include <string>

namespace omnitag {
namespace {

sensor_msgs::ImagePtr blackImage(const std::string& encoding, std::uint32_t bytes_per_pixel) {
  constexpr std::uint32_t kSide = 20;
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.frame_id = "camera";
  image->header.stamp = ros::Time(12, 34);
  image->encoding = encoding;
  image->width = kSide;
  image->height = kSide;
  image->step = kSide * bytes_per_pixel;
  image->data.assign(kSide * image->step, 0);
  return image;
}

class ImageInputTest : public testing::Test {
 protected:
  ImageInputTest()
      : publisher_(node_.advertise<sensor_msgs::Image>("image", 1)),
        input_(node_, ros::NodeHandle("~"), "raw", 1) {
    spinner_.start();
    while (publisher_.getNumSubscribers() == 0) ros::WallDuration(0.01).sleep();
  }

  cv_bridge::CvImageConstPtr send(const sensor_msgs::ImageConstPtr& image) {
    publisher_.publish(image);
    constexpr double kWait = 1.0;  // s
    std::optional<ReceivedImage> received;
    while (!received) received = input_.next(kWait);
    return received->decode();
  }

  ros::AsyncSpinner spinner_{1};
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ImageInput input_;
};

TEST_F(ImageInputTest, takesGrayImagesOfItsOwnProcessWithoutACopy) {
  const sensor_msgs::ImagePtr sent = blackImage(sensor_msgs::image_encodings::MONO8, 1);
  const cv_bridge::CvImageConstPtr received = send(sent);
  EXPECT_EQ(received->header.stamp, sent->header.stamp);
  EXPECT_EQ(static_cast<const void*>(received->image.data), sent->data.data());
}

TEST_F(ImageInputTest, convertsColorsIntoAnImageOfItsOwn) {
  const sensor_msgs::ImagePtr sent = blackImage(sensor_msgs::image_encodings::BGR8, 3);
  const cv_bridge::CvImageConstPtr received = send(sent);
  EXPECT_EQ(received->image.type(), CV_8UC1);
  EXPECT_NE(static_cast<const void*>(received->image.data), sent->data.data());
}

// The health monitor reads these from another thread until the very end.
TEST_F(ImageInputTest, tellsItsTopicWhenItIsClosed) {
  const std::string topic = input_.topic();
  EXPECT_EQ(topic, node_.resolveName("image"));
  EXPECT_EQ(input_.publishers(), 1U);
  input_.close();
  EXPECT_EQ(input_.topic(), topic);
  EXPECT_EQ(input_.publishers(), 0U);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "image_input_test");
  return RUN_ALL_TESTS();
}
