// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fake_results.hpp"
#include "support/child.hpp"

namespace weft::evaluation {
namespace {

/// What is absent of what opens a page, or nothing.
std::string absent() {
  for (const char* file : {WEFT_REPORT_ASSETS "/report.js", WEFT_WEB "/node_modules/puppeteer-core",
                           "/usr/bin/chromium", "/usr/bin/node"}) {
    if (!std::filesystem::exists(file)) return file;
  }
  return "";
}

TEST(ReportPage, OpensInABrowserWithItsCurvesAndItsShapes) {
  if (const std::string file = absent(); !file.empty()) {
    GTEST_SKIP() << file << " is absent: install chromium and npm, run scripts/bootstrap.sh";
  }
  FakeResults::Choice choice;
  choice.timing = choice.shapes = true;
  const FakeResults fake(choice);
  const std::string scratch = fake.folder() + "/program";
  const auto report = testing::Child({WEFT_PROGRAM, "report", fake.folder()}, scratch).wait();
  ASSERT_EQ(report.exit_code, 0) << report.err;
  std::filesystem::create_directories(WEFT_SCREENSHOTS);
  const auto page = testing::Child({"/usr/bin/node", WEFT_PAGE_SCRIPT, WEFT_WEB,
                                    fake.folder() + "/report.html", WEFT_SCREENSHOTS},
                                   scratch)
                        .wait();
  EXPECT_EQ(page.exit_code, 0) << page.out << page.err;
}

}  // namespace
}  // namespace weft::evaluation
