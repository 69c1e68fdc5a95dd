// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/records/npz.hpp"
#include "program_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using testing::chain;
using testing::Child;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Program;
using testing::read_lines;
using ::testing::StartsWith;

TEST_F(Program, PrintsTimesAndStatesOfARun) {
  const Ended ended = run(chain({{"solvers", "{no_result_at: [1]}"}}), {"--isolate", "none"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("ms p50"));
  EXPECT_THAT(ended.out, HasSubstr("shapes: 2 estimated  1 predicted  "
                                   "confidence 1.00 in the median, 1.00 at least"));
  EXPECT_THAT(ended.out, HasSubstr("3 frames, 0 failed: " + path("run")));
  EXPECT_EQ(ended.err, "");
}

TEST_F(Program, NeverMakesAFolderThatIsNamedLikeTheHomeFolder) {
  const std::string pipeline = write(chain({}));
  const auto at_home = [&](const std::string& out) {
    std::vector<std::string> words = command({"run", pipeline, out, "--quiet"});
    words.insert(words.begin() + 1, "HOME=" + path("home"));
    std::swap(words[1], words[3]), std::swap(words[1], words[2]);  // env takes its options first
    return Child(std::move(words), path("printed")).wait();
  };
  const char* spellings[] = {"--out=~/a", "--out=$HOME/b", "--out=${HOME}/c"};
  for (const char* out : spellings) EXPECT_EQ(at_home(out).exit_code, 0) << out;
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_TRUE(fs::exists(path("home/") + name + "/frames.jsonl")) << name;
  }
  const Ended other = at_home("--out=~else/d");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("but only ~/ (your home folder) is expanded"));
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_THAT(entry.path().filename().string(), Not(StartsWith("~")));
    EXPECT_THAT(entry.path().filename().string(), Not(StartsWith("$")));
  }
}

TEST_F(Program, SaysOneLineWhenQuiet) {
  const Ended ended = run(chain(), {"--quiet"});
  EXPECT_EQ(ended.out, "3 frames, 0 failed: " + path("run") + "\n");
}

TEST_F(Program, ExitsWithOneWhenMoreFramesFailedThanAllowed) {
  const Ended failed = run(chain({{"warps", "{error_at: [0, 2]}"}}, "max_failed: 1"));
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.out, HasSubstr("first error of warps: frame 0 (f0): warps/test.scripted: "
                                    "scripted error"));
  fs::remove_all(path("run"));
  EXPECT_EQ(run(chain({{"warps", "{error_at: [0, 2]}"}}, "max_failed: 2")).exit_code, 0);
  fs::remove_all(path("run"));
  EXPECT_EQ(run(chain({{"warps", "{no_result_at: [0, 2]}"}})).exit_code, 0);
}

TEST_F(Program, ExitsWithOneWhenAnErrorStoppedIt) {
  const Ended ended = run(chain({{"warps", "{throw_at: [1]}"}}, "max_failed: 9\non_error: stop"));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.out, HasSubstr("2 frames, 1 failed, stopped early"));
}

