// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/library_call.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>

namespace weft::host {
namespace {

TEST(ProcessId, IsThatOfACopyThatABareSystemCallMade) {
  ASSERT_EQ(process_id(), getpid());
  const auto child = static_cast<pid_t>(syscall(SYS_fork));
  if (child == 0) _exit(process_id() == getpid() && process_id() == getpid() ? 0 : 1);
  ASSERT_GT(child, 0);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(process_id(), getpid());
}

}  // namespace
}  // namespace weft::host
