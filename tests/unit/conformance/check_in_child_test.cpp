// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/check_in_child.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <thread>

#include "kit/conformance/probes/processor_time.hpp"

namespace weft::conformance {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::chrono::seconds kLongest{1};

TEST(CheckInChild, EndsACheckThatTakesTooLongAndKeepsThoseBeforeIt) {
  const auto findings = check_in_child("group/first", {}, kLongest, [](Notebook& notebook) {
    notebook.check("group/quick", [](Page& page) { page.note("done"); });
    notebook.check("group/endless",
                   [](Page&) { std::this_thread::sleep_for(std::chrono::hours(1)); });
    notebook.check("group/behind_it", [](Page&) {});
  });
  ASSERT_THAT(findings, SizeIs(2));
  EXPECT_EQ(findings[0].check, "group/quick");
  EXPECT_EQ(findings[0].verdict, Verdict::holds);
  EXPECT_EQ(findings[1].check, "group/endless");
  EXPECT_EQ(findings[1].verdict, Verdict::fails);
  EXPECT_THAT(findings[1].seen, HasSubstr("not done after 1 s; what comes after it in its group"));
}

TEST(CheckInChild, GivesEachCheckTimeOfItsOwn) {
  const auto findings = check_in_child("group/first", {}, kLongest, [](Notebook& notebook) {
    for (const char* name : {"group/a", "group/b", "group/c", "group/d"}) {
      notebook.check(name, [](Page&) { std::this_thread::sleep_for(milliseconds(400)); });
    }
  });
  ASSERT_THAT(findings, SizeIs(4));
  for (const Finding& finding : findings)
    EXPECT_EQ(finding.verdict, Verdict::holds) << finding.seen;
}

/// Uses this much CPU time.
void compute(std::chrono::duration<double, std::milli> time) {
  const double end_ms = own_processor_ms() + time.count();
  while (own_processor_ms() < end_ms) continue;
}

TEST(CheckInChild, LetsACheckGoOnThatWaitsForAProcessorMoreThanItComputes) {
  const auto findings = check_in_child("group/first", {}, kLongest, [](Notebook& notebook) {
    notebook.check("group/slow", [](Page&) {
      for (int i = 0; i < 20; ++i) {  // as on a machine that gives it a tenth of a processor
        std::this_thread::sleep_for(milliseconds(90));
        compute(milliseconds(10));
      }
    });
  });
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].verdict, Verdict::holds) << findings[0].seen;
}

TEST(CheckInChild, CountsTheCpuTimeOfProcessesThatACheckStarts) {
  const auto findings = check_in_child("group/first", {}, kLongest, [](Notebook& notebook) {
    notebook.check("group/starts", [](Page&) {
      if (fork() == 0) compute(std::chrono::hours(1));
      while (true) {  // too little to be late, and too much to be asleep
        std::this_thread::sleep_for(milliseconds(95));
        compute(milliseconds(5));
      }
    });
  });
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_THAT(findings[0].seen, HasSubstr("not done after 1 s"));
}

TEST(CheckInChild, KeepsTheRemarkOnTheCheckThatDoesNotReturn) {
  const auto findings = check_in_child("group/first", {}, kLongest, [](Notebook& notebook) {
    notebook.check("group/remarked", [](Page&) { remark_on_end("an old remark: "); });
    notebook.check("group/ended", [](Page&) {
      remark_on_end("it does something: ");
      _exit(1);
    });
  });
  ASSERT_THAT(findings, SizeIs(2));
  EXPECT_THAT(findings[1].seen, ::testing::StartsWith("it does something: it ended its process"));
}

}  // namespace
}  // namespace weft::conformance
