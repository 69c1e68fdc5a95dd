// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/npy.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using weft::Array;
using weft::Camera;
using weft::GroundTruth;
using weft::Image;
using weft::to_index;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
constexpr std::int64_t kWidth = 32, kHeight = 24;  // pixels of the frame: twice the small image

const std::string kSmall =
    ", width_px: 16, height_px: 12, cell_px: 4, columns: 3, rows: 2, shard_frames: 2";

Camera camera() { return {40.0, 40.0, 15.5, 11.5, kWidth, kHeight}; }

/// The object fills the image at a distance of 0.4 m: the pixel x sees the share (x + 1/2) / 32.
const weft::Template& object() {
  static const weft::Template kObject = weft::testing::make_template();
  return kObject;
}

Eigen::Vector2d pitch_m() { return {object().m_per_px(0), object().m_per_px(1)}; }

Eigen::Vector2d size_m() {
  const weft::Template& templ = object();
  return pitch_m().cwiseProduct(Eigen::Vector2d(static_cast<double>(templ.texture.dim(1)),
                                                static_cast<double>(templ.texture.dim(0))));
}

/// The pixels of the frame are 4 x + 2 y, for a check of the means.
Image image() {
  Image made{Array<std::uint8_t>({kHeight, kWidth}), "any"};
  for (std::int64_t y = 0; y < kHeight; ++y) {
    for (std::int64_t x = 0; x < kWidth; ++x) {
      made.pixels(y, x) = static_cast<std::uint8_t>(4 * x + 2 * y);
    }
  }
  return made;
}

GroundTruth truth() {
  GroundTruth made{Array<double>({4, 2}), Array<double>({4, 3}, 0.4), "made", ""};
  for (std::int64_t v = 0; v < 4; ++v) {
    made.template_xy_m(v, 0) = (v % 2 == 0 ? 0.0 : size_m().x()) - 0.5 * pitch_m().x();
    made.template_xy_m(v, 1) = (v < 2 ? 0.0 : size_m().y()) - 0.5 * pitch_m().y();
    made.points_m(v, 0) = v % 2 == 0 ? -0.16 : 0.16;
    made.points_m(v, 1) = v < 2 ? -0.12 : 0.12;
  }
  made.faces = Array<std::int32_t>({2, 3});
  const std::int32_t corners[] = {0, 2, 1, 1, 2, 3};
  std::copy_n(corners, 6, made.faces.data());
  made.visible = Array<std::uint8_t>({4}, 1);
  made.depth_m = Array<float>({kHeight, kWidth}, 0.4F);
  made.uv_m = Array<float>({kHeight, kWidth, 2});
  for (std::int64_t y = 0; y < kHeight; ++y) {
    for (std::int64_t x = 0; x < kWidth; ++x) {
      const Eigen::Vector2d share((static_cast<double>(x) + 0.5) / kWidth,
                                  (static_cast<double>(y) + 0.5) / kHeight);
      const Eigen::Vector2d uv_m = share.cwiseProduct(size_m()) - 0.5 * pitch_m();
      for (int k = 0; k < 2; ++k) made.uv_m.row(y)[2 * x + k] = static_cast<float>(uv_m[k]);
    }
  }
  return made;
}

template <class Value>
std::vector<Value> values_of(const fs::path& path, const std::vector<std::int64_t>& shape) {
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto header = weft::parse_npy(bytes);
  EXPECT_TRUE(header) << path;
  if (!header) throw std::runtime_error(path.string() + " cannot be read");
  EXPECT_EQ(header->shape, shape) << path;
  EXPECT_EQ(header->dtype, weft::dtype_of<Value>()) << path;
  std::vector<Value> values((bytes.size() - header->data_offset) / sizeof(Value));
  std::memcpy(values.data(), bytes.data() + header->data_offset, values.size() * sizeof(Value));
  return values;
}

class ShardsSink : public ::testing::Test {
 protected:
  ShardsSink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~ShardsSink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path path(const std::string& name) const { return folder_ / "shards" / name; }

  PluginUnderTest sink(const std::string& more = kSmall) const {
    return PluginUnderTest("sinks/shards", "{path: '" + path("").string() + "'" + more + "}");
  }

