// SPDX-License-Identifier: Apache-2.0
// A component that misbehaves in the middle of a run costs one frame. The file frames.jsonl names
// the component and its error.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// An action of a component in frame 1 of 3, and the expected report.
struct Misbehaviour {
  std::string name, id, params, reason;
};

void PrintTo(const Misbehaviour& misbehaviour, std::ostream* out) { *out << misbehaviour.name; }

class MisbehaviourInARun : public testing::PipelineTest,
                           public ::testing::WithParamInterface<Misbehaviour> {
 protected:
  MisbehaviourInARun() {
    registry_ =
        host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}, {WEFT_MISBEHAVING_FOLDER, "test"}});
  }

  static std::string pipeline(const Misbehaviour& misbehaviour) {
    const std::string role = misbehaviour.id.substr(0, misbehaviour.id.find('/'));
    std::string text = testing::chain();
    const std::string good = "use: " + role + "/test.scripted, params: {}";
    return text.replace(text.find(good), good.size(),
                        "use: " + misbehaviour.id + ", params: " + misbehaviour.params);
  }
};

TEST_P(MisbehaviourInARun, CostsItsFrameAndIsRecordedByName) {
  const Misbehaviour& misbehaviour = GetParam();
  const std::string role = misbehaviour.id.substr(0, misbehaviour.id.find('/'));
  const testing::Ran ran = run(pipeline(misbehaviour));
  ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  EXPECT_EQ(ran.summary->failed, 1);
  const auto lines = testing::read_lines(ran.folder + "/frames.jsonl");
  ASSERT_EQ(lines.size(), 3U);
  for (const std::size_t good : {0, 2}) {
    const json frame = json::parse(lines[good]);
    EXPECT_EQ(frame["state"], "estimated") << lines[good];
    for (const json& stage : frame["stages"]) EXPECT_EQ(stage["status"], "ok") << stage;
  }
  const json frame = json::parse(lines[1]);
  EXPECT_EQ(frame["failed"], true);
  EXPECT_EQ(frame["state"], "predicted");
  std::string expected = "ok";
  for (const json& stage : frame["stages"]) {
    if (stage["stage"] == role) {
      EXPECT_EQ(stage["status"], "error");
      EXPECT_THAT(std::string(stage["reason"]),
                  AllOf(StartsWith(misbehaviour.id + ": "), HasSubstr(misbehaviour.reason)));
      expected = "skipped";
    } else if (stage["stage"] != "sinks") {
      EXPECT_EQ(stage["status"], expected) << stage;
    }
  }
}

const Misbehaviour kMisbehaviours[] = {
    {"ThrowsAnException", "filters/test_throws", "{in: process, frame: 1}",
     "threw: the sky fell down"},
    {"ThrowsANumber", "filters/test_throws", "{in: process, what: number, frame: 1}",
     "no std::exception"},
    {"UsesWhatItDidNotAskFor", "filters/test_undeclared", "{wanted: template, frame: 1}",
     "add \"template\" to kAbout.needs"},
    {"RunsOutOfMemory", "filters/test_throws", "{in: process, what: memory, frame: 1}",
     "out of memory"},
    {"WrongLength", "filters/test_wrong_output", "{mistake: shorter, frame: 1}",
     "23 entries for 24 of the input 'correspondences'"},
    {"WrongAxes", "filters/test_wrong_output", "{mistake: two_columns, frame: 1}",
     "'score' of inlier_mask/1: it has 2 axes where [N] is expected"},
    {"NotANumber", "filters/test_wrong_output", "{mistake: nan, frame: 1}",
     "'score' holds NaN or infinity"},
    {"NoFlag", "filters/test_wrong_output", "{mistake: no_flag, frame: 1}",
     "'kept' holds 255 at [23] where 0 or 1 is expected"},
    {"NotAllArrays", "filters/test_wrong_output", "{mistake: absent, frame: 1}",
     "'kept' is missing"},
    {"WrongType", "filters/test_raw", "{mistake: wrong_dtype, frame: 1}", "'kept'"},
    {"GiantRequest", "filters/test_raw", "{mistake: greedy, frame: 1}", "'kept'"},
    {"NoOutput", "filters/test_raw", "{mistake: no_output, frame: 1}",
     "did not produce its output 'inlier_mask'"},
    {"UnknownStatus", "filters/test_raw", "{mistake: unknown_status, frame: 1}", "status 77"},
    {"ErrorWithoutReason", "filters/test_raw", "{mistake: no_reason, frame: 1}", "gave no reason"},
    {"IndexOutOfRange", "passes/test.scripted", "{bad_vertex_at: [1]}",
     "has the index 30, the template has 30"},
    {"StateOutOfRange", "solvers/test.scripted", "{bad_state_at: [1]}",
     "a solver may set only estimated or weak"}};

INSTANTIATE_TEST_SUITE_P(, MisbehaviourInARun, ::testing::ValuesIn(kMisbehaviours),
                         [](const auto& test) { return test.param.name; });

class OutputsOfStages : public testing::PipelineTest {};

TEST_F(OutputsOfStages, AndOfWhatIsNestedInThemFollowTheRuleOfSinks) {
  registry_ =
      host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}, {WEFT_MISBEHAVING_FOLDER, "test"}});
  const std::string notes = write("precious", "notes.txt");
  const auto refusal = [&](const std::string& params, const std::string& more = "") {
    return check(testing::head() +
                 "stages:\n  - {use: matchers/test.pattern}\n  - use: filters/test_good\n" +
                 "    params: {" + params + "}\n" + more)
        .second.text();
  };
  const std::string is_there = notes + " is a file; choose a path where nothing is";
  EXPECT_THAT(refusal("report: '" + notes + "'"), HasSubstr(":7:22: 'report': " + is_there));
  EXPECT_THAT(refusal("warp: {use: warps/test_shift, params: {notes: '" + notes + "'}}"),
              HasSubstr(":7:60: 'warp.notes': " + is_there));
  EXPECT_EQ(refusal("report: '" + notes + "'", "    overwrite: true\n"), "");
  EXPECT_EQ(refusal("report: notes.txt"), "");
}

}  // namespace
}  // namespace weft
