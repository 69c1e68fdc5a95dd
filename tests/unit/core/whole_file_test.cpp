// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <weft/core/whole_file.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class WholeFileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// Limits the size of each file of this process.
  class SmallFiles {
   public:
    explicit SmallFiles(rlim_t bytes) {
      std::signal(SIGXFSZ, SIG_IGN);
      getrlimit(RLIMIT_FSIZE, &before_);
      const rlimit limit{bytes, before_.rlim_max};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~SmallFiles() { setrlimit(RLIMIT_FSIZE, &before_); }
    SmallFiles(const SmallFiles&) = delete;
    SmallFiles& operator=(const SmallFiles&) = delete;

   private:
    rlimit before_{};
  };

  std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / "whole_file_test";
};

TEST_F(WholeFileTest, TheBytesReplaceTheFormerContentAndLeaveNoOtherFile) {
  const fs::path file = folder_ / "a.txt";
  const std::string bytes("one\0two\r\n", 9);
  ASSERT_TRUE(write_whole("a longer text that was there before", file));
  ASSERT_TRUE(write_whole(bytes, file));
  EXPECT_EQ(content(file), bytes);
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, AFolderThatIsAbsentIsNamedWithTheReason) {
  const fs::path file = folder_ / "absent" / "a.txt";
  const auto written = write_whole("text", file);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::io);
  EXPECT_EQ(written.error().where, file.string());
  EXPECT_THAT(written.error().message, HasSubstr("No such file or directory"));
}

TEST_F(WholeFileTest, AFullDiskLeavesWhatWasThereBefore) {
  const fs::path file = folder_ / "a.txt";
  ASSERT_TRUE(write_whole("before", file));
  const SmallFiles limit(3);
  const auto written = write_whole("after", file);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("file size limit"));
  EXPECT_EQ(content(file), "before");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, FilesAndLinksOfOthersStayWhateverTheirNames) {
  std::ofstream(folder_ / "a.txt.part") << "a file of the user";
  std::ofstream(folder_ / "elsewhere") << "what the link leads to";
  fs::create_symlink(folder_ / "elsewhere", folder_ / "b.txt.part");
  ASSERT_TRUE(write_whole("text", folder_ / "a.txt"));
  ASSERT_TRUE(write_whole("text", folder_ / "b.txt"));
  EXPECT_EQ(content(folder_ / "a.txt.part"), "a file of the user");
  EXPECT_EQ(content(folder_ / "elsewhere"), "what the link leads to");
  EXPECT_TRUE(fs::is_symlink(folder_ / "b.txt.part"));
  EXPECT_EQ(entries(), 5);
}

TEST_F(WholeFileTest, TwoWritersOfOneFileDoNotMeet) {
  UnfinishedFile one(folder_ / "a.txt"), other(folder_ / "a.txt");
  EXPECT_NE(one.path(), other.path());
  EXPECT_THAT(one.path().filename().string(),
              ::testing::MatchesRegex("a\\.txt\\.[0-9a-f]{12}\\.part"));
  one.write("one");
  other.write("other");
  EXPECT_FALSE(one.finish(Durability::unsynced));
  EXPECT_EQ(content(folder_ / "a.txt"), "one");
  EXPECT_FALSE(other.finish(Durability::synced));
  EXPECT_EQ(content(folder_ / "a.txt"), "other");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, WhatIsNotFinishedDisappears) {
  { UnfinishedFile(folder_ / "a.txt").write("half"); }
  EXPECT_EQ(entries(), 0);
}

TEST_F(WholeFileTest, ANameOfTheGreatestLengthIsWritten) {
  const fs::path file = folder_ / std::string(255, 'x');
  ASSERT_TRUE(write_whole("text", file));
  EXPECT_EQ(content(file), "text");
}

TEST_F(WholeFileTest, ADeviceIsWrittenAndStays) {
  fs::create_symlink("/dev/null", folder_ / "null");
  EXPECT_TRUE(write_whole("text", folder_ / "null"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "null"));
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, AnOpenFileIsWrittenInItsPlaceAndNotReplaced) {
  const fs::path file = folder_ / "a.txt";
  const int open_file = ::open(file.c_str(), O_CREAT | O_WRONLY, 0600);
  ASSERT_GE(open_file, 0);
  const fs::path name = "/dev/fd/" + std::to_string(open_file);
  EXPECT_TRUE(is_device(name));
  EXPECT_TRUE(is_device("/dev/stdout"));
  EXPECT_TRUE(is_device("/dev/null"));
  EXPECT_FALSE(is_device(file));
  EXPECT_FALSE(is_device(folder_));
  EXPECT_FALSE(is_device("/dev/shm/new.txt"));
  EXPECT_TRUE(write_whole("text", name));
  ::close(open_file);
  EXPECT_EQ(content(file), "text");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, AFullDiskAndASizeLimitAreNamed) {
  const auto full = write_whole("text", "/dev/full");
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, HasSubstr("(No space left on device)"));
  EXPECT_THAT(why_not_written(std::make_error_code(std::errc::file_too_large)),
              HasSubstr("file size limit"));
}

}  // namespace
}  // namespace weft