  static PluginAnswer write(PluginUnderTest& sink, const GroundTruth& truth) {
    return sink.process(kWrite, {input("image", image()), input("ground_truth", truth)});
  }

  void write_frames(const std::vector<GroundTruth>& truths) const {
    PluginUnderTest shards = sink();
    ASSERT_TRUE(shards.prepare(object(), camera()));
    ASSERT_EQ(shards.process(kOpen, {}).status, WEFT_OK);
    for (const GroundTruth& one : truths) {
      const PluginAnswer answer = write(shards, one);
      ASSERT_EQ(answer.status, WEFT_OK) << answer.message;
    }
    ASSERT_EQ(shards.process(kFinish, {}).status, WEFT_OK);
  }

  fs::path folder_;
};

TEST_F(ShardsSink, LabelsTheCentreOfEachCell) {
  write_frames({truth()});
  const auto uv = values_of<std::uint16_t>(path("000000/uv.npy"), {1, 3, 4, 2});
  const auto depth = values_of<std::uint16_t>(path("000000/depth.npy"), {1, 3, 4});
  const auto mask = values_of<std::uint8_t>(path("000000/mask.npy"), {1, 3, 4});
  ASSERT_EQ(uv.size(), 24U);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      // The object fills the image, so that the cell (i, j) shows an equal share of it.
      const auto cell = to_index(4 * i + j);
      EXPECT_NEAR(uv[2 * cell], 65534.0 * (j + 0.5) / 4.0, 1.0);
      EXPECT_NEAR(uv[2 * cell + 1], 65534.0 * (i + 0.5) / 3.0, 1.0);
      EXPECT_EQ(depth[cell], 4000);
      EXPECT_EQ(mask[cell], 255);
    }
  }
}

TEST_F(ShardsSink, AveragesThePixelsOfTheFrame) {
  write_frames({truth()});
  const auto pixels = values_of<std::uint8_t>(path("000000/image.npy"), {1, 12, 16, 3});
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) {
      for (int k = 0; k < 3; ++k) {
        // The mean of 4 x + 2 y over the pixels 2x, 2x + 1 and 2y, 2y + 1.
        EXPECT_EQ(pixels[to_index(3 * (16 * y + x) + k)], 8 * x + 4 * y + 3);
      }
    }
  }
}

TEST_F(ShardsSink, PutsTheNodesOnTheTrueSurface) {
  write_frames({truth()});
  const auto nodes_m = values_of<float>(path("000000/vertices_m.npy"), {1, 6, 3});
  const auto visible = values_of<std::uint8_t>(path("000000/visible.npy"), {1, 6});
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_NEAR(nodes_m[3 * n], -0.16 + 0.16 * static_cast<double>(n % 3), 1e-6);
    EXPECT_NEAR(nodes_m[3 * n + 1], n < 3 ? -0.12 : 0.12, 1e-6);
    EXPECT_NEAR(nodes_m[3 * n + 2], 0.4, 1e-6);
    EXPECT_EQ(visible[n], 1);
  }
}

TEST_F(ShardsSink, LeavesOutWhatTheCameraDoesNotSee) {
  GroundTruth half = truth(), none = truth();
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (std::int64_t y = 0; y < kHeight; ++y) {
    for (std::int64_t x = 0; x < kWidth; ++x) {
      none.uv_m.row(y)[2 * x] = none.uv_m.row(y)[2 * x + 1] = kNone;
      if (x < 10) half.uv_m.row(y)[2 * x] = half.uv_m.row(y)[2 * x + 1] = kNone;
    }
  }
  none.visible = Array<std::uint8_t>({4}, 0);
  write_frames({half, none});
  const auto uv = values_of<std::uint16_t>(path("000000/uv.npy"), {2, 3, 4, 2});
  const auto mask = values_of<std::uint8_t>(path("000000/mask.npy"), {2, 3, 4});
  const auto nodes_m = values_of<float>(path("000000/vertices_m.npy"), {2, 6, 3});
  EXPECT_EQ(uv[0], 65535) << "pixels 0 to 7 of the first cell are hidden";
  EXPECT_EQ(mask[0], 0);
  EXPECT_NEAR(uv[2], 65534.0 * 1.5 / 4.0, 1.0) << "the centre of the second cell is visible";
  EXPECT_EQ(mask[1], 191) << "six of its eight columns are visible: 255 * 0.75";
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(mask[12 + k], 0);
  for (std::size_t k = 0; k < 18; ++k) EXPECT_TRUE(std::isnan(nodes_m[18 + k]));
}

