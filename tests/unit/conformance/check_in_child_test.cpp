// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/check_in_child.hpp"

#include <gmock/gmock.h>

#include <thread>

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

}  // namespace
}  // namespace weft::conformance
