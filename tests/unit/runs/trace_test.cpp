// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/trace.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <weft/core/index.hpp>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using nlohmann::json;
using std::chrono::microseconds;
using testing::chain;
using testing::head;
using testing::Ran;
using testing::read_text;
using Time = std::chrono::steady_clock::time_point;

/// A slice of the trace, in whole nanoseconds.
struct Slice {
  std::string name;
  std::int64_t begin_ns, end_ns;
  int track;
  json args;

  bool holds(const Slice& other) const {
    return track == other.track && begin_ns <= other.begin_ns && other.end_ns <= end_ns;
  }
};

std::vector<Slice> slices_of(const json& trace) {
  std::vector<Slice> slices;
  for (const json& event : trace) {
    if (event["ph"] != "X") continue;
    const std::int64_t begin_ns = std::llround(event["ts"].get<double>() * 1000.0);
    const std::int64_t length_ns = std::llround(event["dur"].get<double>() * 1000.0);
    slices.push_back({event["name"], begin_ns, begin_ns + length_ns, event["pid"], event["args"]});
  }
  return slices;
}

std::vector<Slice> named(const std::vector<Slice>& slices, const std::string& name) {
  std::vector<Slice> found;
  for (const Slice& slice : slices) {
    if (slice.name == name) found.push_back(slice);
  }
  return found;
}

class TraceTest : public testing::PipelineTest {
 protected:
  static std::vector<Slice> trace_of(const Ran& ran) {
    const json trace = json::parse(read_text(ran.folder + "/trace.json"), nullptr, false);
    EXPECT_TRUE(trace.is_array());
    return trace.is_array() ? slices_of(trace) : std::vector<Slice>{};
  }
};

TEST_F(TraceTest, HoldsEveryStageOfEveryFrame) {
  const std::vector<Slice> slices = trace_of(run(chain({{"warps", "{error_at: [1]}"}})));
  for (const char* stage :
       {"sources", "detectors", "matchers", "filters", "warps", "passes", "solvers", "sinks"}) {
    for (int frame = 0; frame < 3; ++frame) {
      std::multiset<std::string> statuses;
      for (const Slice& slice : named(slices, stage)) {
        if (slice.args.value("frame", -1) == frame) statuses.insert(slice.args["status"]);
      }
      const std::string name = stage;
      const bool skipped = frame == 1 && (name == "passes" || name == "solvers");
      if (frame == 1 && name == "warps") {
        EXPECT_THAT(statuses, ::testing::ElementsAre("error"));
      } else if (name == "warps") {
        EXPECT_THAT(statuses, ::testing::ElementsAre("ok", "ok"));  // fit and evaluate
      } else if (skipped) {
        EXPECT_TRUE(statuses.empty()) << stage;
      } else {
        EXPECT_THAT(statuses, ::testing::ElementsAre("ok")) << stage << " in frame " << frame;
      }
    }
  }
  EXPECT_EQ(named(slices, "frame").size(), 3U);
}

TEST_F(TraceTest, HoldsCallsOutsideOfFrames) {
  const std::vector<Slice> slices = trace_of(run(chain()));
  std::multiset<std::string> calls;
  for (const Slice& slice : slices) {
    if (!slice.args.contains("frame")) {
      calls.insert(slice.name + " " + slice.args["method"].get<std::string>());
    }
  }
  EXPECT_THAT(calls, ::testing::ElementsAre("detectors detect", "sinks finish", "sinks open",
                                            "sources count", "sources open", "templates build"));
}

