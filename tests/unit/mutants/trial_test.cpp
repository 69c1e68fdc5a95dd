// SPDX-License-Identifier: Apache-2.0
#include "mutants/trial.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <sstream>
#include <weft/core/text_file.hpp>

#include "testing/contract_cases.hpp"
#include "testing/contract_stages.hpp"

namespace weft::mutants {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<Original> plugins(const std::vector<std::string>& ids) {
  auto originals = originals_in(WEFT_PLUGIN_FOLDER, ids);
  EXPECT_TRUE(originals);
  return originals ? *std::move(originals) : std::vector<Original>{};
}

std::vector<Mutant> mutants_of(const Original& original, const std::vector<std::string>& names) {
  std::vector<Mutant> mutants;
  for (const std::string& name : names) {
    const Operator* change = name == "none" ? nullptr : find_operator(name);
    mutants.push_back({change, &original});
  }
  return mutants;
}

/// A judge that says what this script says; $0 is the manifest, $1 the group.
Judge script(const std::string& text) {
  const auto command = [=](const std::string& manifest, std::string_view group) {
    return std::vector<std::string>{"/bin/sh", "-c", text, manifest, std::string(group)};
  };
  return {command, std::chrono::seconds(20), 2};
}

/// The program that checks plugins.
Judge program() {
  const auto command = [](const std::string& manifest, std::string_view /*group*/) {
    std::istringstream check(WEFT_CHECK_WORDS);
    std::vector<std::string> words{std::istream_iterator<std::string>(check), {}};
    words.push_back(manifest);
    return words;
  };
  return {command, std::chrono::seconds(300), 1};
}

TEST(Mutant, WithoutAnOperatorAnswersBitByBitAsItsOriginalAndKeepsTheContract) {
  for (const char* id : {"detectors/orb", "matchers/descriptor", "filters/lpm", "warps/tps",
                         "passes/near_shape", "solvers/bartoli_isometric"}) {
    const auto originals = plugins({id});
    ASSERT_THAT(originals, SizeIs(1));
    const weft::testing::ScratchFolder folder;
    const auto made =
        make_mutant({nullptr, &originals.front()}, WEFT_MUTANT, folder.path().string());
    ASSERT_TRUE(made) << made.error().message;
    const std::string own = std::filesystem::path(*made).parent_path().string();
    const auto plain = host::Registry::scan({{WEFT_PLUGIN_FOLDER, "test"}});
    const auto mutated = host::Registry::scan({{own, "test"}, {WEFT_PLUGIN_FOLDER, "test"}});
    auto of_plain = weft::testing::Subject::find(plain, id, "{}", "/tmp");
    auto of_mutant = weft::testing::Subject::find(mutated, id, "{}", "/tmp");
    ASSERT_TRUE(of_plain && of_mutant);
    EXPECT_EQ(of_mutant->spec().installed->library->library.rfind(own, 0), 0U);
    for (const auto& given : weft::testing::cases_of(*of_plain)) {
      weft::testing::Performer one(*of_plain), other(*of_mutant);
      ASSERT_TRUE(one.begin(given.scene.templ, given.scene.camera));
      ASSERT_TRUE(other.begin(given.scene.templ, given.scene.camera));
      EXPECT_EQ(difference(other.call(kRunStage, given.inputs), one.call(kRunStage, given.inputs)),
                "")
          << id << ", " << given.name;
    }
    const auto report =
        weft::testing::check_role_contract(id, {.plugin_folders = {own, WEFT_PLUGIN_FOLDER}});
    EXPECT_THAT(report.failures, IsEmpty()) << id;
  }
}

TEST(Mutant, HasTheManifestOfItsOriginalButForTheBuildId) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const weft::testing::ScratchFolder folder;
  const auto made = make_mutant({find_operator("nan_in_output"), &originals.front()}, WEFT_MUTANT,
                                folder.path().string());
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_THAT(*made, HasSubstr("/nan_in_output.filters_lpm/filters_lpm.plugin.yaml"));
  const auto mine = host::read_manifest(*made), theirs = host::read_manifest(originals[0].manifest);
  ASSERT_TRUE(mine && theirs);
  EXPECT_NE(mine->build_id, theirs->build_id);
  std::string text = *read_text_file(*made, 1 << 20);
  const std::size_t at = text.find(mine->build_id);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, mine->build_id.size(), theirs->build_id);
  EXPECT_EQ(text, *read_text_file(originals[0].manifest, 1 << 20));
}

