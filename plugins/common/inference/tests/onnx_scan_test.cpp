// SPDX-License-Identifier: Apache-2.0
#include "common/inference/onnx_scan.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>
#include <weft/core/rng.hpp>

#include "common/inference/tests/test_network.hpp"

namespace weft::inference {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace testing;  // NOLINT: the writer of networks

std::string reason(const std::string& bytes) {
  const auto scanned = scan_onnx(bytes);
  return scanned ? "" : scanned.error().message;
}

TEST(OnnxScan, ListsOperatorsInputsOutputsAndWeights) {
  const TestNetwork network;
  const auto found = scan_onnx(network.model().bytes());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->operators, ElementsAre("Conv", "Add", "Conv", "Flatten", "Gemm", "Reshape"));
  EXPECT_THAT(found->inputs, ElementsAre("image"));
  EXPECT_THAT(found->outputs, ElementsAre("cells", "vertices"));
  const std::int64_t weights = 6 * 3 * 16 + 6 + 6 * 1200 + 3 + 1 + 210 * 20 + 210 + 3;
  EXPECT_EQ(found->weights, weights);
}

TEST(OnnxScan, RefusesEveryTruncation) {
  const std::string whole = TestNetwork().model().bytes();
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    EXPECT_NE(reason(whole.substr(0, length)), "") << length;
  }
  for (std::size_t cut = 1; cut < 40; ++cut) {
    EXPECT_NE(reason(whole.substr(0, whole.size() - cut)), "") << cut;
  }
}

TEST(OnnxScan, NamesTheTensorThatIsNotFinite) {
  for (const float value : {std::nanf(""), INFINITY, -INFINITY}) {
    for (const bool lists_floats : {false, true}) {
      OnnxModel model = TestNetwork().model();
      model.tensors[2] = f32_tensor("poisoned", {3}, {1.0F, value, 2.0F});
      model.tensors[2].lists_floats = lists_floats;
      EXPECT_THAT(reason(model.bytes()), HasSubstr("not finite in 'poisoned'")) << value;
    }
  }
}

TEST(OnnxScan, RefusesSizesThatTheFileDoesNotHave) {
  OnnxModel model = TestNetwork().model();
  model.tensors[2].dims = {2500000000U};  // 10 GB
  EXPECT_THAT(reason(model.bytes()), HasSubstr("'maps' claim more elements than the file"));
  model.tensors[2].dims = {1U << 31U, 1U << 31U, 1U << 31U};
  EXPECT_THAT(reason(model.bytes()), HasSubstr("claim more elements"));
  model.tensors[2].dims = {~std::uint64_t{0}};  // -1
  EXPECT_THAT(reason(model.bytes()), HasSubstr("claim more elements"));
  model.tensors[2].dims = {7199};
  EXPECT_THAT(reason(model.bytes()), HasSubstr("should have 7199 elements, but have 7200"));
  model.tensors[2] = f32_tensor("maps", {2}, {1.0F, 2.0F});
  model.tensors[2].type = ElementType::i64;
  model.tensors[2].lists_floats = true;  // two floats for two whole numbers
  EXPECT_THAT(reason(model.bytes()), HasSubstr("should have 2 elements, but have 0"));
  const std::string claims = WireWriter().number(1, 6).torn_text(7, 10000000000U, "short").bytes();
  EXPECT_THAT(reason(claims), HasSubstr("cut off within the model"));
}

TEST(OnnxScan, RefusesWhatWeftDoesNotRun) {
  OnnxModel model = TestNetwork().model();
  model.nodes[1].op = "Einsum";
  EXPECT_THAT(reason(model.bytes()), HasSubstr("operator 'Einsum'"));
  model = TestNetwork().model();
  model.nodes[1].inputs.clear();
  EXPECT_THAT(reason(model.bytes()), HasSubstr("without inputs"));
  model = TestNetwork().model();
  model.tensors[3].type = ElementType::f16;
  EXPECT_THAT(reason(model.bytes()), HasSubstr("element type 10"));
  EXPECT_THAT(reason(""), HasSubstr("is empty"));
  EXPECT_THAT(reason("weft_network: 1\n"), HasSubstr("damaged"));
}

TEST(OnnxScan, RefusesWeightsInAnotherFile) {
  const std::string tensor =
      WireWriter().number(1, 1).number(2, 1).text(8, "far").number(14, 1).bytes();
  const std::string graph = WireWriter().text(5, tensor).bytes();
  EXPECT_THAT(reason(WireWriter().text(7, graph).bytes()), HasSubstr("'far' in another file"));
}

TEST(OnnxScan, EndsOnAnyBytes) {
  constexpr int kSeed = 11;
  std::cout << "seed " << kSeed << "\n";
  Rng rng(kSeed);
  const std::string whole = TestNetwork().model().bytes();
  constexpr std::uint32_t kStructure = 700;  // bytes of the nodes and of the first tensor's header
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = whole;
    for (int change = 0; change < 5; ++change) {
      bytes[rng.below(kStructure)] = static_cast<char>(rng.below(256));
    }
    refused += reason(bytes).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 2000);
}

TEST(OnnxScan, NamesTheOutputThatIsMissing) {
  const auto found = scan_onnx(TestNetwork().model().bytes());
  ASSERT_TRUE(found);
  EXPECT_TRUE(check_names(*found, "image", {"cells", "vertices"}));
  const auto missing = check_names(*found, "image", {"cells", "nodes"});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("no output 'nodes', but 'cells', 'vertices'"));
  EXPECT_FALSE(check_names(*found, "picture", {"cells"}));
}

}  // namespace
}  // namespace weft::inference
