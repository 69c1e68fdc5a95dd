// SPDX-License-Identifier: Apache-2.0
// Line-by-line changes of the pipelines by a composer, with the program as users run it.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/child.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;

constexpr int kFrames = 6;
constexpr const char* kMatcher =
    "  - use: matchers/descriptor\n    params: {direction: image_to_template}\n";

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// `text` with its only `part` replaced.
std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  if (at == text.npos || text.find(part, at + 1) != text.npos) {
    throw std::runtime_error("there is not exactly one: " + part);
  }
  return text.replace(at, part.size(), by);
}

class OneLineChanges : public ::testing::Test {
 protected:
  OneLineChanges() {
    std::string pattern = (fs::temp_directory_path() / "weft_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
    fs::create_directory_symlink(WEFT_PIPELINES "/data", folder_ / "data");
  }
  ~OneLineChanges() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  Ended weft(const std::string& command, const std::string& pipeline,
             const std::vector<std::string>& more = {}) const {
    std::ofstream(path("pipeline.yaml")) << pipeline;
    std::vector<std::string> words{WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS, command,
                                   path("pipeline.yaml")};
    words.insert(words.end(), more.begin(), more.end());
    return Child(words, path("printed")).wait();
  }

  /// Runs a few frames and measures them: all are solved, with a mean error below the limit [mm].
  void expect_solved(const std::string& pipeline, double limit_mm) const {
    const Ended ran = weft(
        "run", pipeline,
        {"--set", "source.frames=" + std::to_string(kFrames), "--out", path("run"), "--quiet"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const Ended measured =
        Child({WEFT_PROGRAM, "eval", path("run"), "--json", path("metrics.json"), "--quiet"},
              path("printed"))
            .wait();
    ASSERT_EQ(measured.exit_code, 0) << measured.err;
    const json metrics = json::parse(read_text(path("metrics.json")));
    const json& all = metrics.at("all");
    const double mean_mm = all.at("error_solved").at("mean_mm");
    std::printf("mean %.2f mm, worst frame %.2f mm\n", mean_mm,
                all.at("error_solved").at("worst_mm").get<double>());
    EXPECT_EQ(all.at("solved"), kFrames);
    EXPECT_LT(mean_mm, limit_mm);
  }

  const std::string demo_ = read_text(WEFT_PIPELINES "/sparse.yaml");
  const std::string robusft_ = read_text(WEFT_PIPELINES "/robusft.yaml");

 private:
  fs::path folder_;
};

TEST_F(OneLineChanges, TheUnchangedDemoIsSolved) { expect_solved(demo_, 0.7); }

TEST_F(OneLineChanges, ThePapersPipelineIsSolved) { expect_solved(robusft_, 0.7); }

TEST_F(OneLineChanges, OpenCvsSiftTakesThePlaceOfSift) {
  expect_solved(replaced(demo_, "detectors/sift_fast", "detectors/sift"), 0.7);
}

TEST_F(OneLineChanges, OrbTakesThePlaceOfSift) {
  expect_solved(replaced(demo_, "detectors/sift_fast", "detectors/orb"), 1.5);
}

TEST_F(OneLineChanges, AkazeTakesThePlaceOfSift) {
  expect_solved(replaced(demo_, "detectors/sift_fast", "detectors/akaze"), 1.5);
}

TEST_F(OneLineChanges, TheMatchesOfTwoDetectorsAreMerged) {
  expect_solved(replaced(demo_, kMatcher,
                         "  - {use: matchers/descriptor, as: sift}\n"
                         "  - use: detectors/orb\n"
                         "  - {use: matchers/descriptor, as: orb}\n"
                         "  - {use: matchers/merge, from: {correspondences: [sift, orb]}}\n"),
                0.7);
}

TEST_F(OneLineChanges, ASolverRunsTwice) {
  const std::size_t begin = robusft_.find("  - use: solvers/particle_sft\n");
  const std::string solver = robusft_.substr(begin, robusft_.find("sinks:") - begin);
  expect_solved(replaced(robusft_, solver, solver + solver), 0.7);
}

TEST_F(OneLineChanges, WorkThatWouldBeLostIsRefusedWithTheFix) {
  const Ended two = weft("check", replaced(demo_, kMatcher,
                                           "  - use: matchers/descriptor\n"
                                           "  - use: detectors/orb\n"
                                           "  - use: matchers/descriptor\n"));
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_EQ(
      two.err,
      path("pipeline.yaml") +
          ":15:5: no component reads the correspondences of 'matchers', because 'matchers#2' makes "
          "new ones; name it with as: NAME and take what it makes with from: {correspondences: "
          "NAME}, or omit all unused ones: --set without=detectors,matchers\n"
          "   15 |   - use: matchers/descriptor\n"
          "      |     ^\n");
  const Ended merged = weft("check", replaced(demo_, kMatcher,
                                              "  - use: matchers/descriptor\n"
                                              "  - use: detectors/orb\n"
                                              "  - use: matchers/descriptor\n"
                                              "  - use: matchers/merge\n"));
  EXPECT_EQ(merged.exit_code, 2);
  EXPECT_THAT(merged.err, AllOf(HasSubstr(":18:5: matchers/merge unites several"),
                                HasSubstr("from: {correspondences: [matchers, matchers#2]}")));
  // A filter that an extending file adds without a position comes last.
  const Ended late = weft("check", "weft: 1\nextends: " WEFT_PIPELINES
                                   "/sparse.yaml\nstages:\n"
                                   "  - {use: filters/myneighbor, as: again}\n");
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_THAT(late.err, AllOf(HasSubstr(":4:5: only sinks read the correspondences of 'again'"),
                              HasSubstr("move it up, before 'warps'")));
}

TEST_F(OneLineChanges, ASinkKeepsItsNameWhenAnotherIsLeftOut) {
  const Ended ended =
      weft("check", "weft: 1\nextends: " WEFT_PIPELINES "/sparse.yaml\nwithout: [overlay]\n",
           {"--set", "meshes.path=elsewhere"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 sinks"));
}

TEST_F(OneLineChanges, AStageWithoutItsInputIsRefusedWithReasonAndFix) {
  const Ended ended = weft("check", replaced(demo_,
                                             "  - use: warps/bbs\n"
                                             "    params: {robust: geman_mcclure}\n",
                                             ""));
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("passes/salient_cells requires 'warp"),
                    HasSubstr("which no earlier stage produces"), HasSubstr("warps/bbs")));
}

}  // namespace
}  // namespace weft
