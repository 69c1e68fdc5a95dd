// SPDX-License-Identifier: Apache-2.0
// Lines below errors, pipelines with the origins of their values, drawings of the wiring, and plans
// that the command line makes.
#include <gmock/gmock.h>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::chain;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using testing::head;
using ::testing::Not;
using testing::read_text;
using ::testing::StartsWith;

class Overview : public testing::PipelineTest {
 protected:
  Ended weft(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"/usr/bin/env",   "-C", folder_, WEFT_PROGRAM, "--plugin-path",
                                   WEFT_TEST_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Child(words, path("printed")).wait();
  }

  std::string printed(const std::vector<std::string>& arguments) const {
    const Ended ended = weft(arguments);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return ended.out;
  }
};

TEST_F(Overview, ShowsTheLineOfAnErrorWithACaretBelowItsColumn) {
  write(head() + "stages:\n  - {use: detectors/test.scripted, params: {cuont: 3}}\n", "p.yaml");
  EXPECT_EQ(weft({"check", "p.yaml"}).err,
            "p.yaml:5:45: detectors/test.scripted has no parameter 'cuont'; did you mean 'count'?\n"
            "    5 |   - {use: detectors/test.scripted, params: {cuont: 3}}\n"
            "      |                                             ^\n");
}

TEST_F(Overview, ShowsTheLineOfAWarningToo) {
  std::string text = head() + "stages:\n";
  for (const char* stage : {"detectors", "matchers", "filters", "warps", "passes"}) {
    text += std::string("  - {use: ") + stage + "/test.scripted}\n";
  }
  write(text + "  - {use: solvers/test.holder, params: {start: {use: solvers/test.scripted}}}\n",
        "p.yaml");
  for (const char* command : {"check", "run"}) {
    const std::string err = weft({command, "p.yaml"}).err;
    const std::size_t warning = err.find("p.yaml:10:41: 'start'");
    ASSERT_NE(warning, std::string::npos) << err;
    EXPECT_EQ(err.substr(err.find('\n', warning) + 1),
              "   10 |   - {use: solvers/test.holder, params: {start: {use: "
              "solvers/test.scripted}}}\n"
              "      |                                         ^\n");
  }
}

TEST_F(Overview, ShowsASettingWithACaretBelowItsColumn) {
  write(chain(), "p.yaml");
  EXPECT_EQ(
      weft({"run", "p.yaml", "--set", "filters.evry=3"}).err,
      "--set filters.evry=3, column 9: filters/test.scripted has no parameter 'evry'; did you "
      "mean 'every'?\n"
      "      | filters.evry=3\n"
      "      |         ^\n");
}

TEST_F(Overview, CountsCharactersAndCutsLongLinesAroundTheCaret) {
  const std::string umlauts(100, 'x');
  write(head() + "# \xC3\xA4\nstages: [{use: filters/test.scripted, as: \"" + umlauts +
            "\xC3\xA4\", params: {evry: 3}}]\n",
        "p.yaml");
  const std::string err = weft({"check", "p.yaml"}).err;
  const std::size_t line = err.find("    5 | ..."), caret = err.find("      | ", line);
  ASSERT_NE(caret, std::string::npos) << err;
  const std::string shown = err.substr(line, caret - line);
  const std::string below = err.substr(caret, err.find('\n', caret) - caret);
  // One character of the line has two bytes.
  EXPECT_EQ(below.find('^') + 1, shown.find("evry")) << err;
  EXPECT_THAT(shown, Not(HasSubstr("stages")));
}

TEST_F(Overview, ShowsNoLineWithASecretAndNoneOfAPipe) {
  write(head() + "sinks: [{use: sinks/test.scripted, params: {token: abc, evry: 3}}]\n", "p.yaml");
  EXPECT_THAT(weft({"check", "p.yaml"}).err, Not(HasSubstr("abc")));
  EXPECT_THAT(weft({"check", "/dev/null"}).err, Not(HasSubstr(" | ")));
}

TEST_F(Overview, ColoursOnlyTerminalsThatWantIt) {
  EXPECT_THAT(printed({"--help"}), Not(HasSubstr("\033")));
  const auto on_terminal = [&](const std::string& environment) {
    const std::string command =
        environment + " " + std::string(WEFT_PROGRAM) + " --help > /dev/tty; :";
    return Child({"/usr/bin/script", "-qec", command, path("typescript")}, path("printed"))
        .wait()
        .out;
  };
  if (!fs::exists("/usr/bin/script")) GTEST_SKIP() << "without a terminal of `script`";
  EXPECT_THAT(on_terminal("TERM=xterm NO_COLOR="), HasSubstr("\033[1mStart here:\033[0m"));
  EXPECT_THAT(on_terminal("TERM=xterm NO_COLOR=1"), Not(HasSubstr("\033")));
  EXPECT_THAT(on_terminal("TERM=dumb NO_COLOR="), Not(HasSubstr("\033")));
}

