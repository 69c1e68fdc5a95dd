// SPDX-License-Identifier: Apache-2.0
#include "token.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace weft::live {
namespace {

using ::testing::HasSubstr;

class LiveToken : public ::testing::Test {
 protected:
  LiveToken() { std::filesystem::create_directories(folder_); }
  ~LiveToken() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& text, mode_t mode) {
    const std::string path = folder_ / "token";
    std::ofstream(path) << text;
    chmod(path.c_str(), mode);
    return path;
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("weft-token-" + std::to_string(getpid()));
};

TEST_F(LiveToken, IsReadWithoutTheEndOfItsLine) {
  for (const char* text : {"0123456789abcdef", "0123456789abcdef\n", " 0123456789abcdef\r\n\n"}) {
    const auto token = token_in(file(text, 0600));
    ASSERT_TRUE(token) << token.error().message;
    EXPECT_EQ(*token, "0123456789abcdef");
  }
  EXPECT_TRUE(token_in(file("0123456789abcdef", 0400)));
}

TEST_F(LiveToken, IsRefusedWhereOtherUsersCanReadIt) {
  for (const mode_t mode : {0640U, 0604U, 0644U, 0620U, 0601U, 0777U}) {
    const auto token = token_in(file("0123456789abcdef", mode));
    ASSERT_FALSE(token) << mode;
    EXPECT_THAT(token.error().message, HasSubstr("chmod 600 "));
    EXPECT_EQ(token.error().message.find("0123456789"), std::string::npos);
  }
}

TEST_F(LiveToken, IsRefusedWhereTheFileHasNone) {
  EXPECT_THAT(token_in(file(" \n", 0600)).error().message, HasSubstr("has no token"));
  EXPECT_THAT(token_in(folder_ / "absent").error().message, HasSubstr("cannot be read"));
  chmod(folder_.c_str(), 0700);
  EXPECT_THAT(token_in(folder_).error().message, HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace weft::live
