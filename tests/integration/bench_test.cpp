// SPDX-License-Identifier: Apache-2.0
// `weft bench` as users start it: its output is consistent, whatever the times are.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::chain;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using testing::read_text;

constexpr int kFrames = 4, kWarmup = 1, kRepetitions = 3, kBlock = 2;

class Bench : public testing::PipelineTest {
 protected:
  Ended weft(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"/usr/bin/env",      "-C",         folder_,
                                   "WEFT_PLUGIN_PATH=", WEFT_PROGRAM, "--plugin-path",
                                   WEFT_TEST_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Child(words, path("printed")).wait();
  }

  /// With the numbers above and these words.
  Ended bench(std::vector<std::string> words) const {
    const auto add = [&](const char* option, int value) {
      words.insert(words.end(), {option, std::to_string(value)});
    };
    words.insert(words.begin(), "bench");
    add("--frames", kFrames);
    add("--warmup", kWarmup);
    add("--repetitions", kRepetitions);
    add("--block", kBlock);
    return weft(words);
  }

  /// Measurements of two pipelines; in one frame of the first, the filter has no matches.
  json measured() const {
    write(chain({{"sources", "{frames: 9}"}, {"matchers", "{no_result_at: [2]}"}}), "a.yaml");
    write(chain({{"sources", "{frames: 7}"}}), "b.yaml");
    const Ended ended = bench({"a.yaml", "--against", "b.yaml", "--json", "bench.json"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("a / b"));
    return json::parse(read_text(path("bench.json")));
  }

  static const json& part(const json& pipeline, const std::string& name) {
    static const json kNone;
    for (const json& each : pipeline["parts"]) {
      if (each["part"] == name) return each;
    }
    return kNone;
  }
};

TEST_F(Bench, TellsEachPartOfEachPipeline) {
  const json all = measured();
  EXPECT_EQ(all["schema"], "weft-bench/1");
  EXPECT_EQ(all["baseline"], "b");
  ASSERT_EQ(all["pipelines"].size(), 2U);
  for (const json& pipeline : all["pipelines"]) {
    std::vector<std::string> names;
    for (const json& each : pipeline["parts"]) names.push_back(each["part"]);
    EXPECT_THAT(names, ::testing::ElementsAre("sources", "detectors", "matchers", "filters",
                                              "warps", "passes", "solvers", "host", "frame"));
    EXPECT_EQ(part(pipeline, "sources")["wall_ms"]["n"], kFrames);
    EXPECT_EQ(part(pipeline, "frame")["wall_ms"]["n"], kFrames * kRepetitions);
    EXPECT_EQ(pipeline["frames"].size(), kFrames * kRepetitions);
    for (const char* time : {"wall_ms", "processor_ms"}) {
      const json& spread = part(pipeline, "frame")[time];
      EXPECT_LE(spread["median"], spread["p95"]);
      EXPECT_LE(spread["p95"], spread["p99"]);
    }
  }
}

TEST_F(Bench, CountsFramesWithASkippedStageSeparately) {
  const json all = measured();
  const json &a = all["pipelines"][0], &b = all["pipelines"][1];
  EXPECT_EQ(part(a, "matchers")["statuses"]["no_result"], kRepetitions);
  EXPECT_EQ(part(a, "filters")["statuses"]["skipped"], kRepetitions);
  EXPECT_EQ(part(a, "filters")["wall_ms"]["n"], (kFrames - 1) * kRepetitions);
  EXPECT_EQ(part(b, "filters")["wall_ms"]["n"], kFrames * kRepetitions);
  EXPECT_EQ(a["states"]["predicted"], kRepetitions);
  EXPECT_EQ(b["states"]["estimated"], (kFrames + kWarmup) * kRepetitions);
  for (const json& ratio : all["ratios"]) {
    const bool skipped = ratio["part"] != "frame" && ratio["part"] != "host" &&
                         ratio["part"] != "detectors" && ratio["part"] != "matchers";
    EXPECT_EQ(ratio["wall"]["pairs"], (kFrames - (skipped ? 1 : 0)) * kRepetitions) << ratio;
    EXPECT_LE(ratio["wall"]["low"], ratio["wall"]["high"]);
  }
}

#ifndef WEFT_SANITIZED
TEST_F(Bench, CountsWhatAFrameAllocatesAndTheMemoryOfAPipeline) {
  for (const json& pipeline : measured()["pipelines"]) {
    EXPECT_TRUE(pipeline["why_no_counts"].is_null()) << pipeline["why_no_counts"];
    EXPECT_GE(pipeline["memory"]["peak_kib"], pipeline["memory"]["loaded_kib"]);
    double most = 0.0;
    for (const json& each : pipeline["parts"]) {
      if (each["part"] == "sources" || each["part"] == "frame") continue;
      if (each["part"] == "host") continue;  // the host may allocate nothing
      EXPECT_GT(each["allocated_blocks"]["median"], 0.0) << each["part"];
      EXPECT_GT(each["allocated_bytes"]["median"], 0.0) << each["part"];
      most = std::max(most, each["allocated_bytes"]["median"].get<double>());
    }
    EXPECT_EQ(part(pipeline, "frame")["allocated_blocks"]["n"], kFrames);
    EXPECT_GT(part(pipeline, "frame")["allocated_bytes"]["median"], most);
  }
}
#endif

TEST_F(Bench, TellsAFloorThatFollowsFromBytesAndBandwidth) {
  const json all = measured();
  const double bytes_per_s = all["machine"]["copy_memory_bytes_per_s"];
  EXPECT_GT(bytes_per_s, 0.0);
  EXPECT_GT(all["machine"]["multiply_adds_per_s"], 0.0);
  const json& matchers = part(all["pipelines"][1], "matchers");
  const double bytes = matchers["read_bytes"].get<double>() + matchers["made_bytes"].get<double>();
  EXPECT_GT(bytes, 0.0);
  EXPECT_NEAR(matchers["floor_ms"].get<double>() / (1e3 * bytes / bytes_per_s), 1.0, 1e-9);
}

TEST_F(Bench, LeavesNothingBehind) {
  measured();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_))
    names.push_back(entry.path().filename());
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("a.yaml", "b.yaml", "bench.json",
                                                     "printed.out", "printed.err"));
}

