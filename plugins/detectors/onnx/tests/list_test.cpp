// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdlib>
#include <list>

#include "common/tests/scenes.hpp"
#include "tests/test_detector.hpp"

namespace weft::onnx {
namespace {

using detectors::constant_image;
using detectors::detect;
using testing::TestFolder;
using testing::TestList;
using weft::testing::PluginUnderTest;

/// Three keypoints of a network with an image of 160 x 120 px.
struct OnnxList : ::testing::Test {
  TestFolder folder;
  TestList network;
  mutable std::list<PluginUnderTest> plugins;  ///< they own the keypoints

  OnnxList() {
    network.keypoints = {10.0F, 20.0F, 100.5F, 30.25F, 80.0F, 100.0F};
    network.scores = {0.9F, 0.2F, 0.5F};
    network.descriptors = {3.0F, 4.0F, -1.0F, 2.0F, 0.0F, -0.5F};
  }
  Keypoints found(const Image& image, const std::string& params = "") const {
    return detect(
        plugins.emplace_back("detectors/onnx", "{network: " + network.write(folder) + params + "}"),
        image);
  }
};

TEST_F(OnnxList, HasItsKeypointsInTheOrderOfTheSiblings) {
  const Keypoints keypoints = found(constant_image(160, 120));
  ASSERT_EQ(keypoints.count(), 3);
  const float expected[3][5] = {
      {10, 20, 0.9F, 3, 4}, {100.5F, 30.25F, 0.2F, -1, 2}, {80, 100, 0.5F, 0, -0.5F}};
  for (int n = 0; n < 3; ++n) {
    EXPECT_NEAR(keypoints.xy_px(n, 0), expected[n][0], 1e-4);
    EXPECT_NEAR(keypoints.xy_px(n, 1), expected[n][1], 1e-4);
    EXPECT_NEAR(keypoints.response(n), expected[n][2], 1e-6);
    EXPECT_EQ(keypoints.descriptors(n, 0), expected[n][3]);
    EXPECT_EQ(keypoints.descriptors(n, 1), expected[n][4]);
    EXPECT_EQ(keypoints.scale_px(n), 1.0);
    EXPECT_EQ(keypoints.angle_rad(n), 0.0);
    EXPECT_EQ(keypoints.octave(n), 0);
  }
}

TEST_F(OnnxList, IsReadInEachUnitAndOrder) {
  for (int kind = 0; kind < 8; ++kind) {
    const bool is_normalised = (kind & 1) != 0, is_yx = (kind & 2) != 0, halves = (kind & 4) != 0;
    TestList other = network;
    other.kind = std::string("units: ") + (is_normalised ? "normalised" : "px") +
                 ", order: " + (is_yx ? "yx" : "xy") +
                 ", centres: " + (halves ? "halves" : "integers");
    for (std::size_t i = 0; i < 6; ++i) {
      const float size_px = i % 2 == 0 ? 160.0F : 120.0F, place = network.keypoints[i];
      float written = halves ? place + 0.5F : place;
      // -1 and 1 are the edges of the image, or the centres of its outermost pixels.
      if (is_normalised) written = 2.0F * written / (halves ? size_px : size_px - 1.0F) - 1.0F;
      other.keypoints[is_yx ? i ^ 1U : i] = written;
    }
    PluginUnderTest plugin("detectors/onnx", "{network: " + other.write(folder) + "}");
    const Keypoints keypoints = detect(plugin, constant_image(160, 120));
    ASSERT_EQ(keypoints.count(), 3) << other.kind;
    for (std::int64_t n = 0; n < 3; ++n) {
      for (std::int64_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(keypoints.xy_px(n, k), network.keypoints[to_index(2 * n + k)], 1e-4)
            << other.kind;
      }
    }
  }
}

TEST_F(OnnxList, OmitsWeakKeypointsAndThoseOutsideTheFrame) {
  EXPECT_EQ(found(constant_image(160, 120), ", threshold: 0.3").count(), 2);
  // The frame fills the upper half of the network's image, 60 of 120 rows.
  EXPECT_EQ(found(constant_image(160, 60)).count(), 2);
  network.keypoints[0] = -0.6F;
  network.keypoints[2] = 1e30F;
  EXPECT_EQ(found(constant_image(160, 120)).count(), 1);
}

TEST_F(OnnxList, IsMappedToFramesOfOtherSizes) {
  // 400 x 300 px: 2.5 px of the frame for each px of the network's image.
  const Keypoints keypoints = found(constant_image(400, 300));
  ASSERT_EQ(keypoints.count(), 3);
  EXPECT_NEAR(keypoints.xy_px(0, 0), 2.5 * 10.5 - 0.5, 1e-4);
  EXPECT_NEAR(keypoints.xy_px(0, 1), 2.5 * 20.5 - 0.5, 1e-4);
  EXPECT_NEAR(keypoints.xy_px(1, 0), 2.5 * 101.0 - 0.5, 1e-4);
  EXPECT_NEAR(keypoints.scale_px(0), 2.5, 1e-6);
}

TEST_F(OnnxList, MayHaveNoScores) {
  network.has_scores = false;
  const Keypoints keypoints = found(constant_image(160, 120), ", threshold: 100");
  ASSERT_EQ(keypoints.count(), 3);
  for (int n = 0; n < 3; ++n) EXPECT_EQ(keypoints.response(n), 1.0);
}

TEST_F(OnnxList, MayHaveOneKeypointOnly) {
  network.keypoints.resize(2);
  network.scores.resize(1);
  network.descriptors.resize(2);
  const Keypoints keypoints = found(constant_image(160, 120));
  ASSERT_EQ(keypoints.count(), 1);
  EXPECT_NEAR(keypoints.xy_px(0, 1), 20.0, 1e-4);
}

TEST_F(OnnxList, HasUnitOrBinaryDescriptorsOnRequest) {
  network.metric = "l2, normalise: true";
  const Keypoints unit = found(constant_image(160, 120));
  EXPECT_NEAR(unit.descriptors(0, 0), 0.6F, 1e-6);
  EXPECT_NEAR(unit.descriptors(0, 1), 0.8F, 1e-6);
  network.metric = "hamming, normalise: false";
  const Keypoints bits = found(constant_image(160, 120));
  EXPECT_EQ(bits.metric, "hamming");
  ASSERT_EQ(bits.binary_descriptors.dim(1), 1);
  EXPECT_EQ(bits.binary_descriptors(0, 0), 0b11000000);
  EXPECT_EQ(bits.binary_descriptors(1, 0), 0b01000000);
  EXPECT_EQ(bits.binary_descriptors(2, 0), 0);
}

/// The network selects the keypoints whose score is not 0, by operators that OpenCV lacks.
TEST_F(OnnxList, MayHaveAnyLengthWithOnnxRuntime) {
  if (std::getenv("WEFT_ONNXRUNTIME") == nullptr) {
    GTEST_SKIP() << "WEFT_ONNXRUNTIME is not set: no ONNX Runtime";
  }
  const auto answer = [&](const std::vector<float>& scores) {
    network.scores = scores;
    inference::testing::OnnxModel model = network.model();
    model.opset = 13;
    const std::vector<std::int64_t> one = {1};
    model.tensors.push_back(
        {"one", {}, inference::testing::raw(one), inference::testing::ElementType::i64});
    for (std::size_t i = model.nodes.size() - 5; i < model.nodes.size(); i += 2) {
      model.nodes[i].outputs[0] += "_of_all";
    }
    model.nodes.push_back({"NonZero", {"scores_of_all"}, {"places"}});
    model.nodes.push_back({"Gather", {"places", "one"}, {"selected"}, {}, {{"axis", 0}}});
    for (const std::string name : {"keypoints", "scores", "descriptors"}) {
      model.nodes.push_back({"Gather", {name + "_of_all", "selected"}, {name}, {}, {{"axis", 1}}});
    }
    PluginUnderTest& plugin = plugins.emplace_back(
        "detectors/onnx", "{network: " + network.write(folder, model) + ", runtime: onnxruntime}");
    return plugin.process(0, {weft::testing::input("image", constant_image(160, 120))});
  };
  const auto two = answer({0.9F, 0.0F, 0.5F});
  ASSERT_EQ(two.status, WEFT_OK) << two.message;
  const Keypoints keypoints = two.get<Keypoints>().value();
  ASSERT_EQ(keypoints.count(), 2);
  EXPECT_NEAR(keypoints.xy_px(1, 0), 80.0, 1e-4);
  EXPECT_EQ(keypoints.descriptors(1, 1), -0.5F);
  const auto none = answer({0.0F, 0.0F, 0.0F});
  EXPECT_EQ(none.status, WEFT_DEGENERATE) << none.message;
  EXPECT_EQ(none.message, "no keypoints");
}

TEST_F(OnnxList, NamesTheRuntimeThatCannotBeOpened) {
  const inference::testing::Variable library("WEFT_ONNXRUNTIME", "/none.so");
  PluginUnderTest plugin("detectors/onnx",
                         "{network: " + network.write(folder) + ", runtime: onnxruntime}");
  const auto refused = plugin.process(0, {weft::testing::input("image", constant_image(160, 120))});
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, ::testing::HasSubstr("ONNX Runtime cannot be opened: /none.so"));
}

}  // namespace
}  // namespace weft::onnx