TEST_F(TraceTest, PutsCallsInsideThoseThatMadeThem) {
  const Ran ran = run(head("{frames: 2}") +
                      "frames_at_once: 1\n"
                      "stages:\n"
                      "  - {use: matchers/test.pattern}\n"
                      "  - {use: filters/test.warped}\n"
                      "  - {use: warps/test.scripted}\n"
                      "  - {use: passes/test.scripted}\n"
                      "  - {use: solvers/test.holder}\n");
  const std::vector<Slice> slices = trace_of(ran);
  for (const auto& [child, parent] :
       std::map<std::string, std::string>{{"filters/warp", "filters"},
                                          {"solvers/initial_guess", "solvers"},
                                          {"filters", "frame"}}) {
    const std::vector<Slice> children = named(slices, child), parents = named(slices, parent);
    ASSERT_EQ(children.size(), 2U) << child;
    ASSERT_EQ(parents.size(), 2U) << parent;
    for (int i : {0, 1}) EXPECT_TRUE(parents[i].holds(children[i])) << child;
    EXPECT_FALSE(parents[0].holds(children[1])) << child;
  }
  // On one track slices are disjoint or inside one another, and the outer one comes first.
  for (std::size_t i = 0; i < slices.size(); ++i) {
    for (std::size_t j = i + 1; j < slices.size(); ++j) {
      EXPECT_TRUE(slices[i].holds(slices[j]) || slices[i].end_ns <= slices[j].begin_ns)
          << slices[i].name << " and " << slices[j].name;
    }
  }
}

/// A trace written by hand.
class TraceFile : public testing::PipelineTest {
 protected:
  Trace open() const {
    auto trace = Trace::create(path("trace.json"));
    EXPECT_TRUE(trace);
    return *std::move(trace);
  }
  static host::Timing call(const std::string& component, int start_us, double ms,
                           const std::string& worker = {}) {
    return {component, {ms, 0.0}, Time(microseconds(start_us)), "run", 0, WEFT_OK, worker};
  }
};

TEST_F(TraceFile, CanBeReadBeforeItsEnd) {
  Trace trace = open();
  EXPECT_EQ(json::parse(read_text(path("trace.json")) + "]"), json::array());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(trace.add({call("a", 10 * i, 0.001), call("b", 10 * i + 5, 0.001)}));
    const json so_far = json::parse(read_text(path("trace.json")) + "]");
    EXPECT_EQ(slices_of(so_far).size(), 2U * to_index(i + 1));
  }
  ASSERT_TRUE(trace.close());
  EXPECT_EQ(slices_of(json::parse(read_text(path("trace.json")))).size(), 6U);
}

TEST_F(TraceFile, StartsAtTheFirstCallAndKeepsNanoseconds) {
  Trace trace = open();
  ASSERT_TRUE(trace.add({call("inner", 1002, 0.000007), call("outer", 1000, 0.01)}));
  ASSERT_TRUE(trace.close());
  const std::vector<Slice> slices = slices_of(json::parse(read_text(path("trace.json"))));
  ASSERT_EQ(slices.size(), 2U);
  EXPECT_EQ(slices[0].name, "outer");
  EXPECT_EQ(slices[0].begin_ns, 0);
  EXPECT_EQ(slices[0].end_ns, 10'000);
  EXPECT_EQ(slices[1].begin_ns, 2'000);
  EXPECT_EQ(slices[1].end_ns, 2'007);
}

TEST_F(TraceFile, GivesEachWorkerATrackOfItsOwn) {
  Trace trace = open();
  FrameResult frame;
  frame.index = 4;
  frame.timings = {call("filters/warp", 2, 0.004, "filters"), call("filters", 1, 0.008),
                   call("warps", 20, 0.001, "solvers"), call("solvers", 15, 0.009)};
  ASSERT_TRUE(trace.add(frame));
  ASSERT_TRUE(trace.close());
  const json events = json::parse(read_text(path("trace.json")));
  std::map<int, std::string> processes;
  for (const json& event : events) {
    if (event["name"] == "process_name") processes[event["pid"]] = event["args"]["name"];
  }
  std::map<std::string, std::string> process_of;
  for (const Slice& slice : slices_of(events)) process_of[slice.name] = processes[slice.track];
  EXPECT_EQ(process_of, (std::map<std::string, std::string>{{"frame", "weft"},
                                                            {"filters", "weft"},
                                                            {"filters/warp", "worker of filters"},
                                                            {"solvers", "weft"},
                                                            {"warps", "worker of solvers"}}));
}

TEST_F(TraceFile, SaysThatItCannotBeWritten) {
  const auto missing = Trace::create(path("no/trace.json"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, Errc::io);
  auto full = Trace::create("/dev/full");
  EXPECT_FALSE(full);
}

}  // namespace
}  // namespace weft