TEST_F(Bench, RunsSinksWhenAsked) {
  write(chain({{"sources", "{frames: 9}"}}), "a.yaml");
  const Ended ended = bench({"a.yaml", "--with-sinks", "--json", "bench.json"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const json all = json::parse(read_text(path("bench.json")));
  EXPECT_TRUE(all["baseline"].is_null());
  EXPECT_EQ(part(all["pipelines"][0], "sinks")["wall_ms"]["n"], kFrames * kRepetitions);
}

TEST_F(Bench, MeasuresFramesThatOverlapWhenAsked) {
  write(chain({{"sources", "{frames: 9}"}}, "frames_at_once: 3\nthreads: 2"), "a.yaml");
  const Ended ended = bench({"a.yaml", "--against", "a.yaml", "--set", "frames_at_once=1",
                             "--overlap", "--json", "overlap.json"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("overlapped, 3 frames at once on 2 threads: "));
  EXPECT_THAT(ended.out, HasSubstr("a / a#2"));
  const json all = json::parse(read_text(path("overlap.json")));
  EXPECT_THAT(all["command"].get<std::string>(), HasSubstr(" --overlap"));
  const std::vector<std::pair<int, int>> expected = {{1, 1}, {3, 2}};
  for (std::size_t i = 0; i < 2; ++i) {
    const json& overlap = all["pipelines"][i]["overlap"];
    EXPECT_EQ(overlap["frames_at_once"], expected[i].first);
    EXPECT_EQ(overlap["threads"], expected[i].second);
    EXPECT_EQ(overlap["frames_per_s"]["n"], kRepetitions);
    EXPECT_EQ(overlap["frames_per_s_each"].size(), kRepetitions);
    EXPECT_GT(overlap["frames_per_s"]["median"], 0.0);
    EXPECT_EQ(overlap["latency_ms"]["n"], kFrames * kRepetitions);
    EXPECT_LE(overlap["latency_ms"]["median"], overlap["latency_ms"]["p99"]);
  }
  bool compared = false;
  for (const json& ratio : all["ratios"]) {
    if (ratio["part"] != "overlapped") continue;
    EXPECT_EQ(ratio["wall"]["pairs"], kRepetitions);
    compared = true;
  }
  EXPECT_TRUE(compared);
  EXPECT_TRUE(measured()["pipelines"][0]["overlap"].is_null()) << "not asked for";
}

TEST_F(Bench, LaysSettingsOverTheFirstPipelineOrOverAll) {
  write(chain(), "a.yaml");
  const Ended ended = bench({"a.yaml", "--against", "a.yaml", "--set-all", "source.frames=9",
                             "--set", "filters.every=2", "--json", "bench.json"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const json all = json::parse(read_text(path("bench.json")));
  EXPECT_EQ(all["pipelines"][0]["settings"], json::array({"source.frames=9", "filters.every=2"}));
  EXPECT_EQ(all["pipelines"][1]["settings"], json::array({"source.frames=9"}));
  EXPECT_EQ(all["pipelines"][1]["name"], "a#2");
}

TEST_F(Bench, SaysWhichFrameOfWhichPipelineHadAnError) {
  write(chain({{"sources", "{frames: 9}"}}), "a.yaml");
  write(chain({{"sources", "{frames: 9}"}, {"warps", "{error_at: [3]}"}}), "b.yaml");
  const Ended ended = bench({"a.yaml", "--against", "b.yaml", "--json", "bench.json"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("b.yaml: frame 3: warps: "));
  EXPECT_FALSE(fs::exists(path("bench.json")));
}

TEST_F(Bench, RefusesWhatCannotBeMeasured) {
  write(chain({{"sources", "{frames: 3}"}}), "short.yaml");
  write(chain({{"sources", "{frames: 9}"}}), "a.yaml");
  const Ended few = bench({"short.yaml"});
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_THAT(few.err, HasSubstr("short.yaml: its source has 3 frames; 1 to warm up and 4 to"));
  const Ended none = weft({"bench", "short.yaml", "--set", "source.frames=0"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("its source has 0 frames"));
  const Ended unknown = bench({"a.yaml", "--set", "nobody.alpha=1"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("nobody"));
  const Ended absent = bench({"a.yaml", "--against", "absent.yaml"});
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("absent.yaml"));
  write("kept", "bench.json");
  const Ended taken = bench({"a.yaml", "--json", "bench.json"});
  EXPECT_EQ(taken.exit_code, 3);
  EXPECT_EQ(read_text(path("bench.json")), "kept");
  EXPECT_EQ(weft({"bench", "a.yaml", "--frames", "1"}).exit_code, 2);
}

}  // namespace
}  // namespace weft