TEST_F(Overview, ShowsAMergedPipelineThatRunsAgainWithTheOriginOfEachValue) {
  write(chain({{"filters", "{every: 3}"}}, "seed: 7"), "base.yaml");
  write(
      "weft: 1\nextends: base.yaml\nstages:\n  - {use: detectors/test.scripted, params: {count: "
      "5}}\n",
      "p.yaml");
  const std::string shown = printed({"check", "p.yaml", "--show", "--set", "source.frames=2"});
  const auto origin = [&](const std::string& value) {
    const std::size_t begin = shown.find(value), comment = shown.find("# ", begin);
    if (begin == std::string::npos) return "no " + value;
    return shown.substr(comment + 2, shown.find('\n', comment) - comment - 2);
  };
  EXPECT_EQ(origin("seed: 7"), path("base.yaml:2"));
  EXPECT_EQ(origin("every: 3"), path("base.yaml:8"));
  EXPECT_EQ(origin("count: 5"), "p.yaml:4");
  EXPECT_EQ(origin("frames: 2"), "--set");
  EXPECT_EQ(origin("lost_after: "), "default");
  EXPECT_EQ(origin("distance_m: "), "default of solvers/test.scripted");
  write(shown, "shown.yaml");
  EXPECT_THAT(printed({"run", "shown.yaml", "--quiet", "--out", "a"}), StartsWith("2 frames, 0 "));
  EXPECT_THAT(printed({"run", "p.yaml", "--set", "source.frames=2", "--quiet", "--out", "b"}),
              StartsWith("2 frames, 0 "));
  EXPECT_EQ(read_text(path("a/frames/000001.npz")), read_text(path("b/frames/000001.npz")));
  write("weft: 1\npipeline: p.yaml\nname: n\n", "plan.yaml");
  EXPECT_THAT(weft({"check", "plan.yaml", "--show"}).err, HasSubstr("take one pipeline"));
}

TEST_F(Overview, ShowsParametersOfTheTemplateBesideThoseOfTheImage) {
  write(head() +
            "stages:\n  - {use: detectors/test.scripted, params: {count: 9}, template_params: "
            "{first_px: 2}}\n",
        "p.yaml");
  const std::string shown = printed({"check", "p.yaml", "--show"});
  const std::string on_template = shown.substr(shown.find("template_params"));
  EXPECT_THAT(on_template, HasSubstr("# p.yaml:5\n"));
  EXPECT_THAT(on_template.substr(on_template.find("refuse")),
              HasSubstr("# default of detectors/test.scripted\n"));
}

