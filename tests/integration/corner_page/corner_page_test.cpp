// SPDX-License-Identifier: Apache-2.0
// `weft template make` where it finds no corners, and the page that it leaves.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kNode = "/usr/bin/node";

/// The first of these files that is absent, or nothing.
std::string absent(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    if (!fs::exists(file)) return file;
  }
  return "";
}

class CornerPageOfTheCommand : public PipelineTest {
 protected:
  /// `weft template make` of a photograph, into `out`.
  Ended make(const std::string& photo, const std::string& out,
             const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{
        WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS, "template", "make",   "--photo",
        photo,        "--width",       "0.297",           "--out",    path(out)};
    words.insert(words.end(), more.begin(), more.end());
    return Child(std::move(words), path("said")).wait();
  }

  /// Runs `template make` on the repository's own photograph.
  Ended make_sheet(const std::string& out, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--camera", WEFT_DATA_FOLDER "/sheet_photo_camera.yaml", "--json"});
    return make(WEFT_DATA_FOLDER "/sheet_photo.jpg", out, more);
  }

  /// A plain photograph, in which nothing is found.
  std::string plain_photo() const {
    return write("P5 320 240 255\n" + std::string(320 * 240, '\x80'), "plain.pgm");
  }

  Ended run_script(const std::string& script, const std::string& page) const {
    fs::create_directories(WEFT_SCREENSHOTS);
    return Child({kNode, std::string(WEFT_PAGE_SCRIPTS "/") + script, WEFT_WEB, page,
                  WEFT_SCREENSHOTS},
                 path("script"))
        .wait();
  }
};

TEST_F(CornerPageOfTheCommand, IsWrittenBesideTheFolderThatIsNotMade) {
  const Ended refused = make(plain_photo(), "poster");
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  const std::string page = path("poster_corners.html");
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("no object is found"), HasSubstr("open " + page + " in a browser")));
  EXPECT_FALSE(fs::exists(path("poster")));
  EXPECT_TRUE(read_text(page).starts_with("<!DOCTYPE html>"));
  fs::create_directory(path("empty"));
  EXPECT_THAT(make(plain_photo(), "empty/").err, HasSubstr(path("empty_corners.html")));
  EXPECT_TRUE(fs::is_empty(path("empty")));
}

TEST_F(CornerPageOfTheCommand, ShowsTheTextThatTheCommandTakes) {
  if (const auto file = absent({kNode}); !file.empty()) {
    GTEST_SKIP() << file << " is absent: install nodejs";
  }
  make(plain_photo(), "poster");
  const Ended of_none = run_script("text_test.mjs", path("poster_corners.html"));
  EXPECT_EQ(of_none.exit_code, 0) << of_none.out << of_none.err;
  const Ended found = make_sheet("found");
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const Ended of_found = run_script("text_test.mjs", path("found/corners.html"));
  ASSERT_EQ(of_found.exit_code, 0) << of_found.out << of_found.err;
  const auto texts = nlohmann::json::parse(read_text(path("found/corners.html.json")));
  const Ended again = make_sheet("again", {"--corners", texts.at("corners").get<std::string>()});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto first = nlohmann::json::parse(found.out), second = nlohmann::json::parse(again.out);
  for (const std::size_t axis : {0, 1}) {
    EXPECT_NEAR(second.at("size_mm").at(axis), first.at("size_mm").at(axis), 0.2);
  }
  const Ended by_name = make_sheet("named", {"--set", texts.at("setting").get<std::string>()});
  EXPECT_EQ(by_name.out, again.out) << by_name.err;
}

TEST_F(CornerPageOfTheCommand, IsUsedByMouseAndKeyboardInLightAndDarkOnWideAndNarrowScreens) {
  if (const auto file =
          absent({kNode, "/usr/bin/chromium", WEFT_WEB "/node_modules/puppeteer-core"});
      !file.empty()) {
    GTEST_SKIP() << file << " is absent: install chromium and npm, run scripts/bootstrap.sh";
  }
  const Ended found = make_sheet("found");
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const Ended used = run_script("page_test.mjs", path("found/corners.html"));
  EXPECT_EQ(used.exit_code, 0) << used.out << used.err;
}

}  // namespace
}  // namespace weft::testing
