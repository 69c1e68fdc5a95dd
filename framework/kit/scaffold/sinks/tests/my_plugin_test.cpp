// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>

namespace {

using namespace weft::testing;
namespace fs = std::filesystem;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;

class MyPluginSink : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string params(const std::string& more = "") const {
    return "{path: \"" + folder_.string() + "\"" + more + "}";
  }

  const fs::path folder_ =
      fs::path(::testing::TempDir()) /
      (std::string("my_plugin_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

weft::Shape two_vertices(weft::ShapeState state) {
  weft::Shape shape;
  shape.vertices_m = weft::Array<double>({2, 3});
  for (int k = 0; k < 6; ++k) shape.vertices_m(k / 3, k % 3) = 0.1 * k + 1.0 / 3.0;
  shape.source = weft::Array<std::uint8_t>({2}, 1);
  shape.source(1) = 0;
  shape.state = static_cast<std::int32_t>(state);
  return shape;
}

TEST_F(MyPluginSink, WritesNumbersThatReadBackTheSame) {
  PluginUnderTest sink("sinks/my_plugin", params());
  ASSERT_EQ(sink.process(kOpen, {}).status, WEFT_OK);
  const weft::Shape shape = two_vertices(weft::ShapeState::estimated);
  const PluginAnswer answer = sink.process(kWrite, {input("shape", shape)}, 7);
  ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
  ASSERT_EQ(sink.process(kFinish, {}).status, WEFT_OK);

  std::ifstream file(folder_ / "000007.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "x_m,y_m,z_m,measured");
  for (int v = 0; v < 2; ++v) {
    ASSERT_TRUE(std::getline(file, line));
    std::istringstream cells(line);
    std::string cell;
    for (int k = 0; k < 3; ++k) {
      std::getline(cells, cell, ',');
      EXPECT_EQ(std::stod(cell), shape.vertices_m(v, k));
    }
    std::getline(cells, cell);
    EXPECT_EQ(cell, v == 0 ? "1" : "0");
  }
  EXPECT_FALSE(std::getline(file, line));
}

TEST_F(MyPluginSink, OmitsPredictedShapesByDefault) {
  for (const bool measured_only : {true, false}) {
    PluginUnderTest sink("sinks/my_plugin", params(measured_only ? "" : ", measured_only: false"));
    ASSERT_EQ(sink.process(kOpen, {}).status, WEFT_OK);
    const weft::Shape shape = two_vertices(weft::ShapeState::predicted);
    ASSERT_EQ(sink.process(kWrite, {input("shape", shape)}, 3).status, WEFT_OK);
    EXPECT_EQ(fs::exists(folder_ / "000003.csv"), !measured_only);
  }
}

}  // namespace