TEST_F(Overview, ListsWhatCanBeSet) {
  write(chain({{"filters", "{every: 3}"}}, "seed: 7"), "p.yaml");
  const std::string list = printed({"check", "p.yaml", "--list"});
  EXPECT_THAT(list, AllOf(HasSubstr("seed\t7\t"), HasSubstr("\nfilters.every\t3\t"),
                          HasSubstr("\nfilters.sleep_ms\t0\ttime that each call takes [ms]\n"),
                          HasSubstr("\nsource.use\tsources/test.scripted\t")));
  write(chain({{"solvers", "{nonsense: 1}"}}), "p.yaml");
  const Ended broken = weft({"check", "p.yaml", "--list"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.out, HasSubstr("\nfilters.every\t0\t"));
}

TEST_F(Overview, DrawsTheWiringAsText) {
  write(head() +
            "stages:\n  - use: detectors/test.scripted\n  - use: matchers/test.scripted\n"
            "  - use: filters/test.scripted\n",
        "p.yaml");
  const std::string text = printed({"graph", "p.yaml"});
  const std::string names = text.substr(0, text.find("detectors"));
  EXPECT_THAT(names, StartsWith("source     sources/test.scripted"));
  EXPECT_THAT(text, AllOf(HasSubstr("● image\n"), HasSubstr("● keypoints\n"),
                          HasSubstr("● correspondences\n")));
  const std::size_t filter = text.find("\nfilters");
  ASSERT_NE(filter, std::string::npos) << text;
  EXPECT_THAT(text.substr(filter, text.find('\n', filter + 1) - filter), HasSubstr("◀─"));
}

TEST_F(Overview, DrawsTheSameConnectionsInEveryFormat) {
  write(chain(), "p.yaml");
  const std::string mermaid = printed({"graph", "p.yaml", "--format", "mermaid"});
  EXPECT_THAT(mermaid,
              AllOf(StartsWith("flowchart LR\n  n0[\"source<br/>sources/test.scripted\"]\n"),
                    HasSubstr("  n3 -->|\"keypoints, template_keypoints\"| n4\n")));
  const std::string dot = printed({"graph", "p.yaml", "--format", "dot"});
  EXPECT_THAT(dot, AllOf(StartsWith("digraph pipeline {\n"),
                         HasSubstr("  n3 -> n4 [label=\"keypoints, template_keypoints\"];\n")));
  const std::string svg = printed({"graph", "p.yaml", "--format", "svg"});
  EXPECT_THAT(svg, AllOf(StartsWith("<svg xmlns="), HasSubstr(">solvers/test.scripted</text>"),
                         HasSubstr(">correspondences</text>")));
  // Each box is wider than the texts in it, which begin behind its left edge.
  EXPECT_THAT(
      svg, ::testing::ContainsRegex("class=\"box\" x=\"12\" y=\"[0-9]+\" width=\"[23][0-9][0-9]"));
}

TEST_F(Overview, DrawsTheTimesOfARun) {
  write(chain({{"filters", "{sleep_ms: 20}"}}), "p.yaml");
  ASSERT_EQ(weft({"run", "p.yaml", "--quiet", "--out", "run"}).exit_code, 0);
  const std::string text = printed({"graph", "p.yaml", "--run", "run"});
  const std::size_t filter = text.find("\nfilters");
  const std::string line = text.substr(filter + 1, text.find('\n', filter + 1) - filter);
  EXPECT_THAT(line, ::testing::ContainsRegex(" [2-9][0-9]\\.[0-9] ms "));
  const Ended other = weft({"graph", "p.yaml", "--run", "."});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("frames.jsonl: there is no such file"));
}

TEST_F(Overview, VariesSettingsOfAPipelineByAPlanThatItWrites) {
  write(chain({{"sources", "{frames: 2}"}}), "p.yaml");
  const Ended ended = weft({"ablate", "p.yaml", "--vary", "filters.every=0,2..3", "--vary",
                            "solvers.distance_m=0.4,0.5", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const std::string folder = "ablations/p-filters.every-solvers.distance_m";
  EXPECT_THAT(ended.err, HasSubstr("plan: " + folder + ".yaml\n"));
  EXPECT_THAT(ended.out, HasSubstr("6 cells (6 distinct): 6 done"));
  const Ended again = weft({"ablate", folder + ".yaml", "--quiet"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("6 cells (6 distinct): 6 done, 0 failed, 0 left; "));
}

TEST_F(Overview, WritesNoPlanForADryRunAndForErrorsWhichNameTheArgument) {
  write(chain(), "p.yaml");
  const Ended dry = weft({"ablate", "p.yaml", "--vary", "seed=1..3", "--dry-run"});
  EXPECT_THAT(dry.out, HasSubstr("3 cells"));
  const auto refusal = [&](const std::string& varied) {
    const Ended ended = weft({"ablate", "p.yaml", "--vary", varied});
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    return ended.err;
  };
  EXPECT_EQ(
      refusal("filters.evry=1,2"),
      "error: --vary filters.evry=1,2: filters/test.scripted has no parameter 'evry'; did you "
      "mean 'every'?\n");
  EXPECT_THAT(refusal("filters.every"), StartsWith("error: --vary filters.every: expected PATH="));
  EXPECT_THAT(refusal("seed=8..1"), StartsWith("error: --vary seed=8..1: '8..1' must be a range"));
  EXPECT_THAT(refusal("seed=[1"), StartsWith("error: --vary seed=[1: its values are no list"));
  EXPECT_THAT(refusal("seed="), StartsWith("error: --vary seed=: it has no value"));
  EXPECT_FALSE(fs::exists(path("ablations")));
  write("weft: 1\npipeline: p.yaml\nname: n\n", "plan.yaml");
  EXPECT_THAT(weft({"ablate", "plan.yaml", "--vary", "seed=1,2"}).err, HasSubstr("is a plan; "));
}

}  // namespace
}  // namespace weft
