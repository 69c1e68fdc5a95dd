// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using weft::Shape;
using weft::Template;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
constexpr double kFps = 25.0;

class AnimationSink : public ::testing::Test {
 protected:
  AnimationSink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    for (std::int64_t i = 0; i < templ_.texture.size(); ++i) {
      templ_.texture.data()[i] = static_cast<std::uint8_t>(i % 251);
    }
  }
  ~AnimationSink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path file() const { return folder_ / "out" / "surface.glb"; }
  PluginUnderTest sink(const std::string& more = "") const {
    return PluginUnderTest("sinks/animation",
                           "{path: '" + file().string() + "', fps: 25" + more + "}");
  }
  void open(PluginUnderTest& plugin) const {
    ASSERT_TRUE(plugin.prepare(templ_, camera_));
    ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  }

  /// A surface that bends in time.
  Shape shape_of(std::uint64_t frame) const {
    Shape shape;
    shape.vertices_m = weft::Array<double>({templ_.vertices_m.rows(), 3}, 0.0);
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      const double x = templ_.vertices_m(v, 0);
      shape.vertices_m(v, 0) = x;
      shape.vertices_m(v, 1) = templ_.vertices_m(v, 1);
      shape.vertices_m(v, 2) = 0.6 + 0.02 * std::sin(20.0 * x + static_cast<double>(frame));
    }
    shape.source = weft::Array<std::uint8_t>({shape.vertices_m.rows()}, 0);
    return shape;
  }
  void write(PluginUnderTest& plugin, std::uint64_t frame) const {
    const Shape shape = shape_of(frame);
    ASSERT_EQ(plugin.process(kWrite, {input("shape", shape)}, frame).status, WEFT_OK);
  }

  /// The content of a file as other programs read it.
  nlohmann::json read(const fs::path& path, const std::string& times_s) const {
    const std::string text = output_of(std::string("/usr/bin/node " WEFT_OPEN_GLTF " " WEFT_WEB) +
                                       " '" + path.string() + "' " + times_s);
    return nlohmann::json::parse(text, nullptr, false);
  }

  static std::string output_of(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
    EXPECT_EQ(pclose(pipe), 0) << text;
    return text;
  }

  /// glTF has y up and z towards the viewer.
  void expect_shape(const nlohmann::json& shown, std::uint64_t frame) const {
    const Shape shape = shape_of(frame);
    ASSERT_EQ(shown["vertices"].size(), weft::to_index(shape.vertices_m.size()));
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(shown["vertices"][weft::to_index(3 * v + k)].get<double>(),
                    (k == 0 ? 1.0 : -1.0) * shape.vertices_m(v, k), 1e-7)
            << "vertex " << v << ", frame " << frame;
      }
    }
    EXPECT_EQ(shown["scale"], 1.0);
  }

  fs::path folder_;
  weft::Camera camera_ = weft::testing::make_camera();
  Template templ_ = weft::testing::make_template({5, 4, 0.2, 0.1, 64, 32});
};

/// The first missing prerequisite of the tests with other programs, or nothing.
std::string absent() {
  for (const char* file :
       {WEFT_WEB "/node_modules/gltf-validator", WEFT_WEB "/node_modules/three", "/usr/bin/node"}) {
    if (!fs::exists(file)) return file;
  }
  return "";
}

#define NEEDS_NODE()                                    \
  if (const std::string what = absent(); !what.empty()) \
  GTEST_SKIP() << what << " is absent: install npm and run scripts/bootstrap.sh"

TEST_F(AnimationSink, PlaysEachShapeAtItsTimeInOtherPrograms) {
  NEEDS_NODE();
  auto plugin = sink();
  open(plugin);
  for (const std::uint64_t frame : {10U, 11U, 12U, 14U}) write(plugin, frame);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  const nlohmann::json seen = read(file(), "0 0.041 0.079 0.081 0.13 0.161 0.199");
  EXPECT_THAT(seen["messages"], IsEmpty()) << seen["messages"];
  EXPECT_TRUE(seen["textures"].get<bool>());
  EXPECT_EQ(seen["targets"],
            nlohmann::json({"000011 estimated", "000012 estimated", "000014 estimated"}));
  EXPECT_NEAR(seen["duration_s"].get<double>(), 5 / kFps, 1e-6);
  // The shape of a moment is the last before it, also across a frame that is missing.
  for (const auto& [index, frame] :
       {std::pair{0U, 10U}, {1U, 11U}, {2U, 11U}, {3U, 12U}, {4U, 12U}, {5U, 14U}, {6U, 14U}}) {
    expect_shape(seen["shown"][index], frame);
  }
  EXPECT_NEAR(std::tan(seen["fov_degrees"].get<double>() * M_PI / 360.0),
              0.5 * static_cast<double>(camera_.height_px) / camera_.fy, 1e-6);
}