TEST(Mutants, AreCaughtByTheProgramOrSurviveItAndAreTold) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const std::vector<std::string> caught = {
      "wrong_magic", "describes_other_default", "nan_in_output", "writes_input", "counts_calls",
      "exits",       "error_without_text"};
  std::vector<Mutant> mutants = mutants_of(originals.front(), caught);
  // One that cannot be caught, for it is not wrong.
  mutants.push_back({find_operator("negative_depth"), &originals.front()});
  const weft::testing::ScratchFolder folder;
  int told = 0;
  const auto trials = try_mutants(mutants, WEFT_MUTANT, folder.path().string(), program(),
                                  [&](const Trial&) { ++told; });
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_EQ(told, 8);
  EXPECT_THAT(trials->wrong, IsEmpty());
  for (std::size_t i = 0; i < caught.size(); ++i) {
    const Verdict& verdict = trials->trials[i].verdict;
    EXPECT_TRUE(verdict.is_caught) << caught[i] << ", " << verdict.why;
    EXPECT_THAT(verdict.why, HasSubstr(": ")) << caught[i];
  }
  EXPECT_FALSE(trials->trials.back().verdict.is_caught);
  EXPECT_EQ(trials->trials.back().verdict.why, "all checks hold");
  EXPECT_EQ(trials->caught(), 7U);
  EXPECT_FALSE(trials->is_enough()) << "7 of 8 are less than 95 %";
  EXPECT_THAT(table_of(*trials), HasSubstr("| negative_depth.filters_lpm | contract | **no** |"));
}

TEST(Mutants, WhoseShapeLiesBehindTheCameraAreCaught) {
  const auto originals = plugins({"solvers/bartoli_isometric"});
  ASSERT_THAT(originals, SizeIs(1));
  const auto mutants = mutants_of(originals.front(), {"negative_depth"});
  const weft::testing::ScratchFolder folder;
  const auto trials = try_mutants(mutants, WEFT_MUTANT, folder.path().string(), program());
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_THAT(trials->trials[0].verdict.why, HasSubstr("lies behind the camera"));
  EXPECT_TRUE(trials->is_enough());
}

TEST(Mutants, AreCaughtByTheGroupThatTheirOperatorNamesAndNoOther) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const auto mutants = mutants_of(originals.front(), {"wrong_magic", "nan_in_output"});
  const weft::testing::ScratchFolder folder;
  // Of mutants alone: the group load tells of all, no other does.
  const Judge judge = script(
      "case $0 in */wrong_magic.*|*/nan_in_output.*) ;; *) exit 0;; esac\n"
      "case $1 in load) echo 'filters/lpm: 1 fail'; echo \"  fails     load/x: by '$1'\"; exit "
      "1;; *) exit 0;; esac");
  const auto trials = try_mutants(mutants, WEFT_MUTANT, folder.path().string(), judge);
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_EQ(trials->trials[0].verdict.why, "load/x: by 'load'");
  EXPECT_EQ(trials->trials[1].verdict.why, "all checks hold");
  EXPECT_EQ(
      table_of_groups(*trials),
      "| group | mutants | caught |\n|---|---|---|\n| load | 1 | 1 |\n| contract | 1 | 0 |\n");
  EXPECT_FALSE(trials->is_enough());
}

TEST(Mutants, NeedAnOriginalThatHoldsInTheirGroupAlone) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const auto mutants = mutants_of(originals.front(), {"wrong_magic", "nan_in_output"});
  const weft::testing::ScratchFolder folder;
  const Judge judge = script(
      "case $0$1 in */wrong_magic.*) ;; *load) exit 0;; esac\n"
      "echo filters/lpm: bad; exit 1");
  const auto trials = try_mutants(mutants, WEFT_MUTANT, folder.path().string(), judge);
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_TRUE(trials->trials[0].verdict.is_caught);
  EXPECT_FALSE(trials->trials[1].verdict.is_caught);
  EXPECT_THAT(trials->wrong, ::testing::ElementsAre("filters/lpm: bad"));
}

TEST(Mutants, OfAnOriginalThatDoesNotHoldSurvive) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const auto mutants = mutants_of(originals.front(), {"wrong_magic"});
  const weft::testing::ScratchFolder folder;
  const auto trials = try_mutants(mutants, WEFT_MUTANT, folder.path().string(),
                                  script("echo filters/lpm: bad; exit 1"));
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_THAT(trials->wrong, ::testing::ElementsAre("filters/lpm: bad"));
  EXPECT_EQ(trials->caught(), 0U);
  EXPECT_FALSE(trials->is_enough());
}

TEST(Mutants, AreNotCaughtByACheckThatCannotBeMade) {
  const auto originals = plugins({"filters/lpm"});
  ASSERT_THAT(originals, SizeIs(1));
  const auto mutants = mutants_of(originals.front(), {"wrong_magic"});
  const weft::testing::ScratchFolder folder;
  const auto trials =
      try_mutants(mutants, WEFT_MUTANT, folder.path().string(),
                  script("case $0 in */wrong_magic.*) echo no idea; exit 2;; esac; exit 0"));
  ASSERT_TRUE(trials) << trials.error().message;
  EXPECT_FALSE(trials->trials[0].verdict.is_caught);
  EXPECT_EQ(trials->trials[0].verdict.why, "the check ended with exit code 2: no idea");
}

TEST(MutantsPage, ListsTheOperators) {
  const auto page = read_text_file(WEFT_PAGE, 1 << 20);
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, HasSubstr(table_of_operators()))
      << "write it anew: tests/try_mutants --operators";
}

}  // namespace
}  // namespace weft::mutants
