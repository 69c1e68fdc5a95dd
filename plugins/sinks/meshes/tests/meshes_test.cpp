// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <weft/core/index.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using weft::Shape;
using weft::Template;
using weft::testing::input;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr int kOpen = 0, kWrite = 1, kFinish = 2;

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct ReadMesh {
  std::vector<double> coordinates;
  std::vector<std::int32_t> faces;
  std::vector<double> texture_uv;
  std::vector<std::string> comments;
};

/// Reads only the one form of PLY that the sink writes.
ReadMesh read_ply(const fs::path& path) {
  const std::string bytes = read_file(path);
  ReadMesh mesh;
  std::size_t vertices = 0, faces = 0, at = 0;
  std::vector<std::string> properties;
  for (std::string line; line != "end_header";) {
    const std::size_t end = bytes.find('\n', at);
    if (end == bytes.npos) throw std::runtime_error("the header has no end");
    line = bytes.substr(at, end - at);
    at = end + 1;
    if (line.starts_with("comment ")) mesh.comments.push_back(line.substr(8));
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) faces = std::stoul(line.substr(13));
    if (line.starts_with("property ")) properties.push_back(line.substr(9));
  }
  EXPECT_TRUE(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_EQ(properties, (std::vector<std::string>{"double x", "double y", "double z",
                                                  "list uchar int vertex_indices"}));
  EXPECT_EQ(bytes.size(), at + vertices * 24 + faces * 13);
  mesh.coordinates.resize(vertices * 3);
  std::memcpy(mesh.coordinates.data(), bytes.data() + at, vertices * 24);
  at += vertices * 24;
  mesh.faces.resize(faces * 3);
  for (std::size_t f = 0; f < faces; ++f, at += 13) {
    EXPECT_EQ(bytes[at], 3);
    std::memcpy(mesh.faces.data() + 3 * f, bytes.data() + at + 1, 12);
  }
  return mesh;
}

ReadMesh read_obj(const fs::path& path) {
  std::istringstream lines(read_file(path));
  ReadMesh mesh;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, word;
    words >> kind;
    if (kind == "#") mesh.comments.push_back(line.substr(2));
    while (words >> word) {
      if (kind == "v") mesh.coordinates.push_back(std::stod(word));
      if (kind == "vt") mesh.texture_uv.push_back(std::stod(word));
      if (kind != "f") continue;
      mesh.faces.push_back(std::stoi(word) - 1);
      if (const std::size_t slash = word.find('/'); slash != word.npos) {
        EXPECT_EQ(word.substr(0, slash), word.substr(slash + 1));
      }
    }
  }
  return mesh;
}

class MeshesSink : public ::testing::Test {
 protected:
  MeshesSink() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    for (std::int64_t i = 0; i < templ_.texture.size(); ++i) {
      templ_.texture.data()[i] = static_cast<std::uint8_t>(i % 251);
    }
    shape_.vertices_m = weft::Array<double>({templ_.vertices_m.rows(), 3}, 0.0);
    for (std::int64_t v = 0; v < shape_.vertices_m.rows(); ++v) {
      shape_.vertices_m(v, 0) = templ_.vertices_m(v, 0) / 3.0;
      shape_.vertices_m(v, 1) = templ_.vertices_m(v, 1) / 7.0;
      shape_.vertices_m(v, 2) = 0.6 + 1e-3 / static_cast<double>(v + 1);
    }
    shape_.source = weft::Array<std::uint8_t>({shape_.vertices_m.rows()}, 0);
  }
  ~MeshesSink() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  PluginUnderTest sink(const std::string& more = "") const {
    return PluginUnderTest("sinks/meshes", "{path: '" + meshes().string() + "'" + more + "}");
  }
  fs::path meshes() const { return folder_ / "out" / "meshes"; }

  void expect_written(const ReadMesh& mesh) const {
    ASSERT_EQ(mesh.coordinates.size(), weft::to_index(shape_.vertices_m.size()));
    EXPECT_TRUE(
        std::equal(mesh.coordinates.begin(), mesh.coordinates.end(), shape_.vertices_m.data()));
    ASSERT_EQ(mesh.faces.size(), weft::to_index(templ_.faces.size()));
    EXPECT_TRUE(std::equal(mesh.faces.begin(), mesh.faces.end(), templ_.faces.data()));
    EXPECT_THAT(mesh.comments, ::testing::Contains(HasSubstr("metres")));
  }

  std::size_t file_count() const {
    return weft::to_index(
        std::distance(fs::directory_iterator(meshes()), fs::directory_iterator()));
  }

  fs::path folder_;
  weft::Camera camera_ = weft::testing::make_camera();
  Template templ_ = weft::testing::make_template({5, 4, 0.2, 0.15, 40, 30});
  Shape shape_;
};

