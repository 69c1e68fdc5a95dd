// SPDX-License-Identifier: Apache-2.0
#include "written_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/cameras/tests/frame_folder.hpp"
#include "encoded_frame.hpp"

namespace weft::images {
namespace {

using weft::testing::encoded_frame;
using weft::testing::FrameFolder;

constexpr double kLong_s = 1e6;  ///< nothing stands still for so long
constexpr int kFewestLooks = 20;

TEST(WrittenFile, APngOrJpegIsCompleteWhenAllOfItIsThereAndNeverBefore) {
  for (const std::string name : {"a.png", "a.jpg"}) {
    SCOPED_TRACE(name);
    const FrameFolder folder;
    const std::string bytes = encoded_frame(name, 77);
    WrittenFile file(folder.path(name));
    for (std::size_t written = 0; written < bytes.size(); ++written) {
      folder.write(name, bytes.substr(0, written));
      EXPECT_FALSE(file.is_complete(true, kLong_s)) << written << " of " << bytes.size();
    }
    folder.write(name, bytes);
    EXPECT_TRUE(file.is_complete(false, kLong_s));
  }
}

TEST(WrittenFile, OfAFormatWithoutAnEndIsCompleteWhenItsWriterHasGoneOn) {
  for (const std::string name : {"a.bmp", "a.ppm", "a.tif", "a.webp"}) {
    SCOPED_TRACE(name);
    const FrameFolder folder;
    folder.write(name, encoded_frame(name, 77));
    WrittenFile file(folder.path(name));
    EXPECT_FALSE(file.is_complete(false, kLong_s));
    EXPECT_TRUE(file.is_complete(true, kLong_s));
  }
}

TEST(WrittenFile, OfWhichNotEvenTheBeginningIsThereIsNotComplete) {
  for (const std::string name : {"a.bmp", "a.ppm", "a.tif", "a.webp"}) {
    SCOPED_TRACE(name);
    const FrameFolder folder;
    const std::string bytes = encoded_frame(name, 77);
    for (const std::size_t written : {0, 1, 3}) {
      folder.write(name, bytes.substr(0, written));
      WrittenFile file(folder.path(name));
      EXPECT_FALSE(file.is_complete(true, kLong_s)) << written;
    }
  }
}

TEST(WrittenFile, ThatNoLongerGrowsIsComplete) {
  const FrameFolder folder;
  folder.write("a.png", "no image");
  WrittenFile file(folder.path("a.png"));
  for (int look = 1; look < kFewestLooks; ++look) EXPECT_FALSE(file.is_complete(false, 0.0));
  folder.write("a.png", "no image either");
  for (int look = 1; look < kFewestLooks; ++look) EXPECT_FALSE(file.is_complete(false, 0.0));
  EXPECT_FALSE(file.is_complete(false, kLong_s));
  EXPECT_TRUE(file.is_complete(false, 0.0));
}

TEST(WrittenFile, ThatIsNoRegularFileIsComplete) {
  const FrameFolder folder;
  std::filesystem::create_directory(folder.path("folder.png"));
  std::filesystem::create_symlink("nowhere", folder.path("link.png"));
  for (const char* name : {"folder.png", "link.png"}) {
    WrittenFile file(folder.path(name));
    for (int look = 1; look < kFewestLooks; ++look) EXPECT_FALSE(file.is_complete(true, 0.0));
    EXPECT_TRUE(file.is_complete(true, 0.0)) << name;
  }
}

}  // namespace
}  // namespace weft::images