TEST_F(Program, ExitsWithTwoForAMistakeOfTheUser) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{}, {"run"}, {"rum", "x.yaml"}, {"run", "x.yaml", "--oot", "a"}}) {
    EXPECT_EQ(weft(arguments).exit_code, 2);
  }
  const Ended missing = weft({"check", "x.yaml"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(missing.err, "error: x.yaml: there is no such file; correct its name\n");
  const Ended refused = run(chain({{"solvers", "{refuse: true}"}}), {"--quiet"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              ::testing::ContainsRegex("^error: .*\\.yaml:[0-9]+:[0-9]+: "
                                       "solvers/test.scripted: refuses as scripted\n"));
}

TEST_F(Program, ChecksSeveralFilesAndNamesTheMistakesOfEach) {
  const std::string bad = write(chain({{"solvers", "{distance: 1}"}}), "bad.yaml");
  const std::string good = write(chain(), "good.yaml");
  const std::string other = write("weft: 2\n", "other.yaml");
  const Ended ended = weft({"check", bad, good, other});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.out, StartsWith(good + ": ok, "));
  EXPECT_THAT(ended.err, AllOf(StartsWith(bad + ":"), HasSubstr("\n" + other + ":1:7: ")));
  EXPECT_EQ(weft({"check", good, good}).exit_code, 0);
}

TEST_F(Program, SuggestsTheCommandThatIsMeant) {
  const auto refusal = [&](const std::vector<std::string>& arguments) {
    const Ended ended = weft(arguments);
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_EQ(ended.out, "");
    return ended.err;
  };
  EXPECT_EQ(refusal({"chekc", "x.yaml"}), "error: no command 'chekc'; did you mean 'check'?\n");
  EXPECT_EQ(refusal({"plugins", "shwo"}), "error: no command 'shwo'; did you mean 'show'?\n");
  EXPECT_EQ(
      refusal({"frobnicate"}),
      "error: no command 'frobnicate'; there are: live, track, init, doctor, run, check, replay, "
      "migrate, calibrate, graph, report, data, template, eval, bench, metrics, compare, ablate, "
      "plugins, records, schema, completion, manual\n");
  EXPECT_THAT(refusal({"run", "x.yaml", "y.yaml"}), HasSubstr("y.yaml"));
  EXPECT_THAT(refusal({"--frob", "check"}), HasSubstr("weft check has no option '--frob'"));
}

TEST_F(Program, HelpsWithTypesAndExitCodes) {
  const auto help = [&](std::vector<std::string> command) {
    command.push_back("--help");
    const Ended ended = weft(command);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, Not(HasSubstr("TEXT")));
    return ended.out;
  };
  EXPECT_THAT(help({}), HasSubstr("--plugin-path FOLDER "));
  const std::string run = help({"run"});
  EXPECT_THAT(run, HasSubstr("--set PATH=VALUE "));
  EXPECT_THAT(run, HasSubstr("--dump STAGE "));
  EXPECT_THAT(run, HasSubstr("--out FOLDER "));
  EXPECT_THAT(run, Not(HasSubstr(" ...")));
  EXPECT_THAT(run, HasSubstr("Exit codes:\n  0  done, or interrupted; at most max_failed"));
  EXPECT_THAT(
      help({"check"}),
      HasSubstr("Exit codes:\n  0  the pipelines, and every cell of the plans, can be run\n  2  "));
  const std::string eval = help({"eval"});
  EXPECT_THAT(eval, HasSubstr("--alignment none|scale|rigid|all (default: none)"));
  EXPECT_THAT(eval, HasSubstr("one after another, into metrics.json, metrics_scale.json and "));
  EXPECT_THAT(eval, HasSubstr("without --json and --csv"));
  EXPECT_THAT(eval, HasSubstr("--match-tolerance-px PX (default: 2)"));
  EXPECT_THAT(eval, HasSubstr("Exit codes:\n  0  measured\n"));
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"replay"}, {"doctor"}, {"plugins", "show"}, {"plugins", "why"}}) {
    EXPECT_THAT(help(command), HasSubstr("Exit codes:\n  0  ")) << command.back();
  }
}

TEST_F(Program, TakesSettingsAndDumpsOneByOne) {
  const Ended ended = run(chain(), {"--set", "source.frames=1", "--set", "seed=4", "--dump",
                                    "warps", "--dump", "filters", "--quiet"});
  EXPECT_EQ(ended.out, "1 frames, 0 failed: " + path("run") + "\n") << ended.err;
  EXPECT_TRUE(fs::exists(path("run/dumps/warps")));
  EXPECT_TRUE(fs::exists(path("run/dumps/filters")));
}

TEST_F(Program, ExitsWithThreeWhenItCannotWrite) {
  fs::create_directories(path("run"));
  write("mine", "run/notes.txt");
  const Ended full = run(chain());
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr("exists and is not an empty folder; choose another with --out"));
  fs::remove_all(path("run"));
  const Ended finish = run(chain({{"sinks", "{refuse_finish: true}"}}), {"--quiet"});
  EXPECT_EQ(finish.exit_code, 3);
  EXPECT_EQ(finish.err, "error: sinks/test.scripted: cannot finish as scripted\n");
}

TEST_F(Program, ChecksWithoutRunning) {
  const Ended ended = weft({"check", write(chain({{"solvers", "{refuse: true}"}}))});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("pipeline.yaml: ok, 6 stages, 1 sinks"));
  EXPECT_FALSE(fs::exists(path("runs")));
}

TEST_F(Program, PutsRunsBesideOneAnother) {
  const std::string file = write(chain(), "mine.yaml");
  EXPECT_EQ(weft({"run", file}).exit_code, 0);
  EXPECT_EQ(weft({"run", file}).exit_code, 0);
  EXPECT_TRUE(fs::exists(path("runs/mine/frames.jsonl")));
  EXPECT_TRUE(fs::exists(path("runs/mine-2/frames.jsonl")));
}

