// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <weft/testing/synthetic.hpp>

#include "common/tests/scenes.hpp"
#include "tests/test_detector.hpp"

namespace weft::onnx {
namespace {

using detectors::constant_image;
using ::testing::HasSubstr;
using testing::OnnxModel;
using testing::TestFolder;
using testing::TestList;
using testing::TestMaps;
using weft::testing::input;
using weft::testing::PluginUnderTest;

struct OnnxRefusals : ::testing::Test {
  TestFolder folder;

  /// The message of the first image.
  template <class Network>
  std::string refusal(const Network& network, const OnnxModel& model) const {
    PluginUnderTest plugin("detectors/onnx", "{network: " + network.write(folder, model) + "}");
    return plugin.process(0, {input("image", constant_image(160, 120))}).message;
  }
};

TEST_F(OnnxRefusals, NameTheOutputOfAnotherSize) {
  TestMaps maps, wide;
  EXPECT_EQ(refusal(maps, maps.model()), "no keypoints");
  wide.image.width_px = 200;  // OpenCV runs a convolution on any size, but adds no other maps
  EXPECT_THAT(refusal(maps, wide.model()), HasSubstr("net.onnx: "));
  OnnxModel swapped = maps.model();
  swapped.nodes[0].outputs[0] = "descriptors";
  swapped.nodes[2].outputs[0] = "scores";
  EXPECT_THAT(refusal(maps, swapped),
              HasSubstr("the output 'scores' has the size 1 x 3 x 30 x 40"));
  OnnxModel strided = maps.model();
  strided.nodes[0].lists[1].second = {3, 3};
  EXPECT_THAT(refusal(maps, strided), HasSubstr("'scores' has the size 1 x 1 x 40 x 54, but"));
}

TEST_F(OnnxRefusals, NameListsOfOtherLengths) {
  TestList list;
  list.keypoints = {1, 2, 3, 4};
  list.scores = {1, 2};
  list.descriptors = {1, 2, 3, 4, 5, 6};
  const auto shaped = [&](std::size_t tensor, const std::vector<std::int64_t>& shape) {
    OnnxModel model = list.model();
    model.tensors[tensor] = inference::testing::i64_tensor(model.tensors[tensor].name, shape);
    return refusal(list, model);
  };
  EXPECT_EQ(shaped(4, {1, 2, 2}), "");
  EXPECT_THAT(shaped(4, {1, 4, 1}), HasSubstr("'keypoints' has the size 1 x 4 x 1, but"));
  EXPECT_THAT(shaped(4, {1, 1, 2, 2}), HasSubstr("'keypoints' has the size 1 x 1 x 2 x 2"));
  EXPECT_THAT(shaped(10, {1, 3, 2}), HasSubstr("'descriptors' has the size 1 x 3 x 2"));
  EXPECT_THAT(shaped(7, {1, 1, 2}), HasSubstr("'scores' has the size 1 x 1 x 2"));
}

TEST_F(OnnxRefusals, NameTheOutputThatIsNotFinite) {
  TestMaps maps;
  maps.image.scale = 1.0 / 128.0;
  maps.kernel.assign(25, 0.0F);
  maps.kernel[12] = 2e38F;  // finite for the grey image of the check, but not for a bright frame
  PluginUnderTest plugin("detectors/onnx", "{network: " + maps.write(folder) + "}");
  EXPECT_EQ(plugin.process(0, {input("image", constant_image(160, 120))}).status, WEFT_DEGENERATE);
  const auto bright = plugin.process(
      0, {input("image", detectors::image_of(160, 120, [](double, double) { return 255.0; }))});
  EXPECT_EQ(bright.status, WEFT_ERROR);
  EXPECT_THAT(bright.message, HasSubstr("the output 'scores' is not finite"));
  maps.kernel[12] = 3.4e38F;
  maps.image.scale = 1.0;
  EXPECT_THAT(refusal(maps, maps.model()), HasSubstr("the output 'scores' is not finite"));
}

TEST_F(OnnxRefusals, NameOperatorsInputsOutputsAndFiles) {
  const TestMaps maps;
  OnnxModel model = maps.model();
  model.nodes[2].op = "GridSample";
  EXPECT_THAT(refusal(maps, model), HasSubstr("operator 'GridSample' (node 'GridSample_descr"));
  model = maps.model();
  model.outputs[0].name = "heat";
  EXPECT_THAT(refusal(maps, model), HasSubstr("has no output 'scores', but 'heat'"));
  model = maps.model();
  model.inputs[0].name = "picture";
  EXPECT_THAT(refusal(maps, model), HasSubstr("has no input 'image', but 'picture'"));
  maps.write(folder);
  inference::testing::write_file(folder.file("net.onnx"), "other");
  PluginUnderTest plugin("detectors/onnx", "{network: " + folder.file("net.yaml") + "}");
  const auto prepared =
      plugin.prepare(weft::testing::make_template(), weft::testing::make_camera());
  ASSERT_FALSE(prepared);
  EXPECT_THAT(prepared.error().message, HasSubstr("net.onnx is not the file that"));
  EXPECT_THAT(prepared.error().message, HasSubstr("correct onnx_hash"));
  EXPECT_THROW(PluginUnderTest("detectors/onnx", "{}"), std::runtime_error);
}

TEST_F(OnnxRefusals, NameAnEmptyImageAndARegionOfAnotherSize) {
  PluginUnderTest plugin("detectors/onnx", "{network: " + TestMaps().write(folder) + "}");
  Image empty;
  empty.pixels = Array<std::uint8_t>({0, 0}, 0);
  EXPECT_THAT(plugin.process(0, {input("image", empty)}).message, HasSubstr("empty"));
  Region region;
  region.mask = Array<std::uint8_t>({10, 20}, 0);
  const auto mismatch =
      plugin.process(0, {input("image", constant_image(60, 50)), input("region", region)});
  EXPECT_EQ(mismatch.status, WEFT_ERROR);
  EXPECT_THAT(mismatch.message, HasSubstr("20 x 10 and the image 60 x 50"));
}

}  // namespace
}  // namespace weft::onnx