TEST_F(MeshesSink, WritesAPlyFileForEachFrameWithAShape) {
  auto plugin = sink();
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kWrite, {input("shape", shape_)}, 0).status, WEFT_OK);
  shape_.state = static_cast<std::int32_t>(weft::ShapeState::predicted);
  shape_.age_frames = 3;
  ASSERT_EQ(plugin.process(kWrite, {input("shape", shape_)}, 12).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kFinish, {}).status, WEFT_OK);
  EXPECT_EQ(file_count(), 2U);
  expect_written(read_ply(meshes() / "000000.ply"));
  const ReadMesh second = read_ply(meshes() / "000012.ply");
  expect_written(second);
  EXPECT_THAT(second.comments,
              ::testing::IsSupersetOf({"frame 12", "state predicted", "age 3 frames"}));
}

TEST_F(MeshesSink, WritesObjFilesThatReadBackBitForBit) {
  auto plugin = sink(", format: obj");
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kWrite, {input("shape", shape_)}, 7).status, WEFT_OK);
  const ReadMesh mesh = read_obj(meshes() / "000007.obj");
  expect_written(mesh);
  ASSERT_EQ(mesh.texture_uv.size(), 2 * weft::to_index(templ_.flat_px.rows()));
  // The surface fills its texture: its corners are the corners of the texture square.
  EXPECT_NEAR(mesh.texture_uv[0], 0.0, 1e-15);
  EXPECT_NEAR(mesh.texture_uv[1], 1.0, 1e-15);
  EXPECT_NEAR(mesh.texture_uv[mesh.texture_uv.size() - 2], 1.0, 1e-15);
  EXPECT_NEAR(mesh.texture_uv[mesh.texture_uv.size() - 1], 0.0, 1e-15);
}

TEST_F(MeshesSink, WritesTheTextureOnceBesideTheObjFiles) {
  auto plugin = sink(", format: both");
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_EQ(plugin.process(kWrite, {input("shape", shape_)}, i).status, WEFT_OK);
  }
  EXPECT_EQ(file_count(), 8U);  // three of each format, the texture and its material
  const cv::Mat texture = cv::imread((meshes() / "texture.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(texture.total() * texture.elemSize(), weft::to_index(templ_.texture.size()));
  EXPECT_TRUE(std::equal(texture.datastart, texture.dataend, templ_.texture.data()));
  EXPECT_THAT(read_file(meshes() / "texture.mtl"), HasSubstr("map_Kd texture.png"));
  EXPECT_THAT(read_file(meshes() / "000001.obj"), HasSubstr("mtllib texture.mtl"));
}

TEST_F(MeshesSink, LeavesTheTextureOutWhenAsked) {
  auto plugin = sink(", format: obj, texture: false");
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  ASSERT_EQ(plugin.process(kWrite, {input("shape", shape_)}, 0).status, WEFT_OK);
  EXPECT_EQ(file_count(), 1U);
  const ReadMesh mesh = read_obj(meshes() / "000000.obj");
  expect_written(mesh);
  EXPECT_TRUE(mesh.texture_uv.empty());
}

TEST_F(MeshesSink, RefusesAShapeThatIsNoShapeOfThisTemplate) {
  auto plugin = sink();
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  Shape other = shape_;
  other.vertices_m = weft::Array<double>({3, 3}, 0.0);
  other.source = weft::Array<std::uint8_t>({3}, 0);
  const PluginAnswer wrong_count = plugin.process(kWrite, {input("shape", other)}, 0);
  EXPECT_EQ(wrong_count.status, WEFT_ERROR);
  EXPECT_THAT(wrong_count.message, HasSubstr("3 vertices, the template 20"));
  shape_.vertices_m(4, 1) = std::numeric_limits<double>::quiet_NaN();
  const PluginAnswer not_finite = plugin.process(kWrite, {input("shape", shape_)}, 1);
  EXPECT_EQ(not_finite.status, WEFT_ERROR);
  EXPECT_THAT(not_finite.message, HasSubstr("not finite"));
  EXPECT_EQ(file_count(), 0U);
}

TEST_F(MeshesSink, NamesTheFolderThatCannotBeMade) {
  std::ofstream(folder_ / "out") << "a file where a folder is needed";
  auto plugin = sink();
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  const PluginAnswer refused = plugin.process(kOpen, {});
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.message, HasSubstr(meshes().string()));
}

TEST_F(MeshesSink, NamesTheFileThatCannotBeWritten) {
  auto plugin = sink();
  ASSERT_TRUE(plugin.prepare(templ_, camera_));
  ASSERT_EQ(plugin.process(kOpen, {}).status, WEFT_OK);
  fs::remove_all(meshes());
  const PluginAnswer refused = plugin.process(kWrite, {input("shape", shape_)}, 5);
  EXPECT_EQ(refused.status, WEFT_ERROR);
  EXPECT_THAT(refused.where, EndsWith("000005.ply"));
}

}  // namespace
