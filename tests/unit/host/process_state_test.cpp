// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/process_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <clocale>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <locale>

namespace weft::host {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

void run_on_one_processor() {
  cpu_set_t set;
  sched_getaffinity(0, sizeof(set), &set);
  std::size_t first = 0;
  while (!CPU_ISSET(first, &set)) ++first;
  CPU_ZERO(&set);
  CPU_SET(first, &set);
  sched_setaffinity(0, sizeof(set), &set);
}

void block_a_signal() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void allow_few_files() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = 64;
  setrlimit(RLIMIT_NOFILE, &limit);
}

void start_a_timer() {
  const itimerval hour{{0, 0}, {3600, 0}};
  setitimer(ITIMER_REAL, &hour, nullptr);
}

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

void make_a_posix_timer() {
  timer_t timer{};
  sigevent event{};
  event.sigev_notify = SIGEV_NONE;
  timer_create(CLOCK_MONOTONIC, &event, &timer);
}

/// A change of a process, and the part of its state that it changes.
struct Disturbance {
  const char *name, *part;
  void (*make)();
};

const Disturbance kDisturbances[] = {
    {"Limit", "resource limits", allow_few_files},
    {"Timer", "timers", start_a_timer},
    {"PosixTimer", "timers", make_a_posix_timer},
    {"Handler", "signals", [] { std::signal(SIGUSR2, SIG_IGN); }},
    {"Mask", "signals", block_a_signal},
    {"Affinity", "CPU affinity", run_on_one_processor},
    {"LocaleOfC", "locale", [] { std::setlocale(LC_ALL, "C.UTF-8"); }},
    {"LocaleOfStreams", "locale",
     [] {
       std::locale::global({std::locale(), new Comma});
     }},
    {"Umask", "umask", [] { umask(0777); }},
    {"Folder", "working directory", [] { static_cast<void>(!chdir("/proc")); }},
    {"Terminate", "terminate handler", [] { std::set_terminate([] { std::abort(); }); }},
    {"TimeZone", "environment", [] { setenv("TZ", "XYZ-3", 1); }},
    {"NoEnvironment", "environment", [] { clearenv(); }}};

class ProcessStateTest : public ::testing::TestWithParam<Disturbance> {};

TEST_P(ProcessStateTest, IsNamedWhereItChangesAndRestored) {
  const ProcessState before;
  GetParam().make();
  const std::string part = GetParam().part;
  if (part == "CPU affinity" && before.changes().empty()) GTEST_SKIP() << "one processor";
  ASSERT_THAT(before.changes(), SizeIs(1));
  EXPECT_EQ(before.changes()[0].part, part);
  EXPECT_EQ(before.restore("in a test"),
            "the process state changed in a test: " + part + " (restored)");
  EXPECT_THAT(before.changes(), IsEmpty());
  EXPECT_EQ(before.restore("in a test"), "");
}

INSTANTIATE_TEST_SUITE_P(, ProcessStateTest, ::testing::ValuesIn(kDisturbances),
                         [](const auto& test) { return test.param.name; });

TEST(ProcessState, ChangesByTheNewVariableOfARuntimeAreNone) {
  const ProcessState before;
  setenv("WEFT_TEST_RUNTIME", "1", 1);
  EXPECT_THAT(before.changes(), IsEmpty());
  unsetenv("WEFT_TEST_RUNTIME");
}

/// Only root may raise a priority.
TEST(ProcessState, ThatTheKernelDoesNotRestoreIsNamed) {
  const ProcessState before;
  const int lower = getpriority(PRIO_PROCESS, 0) + 1;
  ASSERT_EQ(setpriority(PRIO_PROCESS, 0, lower), 0);
  const std::string sentence = before.restore("in a test");
  const bool is_restored = getpriority(PRIO_PROCESS, 0) != lower;
  EXPECT_EQ(sentence, std::string("the process state changed in a test: priority (") +
                          (is_restored ? "restored)" : "cannot be restored)"));
}

}  // namespace
}  // namespace weft::host
