// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/child.hpp"

namespace weft {
namespace {

/// The first of these files that is absent, or nothing.
std::string absent(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    if (!std::filesystem::exists(file)) return file;
  }
  return "";
}

void run_script(const std::string& script) {
  std::filesystem::create_directories(WEFT_SCREENSHOTS);
  const auto ended = testing::Child({"/usr/bin/node", std::string(WEFT_PAGE_SCRIPTS "/") + script,
                                     WEFT_WEB, WEFT_SCREENSHOTS},
                                    std::string(WEFT_SCREENSHOTS "/") + script)
                         .wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
}

TEST(LivePage, ReadsFramesAndMakesWordsControlsAndChangeRequestsOfThem) {
  if (const auto file = absent({WEFT_WEB "/node_modules/three", "/usr/bin/node"}); !file.empty()) {
    GTEST_SKIP() << file << " is absent: install npm, run scripts/bootstrap.sh";
  }
  run_script("frames_test.mjs");
  run_script("steering_test.mjs");
  run_script("recording_test.mjs");
}

TEST(LivePage, ShowsARunInABrowserAndSteersIt) {
  if (const auto file =
          absent({WEFT_WEB "/dist/live.js", WEFT_WEB "/node_modules/ws",
                  WEFT_WEB "/node_modules/puppeteer-core", WEFT_WEB "/node_modules/axe-core",
                  "/usr/bin/chromium", "/usr/bin/node"});
      !file.empty()) {
    GTEST_SKIP() << file << " is absent: install chromium and npm, run scripts/bootstrap.sh";
  }
  run_script("page_test.mjs");
  run_script("keyboard_test.mjs");
  run_script("settings_test.mjs");
  run_script("camera_test.mjs");
  run_script("bad_input_test.mjs");
  run_script("recording_page_test.mjs");
}

}  // namespace
}  // namespace weft
