// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/data_layout.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <weft/images/image_names.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;

TEST(DataLayout, FindsFoldersOfImagesOfEachExtension) {
  const FileSources sources{"sources/images", "sources/matches", "sources/video"};
  for (const std::string& extension : image_extensions()) {
    std::string name = (fs::temp_directory_path() / "weft_layout_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    const fs::path folder = name;
    fs::create_directory(folder / "frames");
    for (const fs::path& file : {folder / "frames" / ("7" + extension), folder / "camera.yaml"}) {
      std::ofstream(file) << "of any content";
    }
    const auto layout = find_data_layout(folder.string(), sources);
    fs::remove_all(folder);
    ASSERT_TRUE(layout) << extension << ": " << layout.error().message;
    EXPECT_EQ(layout->kind, "frames");
    const yaml::Node* path = layout->source.find("params")->find("path");
    ASSERT_NE(path, nullptr);
    EXPECT_EQ(path->scalar, (folder / "frames" / ("*" + extension)).string());
  }
}

}  // namespace
}  // namespace weft
