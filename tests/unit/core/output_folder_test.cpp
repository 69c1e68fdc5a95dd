// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <weft/core/output_folder.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, MayBeMadeWhereNothingIsAndOverAnEmptyFolderAlone) {
  const fs::path folder = fs::path(::testing::TempDir()) / "output_folder_test";
  fs::create_directories(folder / "empty");
  fs::create_directories(folder / "full" / "empty");
  std::ofstream(folder / "file") << "";
  EXPECT_TRUE(is_free_for_folder(folder / "new"));
  EXPECT_TRUE(is_free_for_folder(folder / "new" / "deeper"));
  EXPECT_TRUE(is_free_for_folder(folder / "empty"));
  EXPECT_FALSE(is_free_for_folder(folder / "full"));
  EXPECT_FALSE(is_free_for_folder(folder / "file"));
  fs::remove_all(folder);
}

TEST(OutputFolder, IsMadeWithAllThatAreAboveIt) {
  const fs::path folder = fs::path(::testing::TempDir()) / "output_folder_made";
  fs::remove_all(folder);
  EXPECT_FALSE(make_folders(folder / "a" / "b" / ""));
  EXPECT_TRUE(fs::is_directory(folder / "a" / "b"));
  EXPECT_FALSE(make_folders(folder / "a" / "b"));
  std::ofstream(folder / "file") << "";
  EXPECT_TRUE(make_folders(folder / "file" / "inside"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace weft
