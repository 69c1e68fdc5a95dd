// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdlib>
#include <iostream>
#include <weft/core/rng.hpp>

#include "common/inference/network.hpp"
#include "common/inference/onnx_scan.hpp"
#include "common/inference/tests/test_network.hpp"

namespace weft::inference {
namespace {

using ::testing::AllOf;
using testing::f32_tensor;
using ::testing::HasSubstr;
using testing::OnnxModel;
using testing::TestFolder;
using testing::TestNetwork;
using testing::Variable;

constexpr const char* kVariable = "WEFT_ONNXRUNTIME";

std::string refusal(const std::string& network, Runtime runtime = Runtime::onnxruntime) {
  const auto opened = Network::open(network, runtime);
  return opened ? "" : opened.error().message;
}

cv::Mat noise() {
  cv::Mat image(120, 160, CV_32FC3);
  cv::theRNG().state = 7;
  cv::randu(image, 0.0, 255.0);
  return image;
}

/// Tests of the errors of the library, which need no ONNX Runtime.
struct OnnxRuntimeLibrary : ::testing::Test {
  TestFolder folder;
  std::string network = TestNetwork().write(folder);

  std::string refusal_with(const std::string& library) const {
    const Variable set(kVariable, library);
    const auto checked = Engine::check(Runtime::onnxruntime);
    EXPECT_EQ(checked ? "" : checked.error().message, refusal(network));
    return refusal(network);
  }
};

TEST_F(OnnxRuntimeLibrary, ThatIsMissingIsNamedWithTheCorrection) {
  EXPECT_THAT(refusal_with(folder.file("none.so")),
              AllOf(HasSubstr("cannot be opened"), HasSubstr("none.so"),
                    HasSubstr("set WEFT_ONNXRUNTIME to the path")));
  testing::write_file(folder.file("text.so"), "no library");
  EXPECT_THAT(refusal_with(folder.file("text.so")), HasSubstr("text.so"));
  EXPECT_EQ(refusal(network, Runtime::opencv), "");
  EXPECT_TRUE(Engine::check(Runtime::opencv));
}

TEST_F(OnnxRuntimeLibrary, MustHaveTheEntryAndTheTable) {
  EXPECT_THAT(refusal_with("libm.so.6"), HasSubstr("libm.so.6 is not ONNX Runtime"));
  EXPECT_THAT(refusal_with(FAKE_RUNTIME),
              HasSubstr("is ONNX Runtime 0.4.2, but 1.11 or later is needed"));
}

TEST_F(OnnxRuntimeLibrary, ReportsFailedCallsInOneLine) {
  const Variable library(kVariable, FAKE_RUNTIME), table("WEFT_FAKE_TABLE", "1");
  EXPECT_TRUE(Engine::check(Runtime::onnxruntime));
  EXPECT_THAT(
      refusal(network),
      HasSubstr("net.onnx: ONNX Runtime cannot run this network: this library runs nothing"));
}

TEST(OnnxRuntimeScan, AcceptsOtherOperatorsButNoRandomNumbers) {
  const auto reason = [](const OnnxModel& model, Runtime runtime) {
    const auto scanned = scan_onnx(model.bytes(), runtime);
    return scanned ? "" : scanned.error().message;
  };
  OnnxModel model = TestNetwork().model();
  model.nodes[1].op = "Einsum";
  EXPECT_THAT(reason(model, Runtime::opencv), HasSubstr("operator 'Einsum'"));
  EXPECT_EQ(reason(model, Runtime::onnxruntime), "");
  for (const char* op : {"", "RandomUniformLike", "Bernoulli"}) {
    model.nodes[1].op = op;
    EXPECT_THAT(reason(model, Runtime::onnxruntime), HasSubstr("has the operator")) << op;
  }
  model = TestNetwork().model();
  model.nodes[1].domain = "com.microsoft";
  EXPECT_THAT(reason(model, Runtime::onnxruntime), HasSubstr("operator 'Add' of 'com.microsoft'"));
}

TEST(OnnxRuntimeScan, RefusesFormatsAndFunctionsThatItDoesNotScan) {
  const std::string model = TestNetwork().model().bytes();
  const std::string disguised = testing::WireWriter().text(2, "abORTM").bytes() + model;
  const auto other_format = scan_onnx(disguised, Runtime::onnxruntime);
  ASSERT_FALSE(other_format);
  EXPECT_THAT(other_format.error().message, HasSubstr("has the format ORT"));
  const auto functions = scan_onnx(model + testing::WireWriter().text(25, "").bytes());
  ASSERT_FALSE(functions);
  EXPECT_THAT(functions.error().message, HasSubstr("has functions"));
}

/// Tests with the library at WEFT_ONNXRUNTIME.
struct OnnxRuntimeTest : ::testing::Test {
  TestFolder folder;

