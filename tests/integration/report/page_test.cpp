// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fake_results.hpp"
#include "fake_run.hpp"
#include "support/child.hpp"

namespace weft::lab {
namespace {

/// The script opens the page in a browser.
void use_page(const std::string& script, const std::string& page, const std::string& scratch) {
  std::filesystem::create_directories(WEFT_SCREENSHOTS);
  const auto used = testing::Child({"/usr/bin/node", std::string(WEFT_PAGE_SCRIPTS "/") + script,
                                    WEFT_WEB, page, WEFT_SCREENSHOTS},
                                   scratch)
                        .wait();
  EXPECT_EQ(used.exit_code, 0) << used.out << used.err;
}

/// Prerequisites for opening a page that are absent, or nothing.
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
  use_page("page_test.mjs", fake.folder() + "/report.html", scratch);
}

TEST(ReportPage, OfARunOpensInABrowserWithItsFramesAndItsShapes) {
  if (const std::string file = absent(); !file.empty()) {
    GTEST_SKIP() << file << " is absent: install chromium and npm, run scripts/bootstrap.sh";
  }
  TestRun run;
  write_eight_frames(run, true);
  compare_with_print(run);
  const std::string scratch = run.folder() + "/program";
  const auto report = testing::Child({WEFT_PROGRAM, "report", run.folder()}, scratch).wait();
  ASSERT_EQ(report.exit_code, 0) << report.err;
  use_page("run_page_test.mjs", run.folder() + "/report.html", scratch);
}

}  // namespace
}  // namespace weft::lab
