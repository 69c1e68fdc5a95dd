// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/record_file.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using weft::Array;
using weft::GroundTruth;
using weft::Image;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;
using weft::testing::RecordFile;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

Image make_image(std::uint8_t grey) {
  Image image{Array<std::uint8_t>({480, 640}, 0), "any"};
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels.data()[i] = static_cast<std::uint8_t>((i * 7 + grey) % 256);
  }
  return image;
}

GroundTruth make_truth() {
  GroundTruth truth{Array<double>({2, 2}, 0.0), Array<double>({2, 3}, 0.0), "made", ""};
  truth.points_m(0, 2) = 0.6;
  truth.points_m(1, 2) = 1.0 / 3.0;
  truth.visible = Array<std::uint8_t>({2}, 0);
  truth.depth_m = Array<float>({480, 640}, 0.0F);
  truth.uv_m = Array<float>({480, 640, 2}, 0.0F);
  truth.uv_m.data()[5] = std::numeric_limits<float>::quiet_NaN();
  truth.diag.set("edge_strain", 0.001);
  return truth;
}

class DatasetSink : public ::testing::Test {
 protected:
  DatasetSink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~DatasetSink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path path(const std::string& name) const { return folder_ / "sequence" / name; }

  PluginUnderTest sink(const std::string& more = "") const {
    return PluginUnderTest("sinks/dataset", "{path: '" + path("").string() + "'" + more + "}");
  }

  /// Two frames, the second one without truth.
  void write_all(PluginUnderTest& sink) const {
    ASSERT_TRUE(sink.prepare(weft::testing::make_template(), weft::testing::make_camera()));
    ASSERT_EQ(sink.process(kOpen, {}).status, WEFT_OK);
    EXPECT_EQ(sink.process(kWrite,
                           {input("image", make_image(1)), input("time", weft::Time{0.0}),
                            input("ground_truth", make_truth())},
                           0)
                  .status,
              WEFT_OK);
    EXPECT_EQ(
        sink.process(kWrite, {input("image", make_image(2)), input("time", weft::Time{0.04})}, 1)
            .status,
        WEFT_OK);
    EXPECT_EQ(sink.process(kFinish, {}).status, WEFT_OK);
  }

  fs::path folder_;
};

TEST_F(DatasetSink, WritesImagesAndTruthWithoutLoss) {
  auto dataset = sink();
  write_all(dataset);
  const cv::Mat image = cv::imread(path("frames/000001.png").string(), cv::IMREAD_UNCHANGED);
  const Image expected = make_image(2);
  ASSERT_EQ(image.total(), weft::to_index(expected.pixels.size()));
  EXPECT_EQ(std::memcmp(image.data, expected.pixels.data(), image.total()), 0);
  const RecordFile file(path("gt/000000.npz").string());
  EXPECT_EQ(file.count(), 1U);
  const auto truth = file.get<GroundTruth>();
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->kind, "made");
  EXPECT_EQ(truth->points_m(1, 2), 1.0 / 3.0);
  EXPECT_EQ(truth->uv_m.dim(2), 2);
  EXPECT_EQ(truth->diag.value("edge_strain", 0.0), 0.001);
  EXPECT_FALSE(fs::exists(path("gt/000001.npz")));
}

TEST_F(DatasetSink, DescribesWhatItWrote) {
  auto dataset = sink();
  write_all(dataset);
  EXPECT_THAT(read_file(path("meta.yaml")), HasSubstr("frames: 2\nfps: 25\n"));
  EXPECT_THAT(read_file(path("meta.yaml")), HasSubstr("  frames: 1\n  kind: \"made\"\n"));
  EXPECT_THAT(read_file(path("camera.yaml")), HasSubstr("\nwidth: 640\nheight: 480\n"));
  EXPECT_THAT(read_file(path("sequence.yaml")), HasSubstr("truth: gt/*.npz"));
  EXPECT_TRUE(fs::exists(path("template/texture.png")));
  EXPECT_TRUE(RecordFile(path("template/template.npz").string()).get<weft::Template>());
}

TEST_F(DatasetSink, LeavesDenseTruthOutIfAsked) {
  auto dataset = sink(", dense_truth: false");
  write_all(dataset);
  EXPECT_LT(fs::file_size(path("gt/000000.npz")), 5000U);
}

TEST_F(DatasetSink, LeavesNoTemporaryFilesAndSaysWithMetaThatItIsComplete) {
  auto dataset = sink();
  ASSERT_TRUE(dataset.prepare(weft::testing::make_template(), weft::testing::make_camera()));
  ASSERT_EQ(dataset.process(kOpen, {}).status, WEFT_OK);
  EXPECT_EQ(dataset.process(kWrite, {input("image", make_image(1))}, 0).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(path("meta.yaml")));
  EXPECT_EQ(dataset.process(kFinish, {}).status, WEFT_OK);
  EXPECT_TRUE(fs::exists(path("meta.yaml")));
  for (const auto& entry : fs::recursive_directory_iterator(path(""))) {
    EXPECT_NE(entry.path().extension(), ".part");
  }
}

TEST_F(DatasetSink, RefusesAFolderThatHoldsFramesAndOneThatCannotBeMade) {
  fs::create_directories(path("frames"));
  std::ofstream(path("frames/000000.png")) << "x";
  auto dataset = sink();
  ASSERT_TRUE(dataset.prepare(weft::testing::make_template(), weft::testing::make_camera()));
  EXPECT_THAT(dataset.process(kOpen, {}).message, HasSubstr("holds files already"));
  std::ofstream(folder_ / "file") << "x";
  PluginUnderTest blocked("sinks/dataset", "{path: '" + (folder_ / "file/in").string() + "'}");
  ASSERT_TRUE(blocked.prepare(weft::testing::make_template(), weft::testing::make_camera()));
  EXPECT_THAT(blocked.process(kOpen, {}).message, HasSubstr("cannot be made"));
}

}  // namespace
