// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>
#include <weft/core/text_file.hpp>

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class TextFileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  /// Why a file is not read.
  static std::string reason(const std::string& path, std::uint64_t most_bytes = 100) {
    const auto text = read_text_file(path, most_bytes);
    if (text) return "read, " + std::to_string(text->size()) + " bytes";
    EXPECT_EQ(text.error().where, path);
    return text.error().message;
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / "text_file_test";
};

TEST_F(TextFileTest, TheBytesOfAFileComeAsTheyAre) {
  const std::string bytes("one\0two\r\n\xFF", 10);
  const auto text = read_text_file(file("a", bytes), 10);
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, bytes);
  const std::string long_text(200'000, 'x');
  EXPECT_EQ(*read_text_file(file("long", long_text), 1'000'000), long_text);
  EXPECT_EQ(*read_text_file(file("empty", ""), 0), "");
}

TEST_F(TextFileTest, OneByteTooManyIsRefusedWithTheLimit) {
  EXPECT_EQ(reason(file("a", std::string(11, 'x')), 10), "it has more than 10 bytes");
}

TEST_F(TextFileTest, AHugeFileIsRefusedBeforeItIsRead) {
  const std::string path = file("huge", "");
  fs::resize_file(path, 1'000'000'000'000);  // takes no space: it is a hole
  EXPECT_EQ(reason(path), "it has more than 100 bytes");
}

TEST_F(TextFileTest, AFileThatIsLongerThanItSaysIsReadToTheLimitOnly) {
  EXPECT_EQ(reason("/proc/self/maps", 10), "it has more than 10 bytes");
}

TEST_F(TextFileTest, DevicesFifosAndFoldersAreRefusedAtOnce) {
  const std::string fifo = folder_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(reason(fifo), "it is no regular file");
  EXPECT_EQ(reason("/dev/zero"), "it is no regular file");
  EXPECT_EQ(reason(folder_), "it is a folder");
  EXPECT_EQ(reason("/proc/self/mem"), "Input/output error");
}

TEST_F(TextFileTest, AMissingFileIsDistinguishedFromAnUnreadableOne) {
  EXPECT_EQ(read_text_file(folder_ / "absent", 1).error().code, Errc::not_found);
  EXPECT_EQ(read_text_file(file("a", "x") + "/b", 1).error().code, Errc::not_found);
  EXPECT_EQ(read_text_file(folder_, 1).error().code, Errc::io);
}

TEST_F(TextFileTest, ANameIsNotCutAtANul) {
  const std::string path = file("a", "x") + std::string("\0b", 2);
  EXPECT_EQ(reason(path), "its name has a NUL character");
}

}  // namespace
}  // namespace weft