  void SetUp() override {
    if (std::getenv(kVariable) == nullptr) {
      GTEST_SKIP() << "WEFT_ONNXRUNTIME is not set: no ONNX Runtime";
    }
  }
  std::string refusal_of(const TestNetwork& network, const OnnxModel& model) const {
    return refusal(network.write(folder, model.bytes()));
  }
};

TEST_F(OnnxRuntimeTest, AgreesWithOpenCvOnTheShippedNetwork) {
  const std::string path = SOURCE_FOLDER "/pipelines/data/networks/sheet.yaml";
  auto expected = Network::open(path), found = Network::open(path, Runtime::onnxruntime);
  ASSERT_TRUE(expected) << expected.error().message;
  ASSERT_TRUE(found) << found.error().message;
  const auto before = expected->run(noise(), 1), after = found->run(noise(), 1);
  ASSERT_TRUE(before && after);
  EXPECT_LT(cv::norm(before->cells, after->cells, cv::NORM_INF), 1e-4);
  EXPECT_LT(cv::norm(before->vertices, after->vertices, cv::NORM_INF), 1e-4);
  EXPECT_GT(cv::norm(before->cells, cv::NORM_INF), 1.0);
}

TEST_F(OnnxRuntimeTest, RunsAnOperatorThatOpenCvLacks) {
  TestNetwork network;
  network.cell(0, 2, 3) = 0.25F;
  std::vector<float> mirror;
  for (int cell = 0; cell < network.cell_count(); ++cell) {
    const int row = cell / network.columns(), column = cell % network.columns();
    mirror.push_back(1.0F - 2.0F * static_cast<float>(column) / 39.0F);
    mirror.push_back(2.0F * static_cast<float>(row) / 29.0F - 1.0F);
  }
  OnnxModel model = network.model();
  model.opset = 16;
  model.nodes[1].outputs[0] = "unmirrored";
  model.tensors.push_back(f32_tensor("grid", {1, 30, 40, 2}, mirror));
  model.nodes.push_back(
      {"GridSample", {"unmirrored", "grid"}, {"cells"}, {}, {{"align_corners", 1}}});
  const std::string path = network.write(folder, model.bytes());
  EXPECT_THAT(refusal(path, Runtime::opencv), HasSubstr("use runtime: onnxruntime"));
  auto opened = Network::open(path, Runtime::onnxruntime);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto maps = opened->run(noise(), 1);
  ASSERT_TRUE(maps) << maps.error().message;
  EXPECT_NEAR(maps->cells.at<float>(0, 2 * 40 + 36), 0.25F, 1e-5);
  EXPECT_NEAR(maps->cells.at<float>(0, 2 * 40 + 3), 0.0F, 1e-5);
}

TEST_F(OnnxRuntimeTest, GivesTheSameForAnyNumberOfThreads) {
  TestNetwork network;
  network.from_rgb.fill(0.01F);
  auto opened = Network::open(network.write(folder), Runtime::onnxruntime);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto one = opened->run(noise(), 1), several = opened->run(noise(), 3);
  ASSERT_TRUE(one && several);
  EXPECT_EQ(cv::norm(one->cells, several->cells, cv::NORM_INF), 0.0);
  const auto other = opened->run(cv::Mat::zeros(120, 160, CV_32FC3), 3);
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_GT(cv::norm(one->cells, other->cells, cv::NORM_INF), 1.0);
}

TEST_F(OnnxRuntimeTest, NamesTheReasonOfARefusal) {
  TestNetwork network;
  OnnxModel model = network.model();
  model.nodes[1].inputs[0] = "nowhere";
  EXPECT_THAT(refusal_of(network, model),
              AllOf(HasSubstr("net.onnx: ONNX Runtime cannot run"), HasSubstr("nowhere")));
  model = network.model();
  model.nodes[1].op = "Nonsense";
  EXPECT_THAT(refusal_of(network, model), HasSubstr("Nonsense"));
  model = network.model();
  model.inputs[0].dims[3] = 128;
  EXPECT_THAT(refusal_of(network, model), HasSubstr("net.onnx: ONNX Runtime cannot run"));
  TestNetwork coarse;
  coarse.step_px = 8;
  EXPECT_THAT(refusal_of(network, coarse.model()),
              HasSubstr("'cells' has the size 1 x 6 x 15 x 20"));
  model = network.model();
  model.outputs[0].name = "means";
  EXPECT_THAT(refusal_of(network, model), HasSubstr("no output 'cells'"));
  network.from_rgb[0] = 3e38F;  // finite, but not times 128
  EXPECT_THAT(refusal_of(network, network.model()), HasSubstr("'cells' is not finite"));
}

TEST_F(OnnxRuntimeTest, RefusesOutputsOfOtherTypes) {
  const TestNetwork network;
  OnnxModel model = network.model();
  model.nodes[1].outputs[0] = "numbers";
  model.nodes.push_back({"Cast", {"numbers"}, {"cells"}, {}, {{"to", 7}}});
  model.outputs[0].type = testing::ElementType::i64;
  EXPECT_THAT(refusal_of(network, model), HasSubstr("'cells' is not of type float32"));
}

TEST_F(OnnxRuntimeTest, SurvivesFilesThatPassTheScan) {
  constexpr int kSeed = 5;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const TestNetwork network;
  const std::string whole = network.model().bytes();
  int opened = 0, refused = 0;
  while (opened + refused < 60) {
    std::string bytes = whole;
    bytes[rng.below(700)] = static_cast<char>(rng.below(256));
    if (!scan_onnx(bytes, Runtime::onnxruntime)) continue;
    ++(refusal(network.write(folder, bytes)).empty() ? opened : refused);
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace weft::inference
