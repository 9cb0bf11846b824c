#include "ros/image_input.h"

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
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

/// Two topics, both connected.
struct TwoSources {
  explicit TwoSources(int queue_size)
      : input(node, ros::NodeHandle("~"), {{"left", "raw"}, {"right", "raw"}}, queue_size) {
    while (left.getNumSubscribers() == 0 || right.getNumSubscribers() == 0) {
      ros::WallDuration(0.01).sleep();
    }
  }

  static void send(const ros::Publisher& publisher, unsigned second) {
    const sensor_msgs::ImagePtr image = blackImage(sensor_msgs::image_encodings::MONO8, 1);
    image->header.stamp = ros::Time(second, 0);
    publisher.publish(image);
  }

  ros::NodeHandle node;
  ros::Publisher left = node.advertise<sensor_msgs::Image>("left", 5);
  ros::Publisher right = node.advertise<sensor_msgs::Image>("right", 5);
  ImageInput input;
};

class ImageInputTest : public testing::Test {
 protected:
  ImageInputTest()
      : publisher_(node_.advertise<sensor_msgs::Image>("image", 1)),
        input_(node_, ros::NodeHandle("~"), {{}}, 1) {
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

TEST_F(ImageInputTest, givesTheOneThatHasWaitedLongestAndDropsOfEach) {
  TwoSources two(2);
  for (const unsigned second : {11U, 13U, 15U}) TwoSources::send(two.right, second);
  for (const unsigned second : {12U, 14U}) TwoSources::send(two.left, second);
  while (two.input.received() < 5) two.input.serve(0.1);
  EXPECT_EQ(two.input.dropped(), 1U);
  // The right one has waited since image 11, which gave way.
  for (const unsigned second : {13U, 12U, 14U, 15U}) {
    const std::optional<ReceivedImage> image = two.input.next(0.0);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->header.stamp, ros::Time(second, 0));
    EXPECT_EQ(two.input.topic(image->source),
              node_.resolveName(second % 2 == 0 ? "left" : "right"));
  }
  EXPECT_FALSE(two.input.next(0.0));
}

TEST_F(ImageInputTest, lookedAtRarelyGivesEachSourceItsTurn) {
  TwoSources two(1);
  std::string turns;
  for (unsigned pair = 0; pair < 6; ++pair) {
    // A pair comes at the same moment, and there is only time for one of them.
    for (const ros::Publisher& publisher : {two.left, two.right}) {
      TwoSources::send(publisher, 100 + pair);
    }
    while (two.input.received() < 2 * (pair + 1)) two.input.serve(0.1);
    const std::optional<ReceivedImage> image = two.input.next(0.0);
    ASSERT_TRUE(image);
    turns += image->source == 0 ? 'l' : 'r';
  }
  EXPECT_EQ(std::count(turns.begin(), turns.end(), 'l'), 3) << turns;
}

// The health monitor reads these from another thread until the very end.
TEST_F(ImageInputTest, tellsItsTopicWhenItIsClosed) {
  const std::string topic = input_.topic(0);
  EXPECT_EQ(topic, node_.resolveName("image"));
  EXPECT_EQ(input_.publishers(0), 1U);
  input_.close();
  EXPECT_EQ(input_.topic(0), topic);
  EXPECT_EQ(input_.publishers(0), 0U);
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "image_input_test");
  return RUN_ALL_TESTS();
}
