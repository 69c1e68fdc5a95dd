// SPDX-License-Identifier: Apache-2.0
#include "host/probing/child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace weft::host {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Answered = Result<std::string>;

constexpr milliseconds kPlenty{60'000};

Answered ask(const std::function<Answered()>& find_out) { return ask_in_child(find_out, kPlenty); }

TEST(AnAnswerOfAChild, ComesWholeHoweverLongItIs) {
  const std::string text = std::string(3'000'000, 'x') + '\0' + "end";
  const auto answer = ask([&]() -> Answered { return text; });
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, text);
  EXPECT_EQ(*ask([]() -> Answered { return std::string(); }), "");
}

TEST(AnAnswerOfAChild, MayBeAnErrorOrThrown) {
  const auto refused = ask([]() -> Answered { return Error{Errc::syntax, "is no text", "a.so"}; });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::syntax);
  EXPECT_EQ(refused.error().message, "is no text");
  EXPECT_EQ(refused.error().where, "a.so");
  const auto thrown = ask([]() -> Answered { throw std::runtime_error("too large"); });
  ASSERT_FALSE(thrown);
  EXPECT_EQ(thrown.error().message, "throws: too large");
}

TEST(AChild, ThatEndsInsteadOfAnsweringIsAnErrorWithWhatEndedIt) {
  const auto left = ask([]() -> Answered { _exit(7); });
  ASSERT_FALSE(left);
  EXPECT_EQ(left.error().message, "ends the process that loads it by exit(7)");
  const auto killed = ask([]() -> Answered {
    raise(SIGKILL);
    return std::string();
  });
  ASSERT_FALSE(killed);
  EXPECT_THAT(killed.error().message, HasSubstr("by signal 9 ("));
}

TEST(AChild, ThatHangsIsKilledAlsoWhenItHasLeftThePipeToAnother) {
  const auto hangs = ask_in_child(
      []() -> Answered {
        if (fork() == 0) pause();
        pause();
        return std::string();
      },
      milliseconds(200));
  ASSERT_FALSE(hangs);
  EXPECT_EQ(hangs.error().message, "does not come to an end within 0.2 s");
  const auto leaves_one = ask([]() -> Answered {
    if (fork() == 0) pause();
    _exit(3);
  });
  ASSERT_FALSE(leaves_one);
  EXPECT_EQ(leaves_one.error().message, "ends the process that loads it by exit(3)");
}

/// How many processes there are whose first word is that of this test: copies of it.
std::size_t copies() {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::error_code code;
    const auto program = std::filesystem::read_symlink(entry.path() / "exe", code);
    count += !code && program == std::filesystem::read_symlink("/proc/self/exe") ? 1 : 0;
  }
  return count;
}

TEST(AChild, LeavesNoProcessBehindWhateverItsSession) {
  const std::size_t before = copies();
  const auto answer = ask([]() -> Answered {
    if (fork() == 0) {
      setsid();
      if (fork() == 0) pause();
      _exit(0);
    }
    return std::string("said");
  });
  EXPECT_EQ(*answer, "said");
  EXPECT_EQ(copies(), before);
}

TEST(AChild, ThatStartsProcessesWithoutEndIsEndedWithThem) {
  const std::size_t before = copies();
  const auto answer = ask([]() -> Answered {
    while (true) {
      if (fork() != 0) continue;
      setsid();
      pause();
    }
  });
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message, "started more than 256 processes, and was ended with them");
  EXPECT_EQ(copies(), before);
}

TEST(AChild, OfWhichACopyReturnsTooGivesOneAnswer) {
  const auto answer = ask([]() -> Answered {
    const pid_t copy = fork();
    return std::string(copy == 0 ? "the copy" : "the child");
  });
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, "the child");
}

TEST(AChild, IsNotHeardAndChangesNothingHere) {
  int here = 1;
  ::testing::internal::CaptureStdout();
  std::printf("before ");
  const auto answer = ask([&]() -> Answered {
    here = 2;
    std::printf("what nobody asked for");
    std::fflush(stdout);
    return std::string("said");
  });
  std::printf("after");
  std::fflush(stdout);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "before after");
  EXPECT_EQ(*answer, "said");
  EXPECT_EQ(here, 1);
}

}  // namespace
}  // namespace weft::host
