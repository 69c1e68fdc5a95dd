// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network.hpp"

#include <gmock/gmock.h>

#include "common/inference/tests/test_network.hpp"

namespace weft::inference {
namespace {

using ::testing::HasSubstr;
using testing::OnnxModel;
using testing::TestFolder;
using testing::TestNetwork;

struct NetworkTest : ::testing::Test {
  TestFolder folder;

  std::string refusal(const TestNetwork& network, const OnnxModel& model) const {
    const auto opened = Network::open(network.write(folder, model.bytes()));
    return opened ? "" : opened.error().message;
  }
};

TEST_F(NetworkTest, GivesTheMapsByChannelAndCell) {
  TestNetwork network;
  network.cell(1, 2, 3) = 0.25F;
  network.cell(5, 29, 39) = -2.0F;
  network.node(2, 6, 9) = 0.5F;
  auto opened = Network::open(network.write(folder));
  ASSERT_TRUE(opened) << opened.error().message;
  const auto maps = opened->run(cv::Mat::zeros(120, 160, CV_32FC3), 1);
  ASSERT_TRUE(maps) << maps.error().message;
  ASSERT_EQ(maps->cells.size(), cv::Size(1200, 6));
  ASSERT_EQ(maps->vertices.size(), cv::Size(70, 3));
  EXPECT_EQ(maps->cells.at<float>(1, 2 * 40 + 3), 0.25F);
  EXPECT_EQ(maps->cells.at<float>(1, 2 * 40 + 4), 0.0F);
  EXPECT_EQ(maps->cells.at<float>(5, 1199), -2.0F);
  EXPECT_EQ(maps->vertices.at<float>(2, 69), 0.5F);
}

TEST_F(NetworkTest, SeesRedGreenAndBlueInThisOrder) {
  TestNetwork network;
  for (std::size_t c = 0; c < 3; ++c) network.from_rgb[4 * c] = 1.0F;  // channel c is colour c
  auto opened = Network::open(network.write(folder));
  ASSERT_TRUE(opened) << opened.error().message;
  cv::Mat image(120, 160, CV_32FC3, cv::Scalar(10.0, 20.0, 30.0));
  image(cv::Rect(8, 4, 4, 4)).setTo(cv::Scalar(110.0, 120.0, 130.0));
  const auto maps = opened->run(image, 1);
  ASSERT_TRUE(maps) << maps.error().message;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(maps->cells.at<float>(c, 0), 10.0F * static_cast<float>(c + 1), 1e-3);
    EXPECT_NEAR(maps->cells.at<float>(c, 40 + 2), 100.0F + 10.0F * static_cast<float>(c + 1), 1e-3);
  }
}

TEST_F(NetworkTest, GivesTheSameForAnyNumberOfThreadsAndLeavesTheirNumber) {
  TestNetwork network;
  network.from_rgb.fill(0.01F);
  auto opened = Network::open(network.write(folder));
  ASSERT_TRUE(opened) << opened.error().message;
  cv::Mat image(120, 160, CV_32FC3);
  cv::theRNG().state = 7;
  cv::randu(image, 0.0, 255.0);
  const int before = cv::getNumThreads();
  const auto one = opened->run(image, 1);
  ASSERT_TRUE(one) << one.error().message;
  const cv::Mat first = one->cells.clone();
  const auto several = opened->run(image, 64);
  ASSERT_TRUE(several) << several.error().message;
  EXPECT_EQ(cv::norm(first, several->cells, cv::NORM_INF), 0.0);
  const auto other = opened->run(cv::Mat::zeros(120, 160, CV_32FC3), 1);
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_GT(cv::norm(first, other->cells, cv::NORM_INF), 1.0);
  EXPECT_EQ(cv::norm(first, one->cells, cv::NORM_INF), 0.0) << "a later call changed an answer";
  EXPECT_EQ(cv::getNumThreads(), before);
}

TEST_F(NetworkTest, MustHaveTheSizesOfItsFile) {
  const TestNetwork network;
  TestNetwork other;
  other.grid_rows = 6;
  EXPECT_THAT(refusal(network, other.model()),
              HasSubstr("'vertices' has the size 1 x 3 x 60, but"));
  other = network;
  other.step_px = 8;
  EXPECT_THAT(refusal(network, other.model()), HasSubstr("'cells' has the size 1 x 6 x 15 x 20"));
  EXPECT_EQ(refusal(network, network.model()), "");
}

TEST_F(NetworkTest, MustGiveFiniteNumbers) {
  TestNetwork network;
  network.from_rgb[0] = 3e38F;  // finite, but not times 128
  EXPECT_THAT(refusal(network, network.model()), HasSubstr("'cells' is not finite"));
}

TEST_F(NetworkTest, ThatOpenCvCannotRunIsAnError) {
  const TestNetwork network;
  OnnxModel model = network.model();
  model.nodes[1].inputs[0] = "nowhere";
  EXPECT_THAT(refusal(network, model), HasSubstr("net.onnx: OpenCV cannot"));
  model = network.model();
  model.tensors[0] = testing::f32_tensor("kernel", {6, 3, 4}, std::vector<float>(72));
  EXPECT_THAT(refusal(network, model), HasSubstr("net.onnx: "));
}

TEST_F(NetworkTest, ThatIsDamagedIsNeverOpened) {
  const TestNetwork network;
  const std::string whole = network.model().bytes();
  const auto refused = [&](const std::string& onnx) {
    return !Network::open(network.write(folder, onnx));
  };
  // The hash is that of the damaged file, so that the scan alone protects OpenCV.
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    EXPECT_TRUE(refused(whole.substr(0, length))) << length;
  }
  OnnxModel model = network.model();
  model.nodes[1].op = "NonMaxSuppression";
  EXPECT_THAT(refusal(network, model), HasSubstr("operator 'NonMaxSuppression'"));
  EXPECT_FALSE(Network::check(folder.file("none.yaml")));
  EXPECT_TRUE(Network::check(network.write(folder)));
}

}  // namespace
}  // namespace weft::inference
