// SPDX-License-Identifier: Apache-2.0
// A results folder with a flipped, cut or edited file names that file, or has the same results.

#include "ablation_fixture.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;

class DamagedFolder : public AblationTest {
 protected:
  DamagedFolder()
      : grid_(expand("axes: {every: {set: filters.every, values: [2, 3]}}\ndata: {all: {}}\n"
                     "comparisons: [{axis: every, metric: counts.frames}]\n")) {
    run(grid_, "out");
  }

  /// The content from which a report is made.
  std::string content(const Results& results) const {
    std::string text = to_json(results.plan) + results.version +
                       std::to_string(results.match_tolerance_px) +
                       std::to_string(results.accept_rebuilt);
    for (const auto& [key, record] : results.records.cells) {
      text += key + std::to_string(record.frames) + std::to_string(record.failed());
    }
    return text;
  }

  /// The faults that the folder reports; "same" if its results are unchanged.
  std::string said(const std::string& expected) const {
    const auto results = read_results(path("out"));
    if (!results) return results.error().where + ": " + results.error().message;
    std::string faults;
    for (const Damage& damage : results->records.damaged) faults += damage.where + "\n";
    return faults.empty() && content(*results) == expected ? "same" : faults;
  }

  Grid grid_;
};

TEST_F(DamagedFolder, NamesTheFileWhicheverBitOfItIsFlipped) {
  const std::string expected = content(*read_results(path("out")));
  for (const std::string name : {"plan.json", "manifest.json", "results/cached-000001.jsonl"}) {
    const std::string file = path("out/" + name), good = weft::testing::read_text(file);
    int flipped = 0, noticed = 0;
    for (std::size_t at = 0; at < good.size(); at += good.size() / 97 + 1) {
      std::string text = good;
      text[at] = static_cast<char>(text[at] ^ (1 << at % 7));
      std::ofstream(file) << text;
      const std::string answer = said(expected);
      const bool lost_its_end = name.ends_with("l") && at + 1 == good.size();
      EXPECT_TRUE(answer == "same" || answer.find(file) != answer.npos || lost_its_end)
          << name << ", byte " << at << ": " << answer;
      ++flipped;
      noticed += answer != "same";
    }
    EXPECT_GT(10 * noticed, 8 * flipped) << name;
    std::ofstream(file) << good;
  }
  EXPECT_EQ(said(expected), "same");
}

TEST_F(DamagedFolder, NamesAFileThatWasCut) {
  const std::string expected = content(*read_results(path("out")));
  for (const std::string name : {"plan.json", "manifest.json"}) {
    const std::string file = path("out/" + name), good = weft::testing::read_text(file);
    for (const std::size_t size : {std::size_t{0}, good.size() / 2, good.size() - 2}) {
      std::ofstream(file) << good.substr(0, size);
      EXPECT_THAT(said(expected), HasSubstr(file)) << size;
    }
    std::ofstream(file) << good;
  }
}

TEST_F(DamagedFolder, TakesAPlanThatWasEditedForDamageUntilItIsWrittenAnew) {
  const std::string file = path("out/plan.json");
  json plan = json::parse(weft::testing::read_text(file));
  std::swap(plan["cells"][0]["axes"], plan["cells"][1]["axes"]);  // names the one the other
  std::ofstream(file) << plan.dump(1);
  const auto edited = read_results(path("out"));
  ASSERT_FALSE(edited);
  EXPECT_EQ(edited.error().where, file);
  EXPECT_EQ(edited.error().message,
            "was changed after it was written; `weft ablate` of the plan writes it anew");
  EXPECT_EQ(run(grid_, "out").done, 2U);
  EXPECT_TRUE(read_results(path("out")));
  plan.erase("check");
  std::ofstream(file) << plan.dump(1);
  EXPECT_TRUE(read_results(path("out"))) << "older programs wrote none";
}

TEST_F(DamagedFolder, GoesOnWithItsCellsWhereManifestOrPlanAreLost) {
  const std::string expected = content(*read_results(path("out")));
  const std::string lines = weft::testing::read_text(path("out/results/cached-000001.jsonl"));
  using Names = std::vector<std::string>;
  for (const Names& names :
       {Names{"manifest.json"}, Names{"plan.json"}, Names{"manifest.json", "plan.json"}}) {
    for (const int share : {-1, 0, 50}) {  // [%] that is left; -1: there is no file
      for (const std::string& name : names) {
        const std::string file = path("out/" + name), good = weft::testing::read_text(file);
        const std::size_t size = good.size() * static_cast<std::size_t>(std::max(share, 0)) / 100;
        std::ofstream(file) << good.substr(0, size) << std::string(share > 0 ? 9 : 0, '\0');
        if (share < 0) std::filesystem::remove(file);
      }
      const auto looked = ResultsFolder::look(path("out"), "plan");
      ASSERT_TRUE(looked) << looked.error().message;
      ASSERT_EQ(looked->rebuilt().size(), names.size());
      EXPECT_THAT(looked->rebuilt()[0], HasSubstr(path("out/" + names[0]) + ": is "));
      EXPECT_THAT(read_results(path("out")).error().message,
                  HasSubstr("`weft ablate` of the plan writes it anew"));
      EXPECT_EQ(run(grid_, "out").done, 2U);
      EXPECT_EQ(said(expected), "same");
      EXPECT_TRUE(ResultsFolder::look(path("out"), "plan")->rebuilt().empty());
    }
  }
  EXPECT_EQ(weft::testing::read_text(path("out/results/cached-000001.jsonl")), lines);
  EXPECT_FALSE(std::filesystem::exists(path("out/results/cached-000002.jsonl")))
      << "no cell has run again";
}

TEST_F(DamagedFolder, WithoutAManifestIsStillThatOfItsPlan) {
  std::filesystem::remove(path("out/manifest.json"));
  const auto other = ResultsFolder::look(path("out"), "another");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("holds the results of the plan 'plan'"));
}

TEST(FolderOfOthers, IsNotTakenForResultsWhateverItsNames) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "of_others";
  std::filesystem::create_directories(folder / "results");
  std::ofstream(folder / "results" / "notes.txt") << "x";
  std::ofstream(folder / "notes.txt") << "x";
  for (const char* text : {"", "{", "no JSON"}) {
    std::ofstream(folder / "manifest.json") << text;
    EXPECT_FALSE(ResultsFolder::look(folder.string(), "plan")) << text;
  }
  std::filesystem::remove_all(folder);
}

TEST_F(DamagedFolder, IsNotWrittenToWhereItsManifestWasEdited) {
  const std::string file = path("out/manifest.json");
  json manifest = json::parse(weft::testing::read_text(file));
  manifest["metrics"]["match_tolerance_px"] = 3;
  std::ofstream(file) << manifest.dump(2);
  for (const auto& refused : {ResultsFolder::open(path("out"), "plan").error(),
                              ResultsFolder::look(path("out"), "plan").error()}) {
    EXPECT_EQ(refused.where, file);
    EXPECT_THAT(refused.message, HasSubstr("was changed after it was written; put it back"));
  }
}

}  // namespace
}  // namespace weft::lab