TEST_F(ShardsSink, WritesShardsOfEqualLengthAndADescription) {
  write_frames({truth(), truth(), truth()});
  values_of<std::uint8_t>(path("000000/visible.npy"), {2, 6});
  values_of<std::uint8_t>(path("000001/visible.npy"), {1, 6});
  EXPECT_FALSE(fs::exists(path("000002")));
  std::ifstream file(path("shards.json"));
  const auto text = nlohmann::json::parse(file);
  EXPECT_EQ(text["format"], "weft.shards/1");
  EXPECT_EQ(text["frames"], 3);
  EXPECT_NEAR(text["template"]["width_m"].get<double>(), size_m().x(), 1e-12);
  EXPECT_NEAR(text["template"]["height_m"].get<double>(), size_m().y(), 1e-12);
  EXPECT_NEAR(text["camera"]["fx"].get<double>(), 20.0, 1e-12);
  EXPECT_NEAR(text["camera"]["cx"].get<double>(), 7.5, 1e-12) << "(15.5 + 0.5) / 2 - 0.5";
  EXPECT_EQ(text["template"]["texture_hash"].get<std::string>().size(), 16U);
}

TEST_F(ShardsSink, SaysBeforeTheEndThatTheNumberOfFramesIsOpen) {
  PluginUnderTest shards = sink();
  ASSERT_TRUE(shards.prepare(object(), camera()));
  ASSERT_EQ(shards.process(kOpen, {}).status, WEFT_OK);
  std::ifstream file(path("shards.json"));
  EXPECT_TRUE(nlohmann::json::parse(file)["frames"].is_null());
}

TEST_F(ShardsSink, RefusesAFolderThatHoldsShards) {
  write_frames({truth()});
  PluginUnderTest shards = sink();
  ASSERT_TRUE(shards.prepare(object(), camera()));
  const PluginAnswer answer = shards.process(kOpen, {});
  EXPECT_EQ(answer.status, WEFT_ERROR);
  EXPECT_THAT(answer.message, HasSubstr("holds shards already"));
}

TEST_F(ShardsSink, RefusesImagesThatAreNoMultiple) {
  PluginUnderTest shards = sink(", width_px: 15, height_px: 12, cell_px: 4");
  const auto prepared = shards.prepare(object(), camera());
  ASSERT_FALSE(prepared);
  EXPECT_THAT(prepared.error().message, HasSubstr("no multiples of 'cell_px' 4"));
  PluginUnderTest wide = sink(", width_px: 24, height_px: 12");
  const auto again = wide.prepare(object(), camera());
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("32 x 24 px are no multiple of 24 x 12 px"));
}

TEST_F(ShardsSink, LeavesOutFramesWithoutLabels) {
  PluginUnderTest shards = sink();
  ASSERT_TRUE(shards.prepare(object(), camera()));
  ASSERT_EQ(shards.process(kOpen, {}).status, WEFT_OK);
  GroundTruth bare = truth(), loose = truth();
  bare.uv_m = {};
  loose.faces = {};
  const PluginAnswer answer = write(shards, bare);
  EXPECT_EQ(answer.status, WEFT_NO_RESULT);
  EXPECT_THAT(answer.message, HasSubstr("dense_truth: true"));
  EXPECT_THAT(write(shards, loose).message, HasSubstr("the truth has no faces"));
  EXPECT_EQ(write(shards, truth()).status, WEFT_OK);
  ASSERT_EQ(shards.process(kFinish, {}).status, WEFT_OK);
  values_of<std::uint8_t>(path("000000/visible.npy"), {1, 6});
}

}  // namespace