TEST_F(Program, LeavesFinishedFramesReadableWhenItIsKilled) {
  const std::string file = write(chain(
      {{"sources", "{frames: 500, sleep_ms: 10, truth: true}"}, {"sinks", "{path: lines.txt}"}}));
  Child child(command({"run", file, "--out", path("run")}), path("printed"));
  ASSERT_TRUE(wait_for_frames(3));
  child.send(SIGKILL);
  const Ended ended = child.wait();
  EXPECT_EQ(ended.signal, SIGKILL);

  const std::vector<std::string> lines = read_lines(path("run/frames.jsonl"));
  EXPECT_LT(lines.size(), 500U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    // Only the last line may be cut.
    const json frame = json::parse(lines[i], nullptr, false);
    if (frame.is_discarded() && i + 1 == lines.size()) continue;
    ASSERT_FALSE(frame.is_discarded()) << lines[i];
    EXPECT_EQ(frame["frame"], i);
    char name[48];
    std::snprintf(name, sizeof name, "run/frames/%06zu.npz", i);
    const auto records = host::read_npz(path(name));
    ASSERT_TRUE(records) << name;
    EXPECT_EQ(records->size(), 6U);  // shape, truth, visibility, matches, mask, warp samples
  }
  for (const auto& entry : fs::directory_iterator(path("run/frames"))) {
    if (entry.path().extension() != ".npz") continue;
    EXPECT_TRUE(host::read_npz(entry.path().string())) << entry.path();
  }
  EXPECT_TRUE(load_pipeline(path("run/pipeline.yaml"), registry_, path("again")).second.ok());
  EXPECT_FALSE(json::parse(testing::read_text(path("run/manifest.json"))).empty());
  EXPECT_TRUE(host::read_npz(path("run/template.npz")));
  EXPECT_THAT(read_lines(path("run/lines.txt.part"))[0], StartsWith("0 estimated"));
}

TEST_F(Program, PrintsWhatComponentsWarnOf) {
  const Ended ended = run(chain({{"filters", "{degenerate_at: [0, 2]}"}}), {"--quiet"});
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(ended.err, "warning: filters: scripted warning (2 of 3 frames)\n");
  EXPECT_EQ(ended.out, "3 frames, 0 failed, 1 warned: " + path("run") + "\n");
}

TEST_F(Program, ListsComponentsAndRefusals) {
  fs::create_directories(path("plugins"));
  write("no library", "plugins/junk.so");
  const Ended table = weft({"--plugin-path", path("plugins"), "plugins", "list"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("solvers/test.scripted"));
  EXPECT_THAT(table.out, HasSubstr("refused " + path("plugins/junk.so")));
  const Ended listed = weft({"plugins", "list", "--json"});
  const json list = json::parse(listed.out);
  EXPECT_GE(list["plugins"].size(), 19U);
}

TEST_F(Program, ShowsAComponentWithItsParameters) {
  const Ended shown = weft({"plugins", "show", "templates/test.scripted"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, StartsWith("templates/test.scripted 1.0.0\nA flat sheet, or a broken"));
  EXPECT_THAT(shown.out, HasSubstr("columns: vertices in a row\n      i64, 2 to 100, default 6\n"));
  EXPECT_THAT(shown.out, HasSubstr("choice: none, index, "));
  EXPECT_THAT(shown.out, HasSubstr("role         build makes template*\n"));
  EXPECT_THAT(weft({"plugins", "show", "filters/test.scripted"}).out,
              HasSubstr("role         filter takes correspondences*, template, camera, "
                        "previous.shape, ground_truth; makes inlier_mask*\n"
                        "             (*: in every use of the role)\n"
                        "reads        previous.shape\n"));
  EXPECT_THAT(weft({"plugins", "show", "filters/test.scripted"}).out,
              HasSubstr("\nsweep        every over 2, 3, 5\n"));
  EXPECT_THAT(weft({"plugins", "show", "filters/test.scripted", "--json"}).out,
              HasSubstr("\"sweep\""));
  EXPECT_THAT(weft({"plugins", "show", "warps/test.scripted"}).out,
              HasSubstr("role         fit takes correspondences*, template*, weights; makes warp*\n"
                        "             evaluate takes warp*, points*; makes warp_samples*\n"));
  const Ended unknown = weft({"plugins", "show", "templates/test.script"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'templates/test.scripted'?"));
}

}  // namespace
}  // namespace weft
