// SPDX-License-Identifier: Apache-2.0
#include "mutants/drawing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "mutants/operators.hpp"
#include "mutants/trial.hpp"
#include "testing/contract_subject.hpp"

namespace weft::mutants {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// One component of each role, with a number that has a range; those of filters have an extension.
std::vector<Original> one_of_each_role() {
  std::vector<Original> all;
  for (const char* role : {"sources", "templates", "detectors", "matchers", "filters", "warps",
                           "passes", "solvers", "sinks"}) {
    for (const char* name : {"a", "b"}) {
      Original original;
      original.component.id = std::string(role) + "/" + name;
      original.component.random = std::string_view(name) == "b";
      host::ParameterSpec& count = original.component.parameters.emplace_back();
      count.name = "count";
      count.type = WEFT_VALUE_I64;
      count.bounded = true;
      if (original.component.role() == "filters") {
        original.component.extensions = {WEFT_SWEEP};
      }
      all.push_back(std::move(original));
    }
  }
  return all;
}

std::vector<std::string> names_of(const Drawn& drawn) {
  std::vector<std::string> names;
  for (const Mutant& mutant : drawn.mutants) names.push_back(mutant.name());
  return names;
}

TEST(Operators, AreAtLeastThirtyWithDifferentNamesAndOfTheSevenGroups) {
  const std::set<std::string_view> groups = {"load",  "table",  "parameters", "contract",
                                             "calls", "limits", "geometry"};
  std::set<std::string_view> names, seen;
  for (const Operator& each : operators()) {
    names.insert(each.name);
    seen.insert(each.group);
    EXPECT_FALSE(each.deed.empty()) << each.name;
    EXPECT_EQ(find_operator(each.name), &each);
  }
  EXPECT_GE(names.size(), 30U);
  EXPECT_THAT(operators(), SizeIs(names.size()));
  EXPECT_EQ(seen, groups);
  EXPECT_EQ(find_operator("no_such_operator"), nullptr);
}

TEST(Draw, TakesEachOperatorAtLeastOnceAndAsManyMutantsAsAreAskedFor) {
  const auto originals = one_of_each_role();
  for (const std::size_t count : {std::size_t{0}, operators().size() + 40}) {
    const Drawn drawn = draw(originals, 5, count);
    std::set<const Operator*> drawn_operators;
    for (const Mutant& mutant : drawn.mutants) {
      drawn_operators.insert(mutant.change);
      EXPECT_TRUE(applies(*mutant.change, mutant.original->component)) << mutant.name();
    }
    EXPECT_THAT(drawn.unused, IsEmpty());
    EXPECT_THAT(drawn_operators, SizeIs(operators().size()));
    EXPECT_THAT(drawn.mutants, SizeIs(std::max(count, operators().size())));
    const auto names = names_of(drawn);
    EXPECT_THAT(std::set<std::string>(names.begin(), names.end()), SizeIs(names.size()));
  }
}

TEST(Draw, GivesTheSameForTheSameSeedAndOthersForAnother) {
  const auto originals = one_of_each_role();
  EXPECT_EQ(names_of(draw(originals, 7, 120)), names_of(draw(originals, 7, 120)));
  EXPECT_NE(names_of(draw(originals, 7, 120)), names_of(draw(originals, 8, 120)));
}

TEST(Draw, NamesTheOperatorsThatApplyToNothing) {
  auto originals = one_of_each_role();
  std::erase_if(originals, [](const Original& each) { return each.component.id != "sinks/a"; });
  const Drawn drawn = draw(originals, 1, 1000);
  EXPECT_EQ(drawn.mutants.size() + drawn.unused.size(), operators().size());
  EXPECT_THAT(drawn.unused, ::testing::Contains(find_operator("negative_depth")));
}

TEST(Operator, AppliesToItsRolesAndToWhatHasWhatItChanges) {
  host::ComponentManifest solver;
  solver.id = "solvers/s";
  EXPECT_TRUE(applies(*find_operator("millimetres"), solver));
  EXPECT_FALSE(applies(*find_operator("keeps_rejected"), solver));
  EXPECT_FALSE(applies(*find_operator("accepts_out_of_range"), solver));
  EXPECT_TRUE(applies(*find_operator("undeclared_seed"), solver));
  solver.random = true;
  EXPECT_FALSE(applies(*find_operator("undeclared_seed"), solver));
}

TEST(Originals, AreThoseThatCanBeCheckedAsTheyAreInstalled) {
  const auto all = originals_in(WEFT_PLUGIN_FOLDER);
  ASSERT_TRUE(all);
  EXPECT_GE(all->size(), 10U);
  for (const Original& each : *all) {
    EXPECT_NE(each.component.id, "detectors/sift_gpu") << "which needs a device";
  }
  const auto two = originals_in(WEFT_PLUGIN_FOLDER, {"warps/tps", "filters/lpm"});
  ASSERT_TRUE(two);
  ASSERT_THAT(*two, SizeIs(2));
  EXPECT_EQ(two->front().component.id, "filters/lpm");
  const auto none = originals_in(WEFT_PLUGIN_FOLDER, {"detectors/sift_gpu"});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, ::testing::HasSubstr("'detectors/sift_gpu'"));
}

TEST(Originals, MayRequireParametersThatStandBesideThem) {
  namespace fs = std::filesystem;
  const weft::testing::ScratchFolder folder;
  const auto copy = [&](const std::string& file) {
    fs::copy_file(fs::path(WEFT_PLUGIN_FOLDER) / file, folder.path() / file);
  };
  copy("templates_rectangular.plugin.yaml");
  copy("templates_rectangular.so");
  const std::vector<std::string> id = {"templates/rectangular"};
  const fs::path values = folder.path() / "templates_rectangular.check";
  EXPECT_FALSE(originals_in(folder.path().string(), id));
  std::ofstream(values) << "\n";
  EXPECT_FALSE(originals_in(folder.path().string(), id)) << "which gives no parameter";
  std::ofstream(values) << "{texture: a.png, width_m: 0.2}\n";
  const auto originals = originals_in(folder.path().string(), id);
  ASSERT_TRUE(originals);
  const weft::testing::ScratchFolder other;
  const auto made = make_mutant({find_operator("wrong_magic"), &originals->front()}, WEFT_MUTANT,
                                other.path().string());
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(fs::exists(fs::path(*made).parent_path() / values.filename()));
}

}  // namespace
}  // namespace weft::mutants
