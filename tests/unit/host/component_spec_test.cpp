// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "host/calling/hashing.hpp"
#include "misbehaving/misbehaving.hpp"

namespace weft::host {
namespace {

using misbehaving::Resolved;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kGood = "filters/test_good";

class ComponentSpecTest : public ::testing::Test {
 protected:
  Resolved good(const std::string& params) { return resolve(kGood, params); }
  Resolved resolve(const std::string& id, const std::string& params) {
    PathRules rules;
    rules.input_folders = {folder_.path()};
    rules.output_folder = "/runs/one";
    rules.variable = [this](const std::string& name) -> std::optional<std::string> {
      const auto found = variables_.find(name);
      return found != variables_.end() ? std::optional<std::string>(found->second) : std::nullopt;
    };
    return misbehaving::resolve(registry_, id, params, rules);
  }
  void expect_problem(const std::string& params, const std::string& message) {
    const Resolved resolved = good(params);
    EXPECT_FALSE(resolved.spec) << params;
    EXPECT_THAT(resolved.problems, ElementsAre(HasSubstr(message))) << params;
  }
  /// The value of a parameter as the effective configuration shows it.
  static std::string effective(const Resolved& resolved, const std::string& name) {
    if (!resolved.spec) return "not resolved: " + resolved.problem();
    const yaml::Node* value = resolved.spec->effective.find("params")->find(name);
    return value == nullptr ? "absent" : value->scalar;
  }