TEST_F(AnimationSink, HasInBlenderTheVerticesOfEachFrame) {
  if (!fs::exists("/usr/bin/blender")) GTEST_SKIP() << "Blender is absent: install blender";
  auto plugin = sink();
  open(plugin);
  for (const std::uint64_t frame : {10U, 11U, 12U, 14U}) write(plugin, frame);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  const std::string text = output_of(
      "/usr/bin/blender --background --python-exit-code 1 --python " WEFT_READ_IN_BLENDER " -- '" +
      file().string() + "' 25 0 1 2 3 4 2>&1");
  const std::size_t begin = text.find("vertices [");
  ASSERT_NE(begin, std::string::npos) << text;
  const std::string line = text.substr(begin, text.find('\n', begin) - begin);
  const auto frames = nlohmann::json::parse(line.substr(line.find('[')));
  constexpr std::uint64_t kShown[] = {10, 11, 12, 12, 14};
  for (std::size_t i = 0; i < 5; ++i) {
    const Shape shape = shape_of(kShown[i]);
    ASSERT_EQ(frames[i].size(), weft::to_index(shape.vertices_m.rows()));
    for (std::int64_t v = 0; v < shape.vertices_m.rows(); ++v) {
      // z is up, and the camera looks along y.
      const double expected[] = {shape.vertices_m(v, 0), shape.vertices_m(v, 2),
                                 -shape.vertices_m(v, 1)};
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(frames[i][weft::to_index(v)][k].get<double>(), expected[k], 1e-6)
            << "vertex " << v << ", frame " << i;
      }
    }
  }
}

TEST_F(AnimationSink, HidesTheSurfaceInFramesWithoutAShape) {
  NEEDS_NODE();
  auto plugin = sink();
  open(plugin);
  ASSERT_EQ(plugin.process(kWrite, {}, 0).status, WEFT_OK);
  write(plugin, 1);
  for (const std::uint64_t frame : {2U, 3U}) {
    ASSERT_EQ(plugin.process(kWrite, {}, frame).status, WEFT_OK);
  }
  write(plugin, 4);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  const nlohmann::json seen = read(file(), "0 0.041 0.081 0.121 0.161");
  EXPECT_THAT(seen["messages"], IsEmpty()) << seen["messages"];
  std::vector<double> scales;
  for (const auto& shown : seen["shown"]) scales.push_back(shown["scale"]);
  EXPECT_THAT(scales, ElementsAre(0.0, 1.0, 0.0, 0.0, 1.0));
  expect_shape(seen["shown"][1], 1);
  expect_shape(seen["shown"][4], 4);
}

TEST_F(AnimationSink, MarksPredictedShapesInTheNamesOfTheirTargets) {
  NEEDS_NODE();
  auto plugin = sink();
  open(plugin);
  write(plugin, 0);
  Shape shape = shape_of(1);
  shape.state = static_cast<std::int32_t>(weft::ShapeState::predicted);
  ASSERT_EQ(plugin.process(kWrite, {input("shape", shape)}, 1).status, WEFT_OK);
  EXPECT_EQ(read(file(), "0")["targets"], nlohmann::json({"000001 predicted"}));
}

TEST_F(AnimationSink, KeepsAWholeFileWhileItGrows) {
  NEEDS_NODE();
  auto plugin = sink();
  open(plugin);
  for (std::uint64_t frame = 0; frame < 40; ++frame) {
    write(plugin, frame);
    if (frame % 13 != 0) continue;
    // A killed run would leave this.
    const nlohmann::json seen = read(file(), "0");
    EXPECT_THAT(seen["messages"], IsEmpty()) << seen["messages"];
    EXPECT_GE(seen["targets"].size(), frame - (frame + 15) / 16);
    expect_shape(seen["shown"][0], 0);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(file().parent_path()), fs::directory_iterator()),
            1);
}

TEST_F(AnimationSink, ContinuesInAFurtherFile) {
  NEEDS_NODE();
  auto plugin = sink(", frames_per_file: 3");
  open(plugin);
  std::ofstream(file().parent_path() / "surface_2.glb") << "another file";
  for (std::uint64_t frame = 0; frame < 8; ++frame) write(plugin, frame);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_EQ(fs::file_size(file().parent_path() / "surface_2.glb"), 12U) << "it is not replaced";
  for (const auto& [name, first, targets] :
       {std::tuple{"surface.glb", 0U, 2U}, {"surface_3.glb", 3U, 2U}, {"surface_4.glb", 6U, 1U}}) {
    const nlohmann::json seen = read(file().parent_path() / name, "0 0.041");
    EXPECT_THAT(seen["messages"], IsEmpty()) << name << seen["messages"];
    EXPECT_EQ(seen["targets"].size(), targets) << name;
    expect_shape(seen["shown"][0], first);
    expect_shape(seen["shown"][1], first + 1);
  }
}

TEST_F(AnimationSink, WritesNoFileOfARunWithoutAnyShape) {
  auto plugin = sink();
  open(plugin);
  ASSERT_EQ(plugin.process(kWrite, {}, 0).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(AnimationSink, RefusesAShapeThatIsNoShapeOfThisTemplate) {
  auto plugin = sink();
  open(plugin);
  Shape other = shape_of(0);
  other.vertices_m = weft::Array<double>({3, 3}, 0.0);
  other.source = weft::Array<std::uint8_t>({3}, 0);
  const PluginAnswer wrong_count = plugin.process(kWrite, {input("shape", other)}, 0);
  EXPECT_EQ(wrong_count.status, WEFT_ERROR);
  EXPECT_THAT(wrong_count.message, HasSubstr("3 vertices, the template 20"));
  Shape broken = shape_of(1);
  broken.vertices_m(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(plugin.process(kWrite, {input("shape", broken)}, 1).message, HasSubstr("not finite"));
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(AnimationSink, NamesTheFileThatCannotBeWritten) {
  std::ofstream(folder_ / "out") << "a file where a folder is needed";
  auto plugin = sink();
  open(plugin);
  const Shape shape = shape_of(0);
  const PluginAnswer refused = plugin.process(kWrite, {input("shape", shape)}, 0);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.where, HasSubstr("surface.glb"));
}

}  // namespace
