// SPDX-License-Identifier: Apache-2.0
#include "process/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/types.h>

#include <csignal>

namespace weft::process {
namespace {

using std::chrono::milliseconds;

TEST(RunProgram, ReturnsWhatAProgramPrintsAndHowItEnds) {
  const auto answer =
      run_program({"/bin/sh", "-c", "echo $SAID; echo no >&2; exit 3"}, {"SAID=yes"});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->out, "yes\n");
  EXPECT_EQ(answer->err, "no\n");
  EXPECT_EQ(answer->exit_code, 3);
  EXPECT_FALSE(answer->late);
}

TEST(RunProgram, EndsOneThatTakesTooLong) {
  // The second has closed what could be waited for.
  for (const char* script : {"echo first; exec sleep 60", "exec >&- 2>&-; exec sleep 60"}) {
    const auto answer = run_program({"/bin/sh", "-c", script}, {}, milliseconds(200));
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_TRUE(answer->late) << script;
    EXPECT_EQ(answer->exit_code, 128 + 9) << script;
  }
  const auto quick = run_program({"/bin/sh", "-c", "echo done"}, {}, milliseconds(60'000));
  ASSERT_TRUE(quick);
  EXPECT_EQ(quick->out, "done\n");
  EXPECT_FALSE(quick->late);
}

TEST(RunProgram, DoesNotWaitForWhatAProgramLeavesBehind) {
  const auto answer = run_program({"/bin/sh", "-c", "echo $$; sleep 600 & echo $!; exit 4"});
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->exit_code, 4);
  const std::size_t line = answer->out.find('\n');
  ASSERT_NE(line, std::string::npos);
  const pid_t left = std::stoi(answer->out.substr(line + 1));
  EXPECT_EQ(kill(left, SIGKILL), 0) << "it was still there";
}

TEST(RunProgram, SaysThatThereIsNoSuchProgram) {
  const auto none = run_program({"/no/such/program"});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::not_found);
}

}  // namespace
}  // namespace weft::process