  misbehaving::TemporaryFolder folder_;
  std::map<std::string, std::string> variables_;
  const Registry registry_ = misbehaving::scan();
};

TEST_F(ComponentSpecTest, VariablesAreExpandedInTexts) {
  variables_["NAME"] = "value";
  EXPECT_EQ(effective(good("{title: 'a ${NAME}'}"), "title"), "a value");
  EXPECT_EQ(effective(good("{title: '${ABSENT:-other}'}"), "title"), "other");
  expect_problem("{title: '${ABSENT}'}", "the variable ABSENT is not set");
  expect_problem("{title: '${NAME'}", "${ without }");
}

TEST_F(ComponentSpecTest, WithoutParametersAllDefaultsAreEffective) {
  for (const std::string params : {"{}", "~", ""}) {
    const Resolved resolved = good(params);
    ASSERT_TRUE(resolved.spec) << resolved.problem();
    EXPECT_EQ(resolved.spec->component().id, kGood);
    EXPECT_EQ(resolved.spec->effective.find("use")->scalar, kGood);
    EXPECT_EQ(resolved.spec->effective.find("params")->entries.size(), 13U);
    EXPECT_EQ(effective(resolved, "length_mm"), "12.5");
    EXPECT_EQ(effective(resolved, "colour"), "green");
    ASSERT_EQ(resolved.spec->nested.size(), 1U);
    EXPECT_EQ(resolved.spec->nested[0].parameter, "warp");
    EXPECT_EQ(resolved.spec->nested[0].component.component().id, "warps/test_shift");
  }
}

TEST_F(ComponentSpecTest, ParametersReachTheComponent) {
  misbehaving::write_file(folder_ / "table.csv", "1");
  variables_["DATA"] = folder_.path().string();
  const Resolved resolved = good(
      "{length_mm: 7, free: -2.5e3, count: -4, flag: false, colour: blue, limits_px: [1, -2.5, 3],"
      " title: a title, table: '${DATA}/table.csv', report: out/r.csv, apart: {'009': x, b: y},"
      " warp: {use: warps/test_shift, params: {shift_px: 30}}, steps: [900000000000001, -9, 0],"
      " words: ['12', seven77]}");
  ASSERT_TRUE(resolved.spec) << resolved.problem();
  ExecutionContext context(1, {});
  const auto instance = context.instantiate(*resolved.spec, "filters");
  ASSERT_TRUE(instance) << instance.error().message;
  Template templ;
  templ.vertices_m = Array<double>({3, 3}, 0.0);
  templ.flat_px = Array<double>({3, 2}, 0.0);
  templ.faces = Array<std::int32_t>({1, 3}, 0);
  templ.texture = templ.mask = Array<std::uint8_t>({2, 2}, 0);
  const Correspondences matches = misbehaving::make_matches(3);
  const RecordView<Correspondences> view("correspondences", matches);
  const RecordView<Template> template_view("template", templ);
  const weft_record inputs[] = {view.raw(), template_view.raw()};
  const Outcome outcome = context.call(**instance, 0, inputs, 5);
  ASSERT_EQ(outcome.status, WEFT_OK) << outcome.error.message;
  const auto mask = view_as<InlierMask>(*outcome.find("inlier_mask"));
  ASSERT_TRUE(mask);
  const auto diag = [&](const char* name) { return mask->diag.value(name, -999.0); };
  EXPECT_EQ(diag("length_mm"), 7.0);
  EXPECT_EQ(diag("free"), -2500.0);
  EXPECT_EQ(diag("count"), -4.0);
  EXPECT_EQ(diag("flag"), 0.0);
  EXPECT_EQ(diag("colour"), 2.0);
  EXPECT_EQ(diag("limits"), 3.0);
  EXPECT_EQ(diag("title_length"), 7.0);
  EXPECT_EQ(diag("table_length"), static_cast<double>((folder_ / "table.csv").size()));
  EXPECT_EQ(diag("report_length"), static_cast<double>(std::string("/runs/one/out/r.csv").size()));
  EXPECT_EQ(diag("labels"), 2.0);
  const auto* steps = mask->diag.find<std::int64_t>("steps");
  ASSERT_NE(steps, nullptr);
  EXPECT_EQ(std::vector<std::int64_t>(steps->data(), steps->data() + steps->size()),
            (std::vector<std::int64_t>{900000000000001, -9, 0}));
  EXPECT_EQ(diag("length_of_12"), 2.0);
  EXPECT_EQ(diag("length_of_seven77"), 7.0);
  EXPECT_EQ(diag("length_of_one"), -999.0) << "a default that was replaced";
  EXPECT_EQ(diag("shifted_u"), 40.0);
  EXPECT_EQ(diag("first_draw"), Rng(component_seed(1, 5, "filters", "")).uniform());
}

TEST_F(ComponentSpecTest, AnUnknownParameterIsAnErrorWithASuggestion) {
  expect_problem("{lenght_mm: 3}",
                 "2:10: filters/test_good has no parameter 'lenght_mm'; did you mean 'length_mm'?");
  expect_problem("{zzzzzz: 3}", "see: weft plugins show filters/test_good");
}

TEST_F(ComponentSpecTest, AllMistakesAreReportedInOnePass) {
  const Resolved resolved = good("{lenght_mm: 3, count: many, flag: yes, warp: {use: warps/none}}");
  EXPECT_FALSE(resolved.spec);
  EXPECT_EQ(resolved.problems.size(), 4U);
}

TEST_F(ComponentSpecTest, WrongTypesNameWhatIsExpectedAndThePlace) {
  expect_problem("{length_mm: wide}",
                 "2:21: 'length_mm' must be a number in mm (without the unit), not 'wide'");
  expect_problem("{length_mm: 12mm}", "must be a number in mm (without the unit), not '12mm'");
  expect_problem("{length_mm: '12'}", "must be a number");
  expect_problem("{length_mm: [1]}", "'length_mm' must be a number");
  expect_problem("{length_mm: }", "'length_mm' must be a number");
  expect_problem("{count: 2.5}", "'count' must be a whole number, not '2.5'");
  expect_problem("{count: 99999999999999999999}", "'count' must be a whole number");
  expect_problem("{flag: yes}", "'flag' must be true or false, not 'yes'");
  expect_problem("{colour: pink}", "'colour' must be one of: red, green, blue, not 'pink'");
  expect_problem("{limits_px: 3}", "'limits_px' must be a list of numbers in px");
  expect_problem("{limits_px: [1, x]}", "2:25: 'limits_px' must be a list of numbers");
  expect_problem(
      "{steps: 3}",
      "2:17: 'steps' must be a list of whole numbers in frames (without the unit), not '3'");
  expect_problem("{steps: [1, 1.5]}",
                 "2:21: 'steps' must be a list of whole numbers in frames "
                 "(without the unit), not '1.5'");
  expect_problem("{steps: [1, -10]}", "2:21: 'steps' is -10, legal is -9 to 1e+15 frames");
  expect_problem("{words: one two}", "2:17: 'words' must be a list of texts, not 'one two'");
  expect_problem("{words: [one, [two]]}", "2:23: 'words' must be a list of texts");
  expect_problem("{title: [a]}", "'title' must be a text");
  expect_problem("{apart: [a]}", "'apart' must be a map of texts");
  expect_problem("{apart: {a: [b]}}", "'apart' must be a map of texts");
  expect_problem("[1, 2]", "2:9: params must be a map");
}

TEST_F(ComponentSpecTest, RangesAreCheckedWithTheUnitInTheMessage) {
  expect_problem("{length_mm: 100.5}", "2:21: 'length_mm' is 100.5, legal is 0 to 100 mm");
  expect_problem("{length_mm: -1}", "'length_mm' is -1, legal is 0 to 100 mm");
  expect_problem("{count: 1001}", "'count' is 1001, legal is -5 to 1000");
  expect_problem("{limits_px: [0, 11]}", "2:25: 'limits_px' is 11, legal is -10 to 10 px");
  expect_problem("{length_mm: .nan}", "must be a finite number");
  expect_problem("{free: .inf}", "must be a finite number");
  EXPECT_TRUE(good("{length_mm: 100, count: -5, limits_px: [], free: 1e300}").spec);
}

TEST_F(ComponentSpecTest, InputPathsAreRelativeToTheFilesFolderAndMustExist) {
  misbehaving::write_file(folder_ / "table.csv", "1");
  EXPECT_EQ(effective(good("{table: table.csv}"), "table"), folder_ / "table.csv");
  EXPECT_EQ(effective(good("{table: sub/../table.csv}"), "table"), folder_ / "table.csv");
  EXPECT_EQ(effective(good("{table: " + (folder_ / "table.csv") + "}"), "table"),
            folder_ / "table.csv");
  expect_problem("{table: absent.csv}",
                 "2:17: 'table': there is no file " + (folder_ / "absent.csv"));
  EXPECT_EQ(effective(good("{table: 'frames/*.png'}"), "table"), folder_ / "frames/*.png");
}

TEST_F(ComponentSpecTest, OutputPathsAreRelativeToTheRunFolder) {
  const Resolved given = good("{report: a/b.csv}");
  EXPECT_EQ(effective(given, "report"), "a/b.csv") << "another run has another folder";
  for (const weft_value& value : given.spec->arguments.values()) {
    if (std::string_view(value.name) != "report") continue;
    EXPECT_STREQ(*static_cast<const char* const*>(value.data), "/runs/one/a/b.csv");
  }
  EXPECT_EQ(effective(good("{report: /runs/one/b.csv}"), "report"), "b.csv");
  EXPECT_EQ(effective(good("{report: /runs/on/b.csv}"), "report"), "/runs/on/b.csv");
  EXPECT_EQ(effective(good("{report: /else/b.csv}"), "report"), "/else/b.csv");
  EXPECT_EQ(effective(good("{}"), "report"), "");
}

TEST_F(ComponentSpecTest, VariablesAreExpandedInPathsAndTexts) {
  variables_["NAME"] = "value";
  variables_["EMPTY"] = "";
  EXPECT_EQ(effective(good("{report: 'a${NAME}b${NAME}c'}"), "report"), "avaluebvaluec");
  EXPECT_EQ(effective(good("{report: '${ABSENT:-fallback}/x'}"), "report"), "fallback/x");
  EXPECT_EQ(effective(good("{report: '${EMPTY:-fallback}'}"), "report"), "fallback");
  EXPECT_EQ(effective(good("{report: '${NAME:-fallback}'}"), "report"), "value");
  EXPECT_EQ(effective(good("{report: 'x${ABSENT:-}'}"), "report"), "x");
  EXPECT_EQ(effective(good("{title: '${NAME}'}"), "title"), "value");
  EXPECT_EQ(effective(good("{title: '~/${NAME}'}"), "title"), "~/value") << "a text is no path";
  expect_problem("{report: '${ABSENT}/x'}",
                 "the variable ABSENT is not set; set it, or write ${ABSENT:-default}");
  expect_problem("{report: '${EMPTY}/x'}",
                 "the variable EMPTY is empty; set it, or write ${EMPTY:-default}");
  expect_problem("{report: '${NAME'}", "${ without }");
  expect_problem("{report: '${ABSENT:-${NAME}}'}", "${ inside");
}

TEST_F(ComponentSpecTest, TheHomeFolderIsExpandedAtTheBeginningOfPathsAsShellsDo) {
  variables_["HOME"] = "/home/me";
  variables_["OUT"] = "/out";
  for (const char* path : {"~/b.csv", "$HOME/b.csv", "${HOME}/b.csv", "~//b.csv"}) {
    EXPECT_EQ(effective(good("{report: '" + std::string(path) + "'}"), "report"), "/home/me/b.csv");
  }
  EXPECT_EQ(effective(good("{report: '$OUT/b.csv'}"), "report"), "/out/b.csv");
  EXPECT_EQ(effective(good("{report: 'a/~/$b.csv'}"), "report"), "a/~/$b.csv");
  EXPECT_EQ(effective(good("{report: 'a~b$OUT'}"), "report"), "a~b$OUT");
  EXPECT_EQ(effective(good("{report: './a/$OUT'}"), "report"), "a/$OUT");
  EXPECT_EQ(effective(good("{report: '$5.csv'}"), "report"), "$5.csv");
  for (const char* path : {"~else/b.csv", "~else", "~+/b.csv", "~root"}) {
    expect_problem("{report: '" + std::string(path) + "'}",
                   "begins with ~, but only ~/ (your home folder) is expanded");
  }
  expect_problem("{report: '$ABSENT/x'}", "the variable ABSENT is not set");
  variables_.erase("HOME");
  expect_problem("{report: '~/x'}", "the variable HOME is not set");
}

TEST_F(ComponentSpecTest, NestedComponentsAreCheckedToo) {
  expect_problem("{warp: {use: warps/test_shift, params: {shift_px: far}}}", "'shift_px' must be");
  expect_problem("{warp: {use: warps/test_shft}}", "did you mean 'warps/test_shift'?");
  expect_problem("{warp: {use: filters/test_strict}}",
                 "2:22: 'warp' must be one of warps/..., not 'filters/test_strict'");
  expect_problem("{warp: {}}", "'warp' lacks the key 'use'");
  expect_problem("{warp: {params: {shift_px: far}}}", "'shift_px' must be");
  expect_problem("{warp: warps/test_shift}",
                 "'warp' must be a component, such as {use: warps/test_shift}");
  expect_problem("{warp: {use: warps/test_shift, with: 3}}",
                 "a nested component has no key 'with'");
  expect_problem("{warp: {shift_px: 3}}",
                 "a nested component has no key 'shift_px'; it has use and params; did you mean "
                 "'warp.params.shift_px'?");
  expect_problem("{warp: {use: [warps/test_shift]}}", "'use' must be the id of a plugin");
}

TEST_F(ComponentSpecTest, ParametersAloneAreThoseOfTheDefaultComponent) {
  const Resolved resolved = good("{warp: {params: {shift_px: 5}}}");
  ASSERT_TRUE(resolved.spec) << resolved.problem();
  const yaml::Node* warp = resolved.spec->effective.find("params")->find("warp");
  ASSERT_NE(warp, nullptr);
  EXPECT_EQ(warp->find("use")->scalar, "warps/test_shift");
  EXPECT_EQ(warp->find("params")->find("shift_px")->scalar, "5");
}

TEST_F(ComponentSpecTest, NestedDefaultsAreEffectiveToo) {
  const Resolved resolved = good("{warp: {use: warps/test_shift, params: {shift_px: 5}}}");
  ASSERT_TRUE(resolved.spec);
  const yaml::Node* warp = resolved.spec->effective.find("params")->find("warp");
  ASSERT_NE(warp, nullptr);
  EXPECT_EQ(warp->find("use")->scalar, "warps/test_shift");
  EXPECT_EQ(warp->find("params")->find("shift_px")->scalar, "5");
  EXPECT_EQ(warp->find("params")->find("extra_samples")->scalar, "0");
}

TEST_F(ComponentSpecTest, RequiredParametersAreMissedWithTheirHelp) {
  const Resolved resolved = resolve("filters/test_strict", "{}");
  EXPECT_FALSE(resolved.spec);
  EXPECT_THAT(resolved.problems, ElementsAre(HasSubstr("requires the parameter 'ratio': a share"),
                                             HasSubstr("'rounds': how often"),
                                             HasSubstr("'model': a file that must be given")));
  const Resolved empty = resolve("filters/test_strict", "{ratio: 0.5, rounds: 2, model: ''}");
  EXPECT_THAT(empty.problems, ElementsAre(HasSubstr("'model' must be a path")));
  misbehaving::write_file(folder_ / "m", "");
  EXPECT_TRUE(resolve("filters/test_strict", "{ratio: 0.5, rounds: 2, model: m}").spec);
}

TEST_F(ComponentSpecTest, AMistakeInADefaultIsReportedAtTheUse) {
  misbehaving::TemporaryFolder plugins;
  plugins.adopt("filters_test_good");
  const std::string file = plugins / "filters_test_good.plugin.yaml";
  std::string manifest = misbehaving::read_file(file);
  manifest.replace(manifest.find("default: 12.5"), 13, "default: 1000");
  misbehaving::write_file(file, manifest);
  const Resolved resolved = misbehaving::resolve(misbehaving::scan(plugins.path()), kGood);
  EXPECT_THAT(resolved.problems, ElementsAre(HasSubstr("1:6: 'length_mm' is 1000")));
}

TEST_F(ComponentSpecTest, AnUnknownPluginIsAnErrorAtItsPlace) {
  EXPECT_THAT(resolve("filters/test_goood", "{}").problems,
              ElementsAre("1:6: no plugin 'filters/test_goood' is installed; did you mean "
                          "'filters/test_good'?"));
  EXPECT_THAT(resolve("[a]", "{}").problems, ElementsAre(HasSubstr("'use' must be the id")));
  EXPECT_THAT(resolve("filters/test_wrong_abi", "{}").problem(), HasSubstr("cannot be used"));
}

}  // namespace
}  // namespace weft::host
