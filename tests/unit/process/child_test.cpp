// SPDX-License-Identifier: Apache-2.0
#include "process/child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "process/program.hpp"

namespace weft::process {
namespace {

using std::chrono::milliseconds;

const auto kForEver = [] { return true; };

std::unique_ptr<Child> shell(const std::string& script) {
  auto child = Child::start(Program{.words = {"sh", "-c", script}, .out = kPipe});
  EXPECT_TRUE(child);
  return *std::move(child);
}

TEST(AChild, OfAProgramHasItsSettingsInsteadOfThoseOfThisProcess) {
  setenv("WEFT_TEST_SETTING", "outer", 1);
  const auto answer =
      run_program({"sh", "-c", "echo $WEFT_TEST_SETTING"}, {"WEFT_TEST_SETTING=inner"});
  unsetenv("WEFT_TEST_SETTING");
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->out, "inner\n");
}

TEST(AChild, ThatIsKilledIsKilledWithWhatItHasStarted) {
  const auto child = shell("sleep 600 & echo; wait");
  child->listen([&] { return child->out().empty(); });
  EXPECT_FALSE(child->ending());
  EXPECT_EQ(child->end({}).signal, SIGKILL);
  for (int waited_ms = 0; child->out_file() >= 0 && waited_ms < 5000; ++waited_ms) {
    child->read();
    poll(nullptr, 0, 1);
  }
  EXPECT_LT(child->out_file(), 0) << "the pipe is still open in the process that it started";
}

TEST(AChild, ThatIgnoresSigtermIsKilledAfterThePatience) {
  const auto child = shell("trap '' TERM; echo; while :; do sleep 0.01; done");
  child->listen([&] { return child->out().empty(); });
  EXPECT_EQ(child->end(milliseconds(50)).signal, SIGKILL);
  const auto other = shell("echo; while :; do sleep 0.01; done");
  other->listen([&] { return other->out().empty(); });
  EXPECT_EQ(other->end().signal, SIGTERM);
}

TEST(AChild, ThatAnotherPartHasWaitedForHasAnUnknownEnding) {
  std::signal(SIGCHLD, SIG_IGN);
  const auto child = shell("exit 3");
  child->listen(kForEver);
  std::signal(SIGCHLD, SIG_DFL);
  ASSERT_TRUE(child->ending());
  EXPECT_FALSE(child->ending()->is_known);
}

TEST(ACopy, WritesIntoAPipeAndPrintsIntoMemory) {
  const auto copy = Child::start(Copy{.work =
                                          [](int pipe) {
                                            std::printf("one\ntwo\tand\n\n");
                                            std::fflush(stdout);
                                            return write(pipe, "said", 4) == 4 ? 7 : 1;
                                          },
                                      .out = kMemory});
  ASSERT_TRUE(copy) << copy.error().message;
  (*copy)->listen(kForEver);
  EXPECT_EQ((*copy)->out(), "said");
  EXPECT_EQ((*copy)->ending()->exit_code, 7);
  EXPECT_EQ((*copy)->last_line(), "two and");
  EXPECT_EQ((*copy)->empty_memory(), 0U) << "there is little in it";
}

TEST(ACopy, KeepsAsMuchOfItsPipeAsWasAskedFor) {
  const auto copy = Child::start(Copy{.work =
                                          [](int pipe) {
                                            const std::string text(100'000, 'x');
                                            for (int i = 0; i < 2; ++i) {
                                              if (write(pipe, text.data(), text.size()) < 0)
                                                return 1;
                                            }
                                            return 0;
                                          },
                                      .most_bytes = 100'000});
  ASSERT_TRUE(copy) << copy.error().message;
  (*copy)->listen(kForEver);
  EXPECT_EQ((*copy)->ending()->exit_code, 0) << "it was not held up";
  EXPECT_GE((*copy)->out().size(), 100'000U);
  EXPECT_LT((*copy)->out().size(), 105'000U);
}

TEST(ACopy, HasASessionOfItsOwn) {
  const auto copy = Child::start(
      Copy{.work = [](int) { return getsid(0) == getpid() && getpgrp() == getpid() ? 7 : 1; }});
  ASSERT_TRUE(copy) << copy.error().message;
  (*copy)->listen(kForEver);
  EXPECT_EQ((*copy)->ending()->exit_code, 7);
}

TEST(ACopy, CanWriteNoFileOfMoreThan16GiB) {
  const auto length_beyond = [](off_t beyond_bytes) {
    const auto copy = Child::start(Copy{.work = [&](int) {
      std::signal(SIGXFSZ, SIG_IGN);
      const int file = memfd_create("large", 0);
      return ftruncate(file, (off_t{16} << 30) + beyond_bytes) == 0 ? 0 : errno;
    }});
    (*copy)->listen(kForEver);
    return (*copy)->ending()->exit_code;
  };
  EXPECT_EQ(length_beyond(0), 0);
  EXPECT_EQ(length_beyond(1), EFBIG);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ACopy, CannotTakeTheMemoryOfTheMachine) {
  const auto copy = Child::start(Copy{.work = [](int) {
    const auto all_bytes = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                           static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    void* volatile memory = std::malloc(all_bytes / 5 * 4);  // never written
    std::free(memory);
    return memory == nullptr ? 7 : 1;
  }});
  ASSERT_TRUE(copy) << copy.error().message;
  (*copy)->listen(kForEver);
  EXPECT_EQ((*copy)->ending()->exit_code, 7);
}
#endif

TEST(TheTextOfASignal, HasItsNumberAndName) {
  EXPECT_EQ(signal_text(SIGSEGV), "signal 11 (Segmentation fault)");
  EXPECT_EQ(signal_text(1000), "signal 1000 (?)");
}

}  // namespace
}  // namespace weft::process
