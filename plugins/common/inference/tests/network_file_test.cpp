// SPDX-License-Identifier: Apache-2.0
#include "common/inference/network_file.hpp"

#include <gmock/gmock.h>

#include "common/inference/tests/test_network.hpp"

namespace weft::inference {
namespace {

using ::testing::HasSubstr;
using testing::TestFolder;
using testing::TestNetwork;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

struct NetworkFileTest : ::testing::Test {
  TestFolder folder;
  std::string text = TestNetwork().yaml("00112233445566aa");

  std::string reason(const std::string& changed) const {
    testing::write_file(folder.file("net.yaml"), changed);
    const auto read = read_network_file(folder.file("net.yaml"));
    return read ? "" : read.error().message;
  }
  std::string reason(const std::string& from, const std::string& to) const {
    return reason(replaced(text, from, to));
  }
};

TEST_F(NetworkFileTest, IsReadAsItWasWritten) {
  testing::write_file(folder.file("net.yaml"), text);
  const auto file = read_network_file(folder.file("net.yaml"));
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->onnx_path, folder.file("net.onnx"));
  EXPECT_EQ(file->onnx_hash, "00112233445566aa");
  EXPECT_EQ(file->camera.fx, 205.0);
  EXPECT_EQ(file->camera.cy, 59.5);
  EXPECT_EQ(file->camera.width_px, 160);
  EXPECT_EQ(file->cells.columns, 40);
  EXPECT_EQ(file->cells.step_px, 4);
  EXPECT_EQ(file->vertices.rows, 7);
  EXPECT_EQ(file->templ.height_m, 0.178);
  EXPECT_EQ(file->uv_error_factor, 1.0);
}

TEST_F(NetworkFileTest, NamesThePlaceAndTheFixOfEachError) {
  EXPECT_THAT(reason("fx: 205", "fx: 0"), HasSubstr("net.yaml:6:14: 'camera.fx' must be a number"));
  EXPECT_THAT(reason("fx: 205", "fx: .nan"), HasSubstr("'camera.fx' must be a number"));
  EXPECT_THAT(reason("fx: 205, ", ""), HasSubstr("net.yaml:6:9: 'camera.fx' is missing"));
  EXPECT_THAT(reason("columns: 40", "columns: 41"), HasSubstr("must be the size of the image"));
  EXPECT_THAT(reason("step_px: 4", "step_px: 3.5"), HasSubstr("must be a whole number"));
  EXPECT_THAT(reason("weft_network: 1", "weft_network: 2"), HasSubstr("only '1' is known"));
  EXPECT_THAT(reason("colours: rgb", "colours: bgr"), HasSubstr("only 'rgb' is known"));
  EXPECT_THAT(reason("uv_error_factor", "uv_eror_factor"), HasSubstr("'uv_error_factor'"));
  EXPECT_THAT(reason("net.onnx", "../net.onnx"), HasSubstr("in the same folder"));
  EXPECT_THAT(reason("0123456789abcdef", "0123456789ABCDEF"), HasSubstr("16 hexadecimal"));
  EXPECT_THAT(reason("{fx: 205", "[fx: 205"), HasSubstr("net.yaml:6"));
  EXPECT_THAT(reason("- 1\n- 2\n"), HasSubstr("must have keys"));
  EXPECT_THAT(reason(""), HasSubstr("is empty"));
  EXPECT_THAT(reason(std::string("\x00\x01\x02", 3)), HasSubstr("net.yaml"));
}

TEST_F(NetworkFileTest, CannotBeAFolderOrMissing) {
  const auto missing = read_network_file(folder.file("none.yaml"));
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("there is no such file"));
  const auto is_folder = read_network_file(folder.file(""));
  ASSERT_FALSE(is_folder);
  EXPECT_THAT(is_folder.error().message, HasSubstr("is a folder"));
}

TEST_F(NetworkFileTest, DescribesOneOnnxFileOnly) {
  const TestNetwork network;
  const std::string path = network.write(folder);
  const auto file = read_network_file(path);
  ASSERT_TRUE(file);
  EXPECT_TRUE(read_onnx(*file, file->outputs()));
  testing::write_file(folder.file("net.onnx"), network.model().bytes() + " ");
  const auto other = read_onnx(*file, file->outputs());
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("is not the file that " + path + " describes"));
  std::filesystem::remove(folder.file("net.onnx"));
  const auto missing = read_onnx(*file, file->outputs());
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("net.onnx: there is no such file"));
  std::filesystem::create_directory(folder.file("net.onnx"));
  const auto is_folder = read_onnx(*file, file->outputs());
  ASSERT_FALSE(is_folder);
  EXPECT_THAT(is_folder.error().message, HasSubstr("is a folder"));
}

TEST_F(NetworkFileTest, HasATextureOrATemplate) {
  TestNetwork any;
  any.texture_px = 120;
  testing::write_file(folder.file("net.yaml"), any.yaml("00112233445566aa"));
  const auto file = read_network_file(folder.file("net.yaml"));
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->texture_px, 120);
  EXPECT_EQ(file->outputs(), std::vector<std::string>{"cells"});
  EXPECT_THAT(reason("uv_error_factor", "texture: {side_px: 96}\nuv_error_factor"),
              HasSubstr("remove 'template' or 'texture'"));
  EXPECT_THAT(reason(replaced(any.yaml("00112233445566aa"), "side_px: 120", "side_px: 161")),
              HasSubstr("'texture.side_px' must be a number from 8 to 160"));
}

}  // namespace
}  // namespace weft::inference
