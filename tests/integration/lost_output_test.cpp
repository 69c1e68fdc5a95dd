// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/videoio.hpp>
#include <set>

#include "shelled_program.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using testing::chain;
using testing::Ended;
using ::testing::HasSubstr;
using testing::read_lines;
using testing::read_text;
using ::testing::StartsWith;

/// The program, started by a shell that takes something away from it: its standard output, or the
/// right to write large files.
class LostOutput : public testing::ShelledProgram {
 protected:
  /// No file may be larger than this, memory of workers included; the shell counts in 512 bytes.
  Ended limited(int kb, const std::vector<std::string>& arguments) const {
    return weft("ulimit -f " + std::to_string(2 * kb) + R"( && exec "$0" "$@")", arguments);
  }

  /// A pipeline with frames of 160 x 120 px and an overlay.
  static std::string overlay(int frames, const std::string& params,
                             const std::string& options = "max_failed: 1000") {
    return "weft: 1\n" + options +
           "\nsource: {use: sources/test.scripted, params: {frames: " + std::to_string(frames) +
           "}}\ntemplate: {use: templates/test.scripted}\n" +
           "sinks:\n  - {use: sinks/overlay, params: {" + params + "}}\n";
  }

  static int frames_in(const std::string& video) {
    cv::VideoCapture capture(video, cv::CAP_FFMPEG);
    int count = 0;
    while (capture.isOpened() && capture.grab()) ++count;
    return count;
  }
};

TEST_F(LostOutput, ABrokenPipeEndsNoRun) {
  const std::string file = write(chain());
  const Ended ended = weft(R"(("$0" "$@"; echo $? > code) | true)",
                           {"run", file, "--out", "kept", "--isolate", "none"});
  EXPECT_EQ(read_lines(path("code")), std::vector<std::string>{"3"});
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(read_lines(path("kept/frames.jsonl")).size(), 3U);
  EXPECT_TRUE(fs::exists(path("kept/end.json")));
}

TEST_F(LostOutput, OfEveryCommandIsAnErrorWithCodeThree) {
  const std::string file = write(chain());
  ASSERT_EQ(weft({"run", file, "--out", "kept", "--dump", "warps"}).exit_code, 0);
  write(
      "weft: 1\nname: plan\npipeline: pipeline.yaml\ndata_use: tuning\naxes:\n"
      "  distance: {set: solvers.distance_m, values: [0.2, 0.3]}\n"
      "data: {plain: {seeds: 1-2, seed_setting: source.frames}}\n",
      "plan.yaml");
  ASSERT_EQ(weft({"ablate", "plan.yaml", "--out", "cells"}).exit_code, 0);
  const std::vector<std::vector<std::string>> commands{
      {"--version"},
      {"--help"},
      {"check", file},
      {"migrate", file},
      {"run", file, "--out", "other", "--quiet"},
      {"records"},
      {"plugins", "list"},
      {"plugins", "show", "sinks/overlay"},
      {"doctor"},
      {"eval", "kept"},
      {"eval", "kept", "--json", "-"},
      {"replay", "warps", "kept"},
      {"ablate", "plan.yaml", "--out", "cells", "--status"},
      {"report", "cells"}};
  for (const auto& command : commands) {
    const Ended full = weft(R"(exec "$0" "$@" > /dev/full)", command);
    EXPECT_EQ(full.exit_code, 3) << command.front();
    EXPECT_THAT(full.err, StartsWith("error: the standard output cannot be written"))
        << command.front();
  }
}

TEST_F(LostOutput, ThatIsClosedIsNotMistakenForAFile) {
  const Ended closed = weft(R"(exec "$0" "$@" >&- <&-)",
                            {"run", write(chain()), "--out", path("run"), "--isolate", "none"});
  EXPECT_EQ(closed.exit_code, 3);
  EXPECT_EQ(closed.err, "error: the standard output cannot be written (Bad file descriptor)\n");
  const std::vector<std::string> lines = read_lines(path("run/frames.jsonl"));
  ASSERT_EQ(lines.size(), 3U);
  for (const std::string& line : lines) EXPECT_THAT(line, StartsWith("{\"frame\":"));
}

TEST_F(LostOutput, ThatIsNotNeededIsNoError) {
  const std::string file = write(chain());
  ASSERT_EQ(weft({"run", file, "--out", "kept"}).exit_code, 0);
  EXPECT_EQ(weft(R"(exec "$0" "$@" >&-)", {"eval", "kept", "--quiet"}).exit_code, 0);
}

TEST_F(LostOutput, OfAFileThatGrowsTooLargeIsNamedWithItsReason) {
  const std::string file = write(overlay(40, "path: overlay.avi"));
  const Ended ended = limited(48, {"run", file, "--out", "run", "--quiet", "--isolate", "none"});
  EXPECT_EQ(ended.exit_code, 3) << ended.out << ended.err;
  EXPECT_EQ(ended.signal, 0);
  EXPECT_EQ(ended.err, "error: sinks/overlay: the video " + path("run/overlay.avi") +
                           " cannot be written (it is beyond the file size limit, see ulimit -f): "
                           "choose another 'path', or make it writable and free space\n");
  // Those that were written can be read, and there is an error for each of the others, at a frame
  // that is at most three later.
  const int readable = frames_in(path("run/overlay.avi"));
  EXPECT_GT(readable, 1);
  const std::vector<std::string> lines = read_lines(path("run/frames.jsonl"));
  ASSERT_EQ(lines.size(), 40U);
  int written = 0;
  for (const std::string& line : lines) written += line.find("\"failed\":false") != line.npos;
  EXPECT_LE(readable, written);
  EXPECT_GE(readable, written - 3);
}

TEST_F(LostOutput, OfAVideoByFfmpegIsNamedWithItsReason) {
  for (const std::string name : {"overlay.mkv", "overlay.mp4"}) {
    const std::string file = write(overlay(40, "path: " + name));
    const Ended ended =
        limited(24, {"run", file, "--out", name + "_run", "--quiet", "--isolate", "none"});
    EXPECT_EQ(ended.exit_code, 3) << ended.out << ended.err;
    EXPECT_EQ(ended.err, "error: sinks/overlay: the video " + path(name + "_run/" + name) +
                             " cannot be written (it is beyond the file size limit, see ulimit "
                             "-f): choose another 'path', or make it writable and free space\n");
    EXPECT_GT(frames_in(path(name + "_run/" + name)), 1);
  }
}

TEST_F(LostOutput, OfAKilledRunLacksThreeFramesAtMost) {
  for (const std::string name : {"overlay.avi", "overlay.mkv", "overlay.mp4"}) {
    const std::string file = write(overlay(100'000, "path: " + name)),
                      video = name + "_run/" + name;
    weft("\"$0\" \"$@\" & while [ $(stat -c %s " + video +
             " 2>/dev/null || echo 0) -lt 60000 ]; do sleep 0.01; done; kill -9 $!; wait $!",
         {"run", file, "--out", name + "_run", "--quiet", "--isolate", "none"});
    const int readable = frames_in(path(video));
    EXPECT_GT(readable, 5) << name;
    EXPECT_GE(readable + 3, static_cast<int>(read_lines(path(name + "_run/frames.jsonl")).size()));
  }
}

TEST_F(LostOutput, OfTheMemoryOfWorkersNamesTheLimit) {
  const std::string file = write(chain());
  const Ended ended = limited(48, {"run", file, "--quiet", "--isolate", "all", "--out", "run"});
  EXPECT_EQ(ended.exit_code, 3) << ended.out << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("there is no room for workers in shared memory; the file size "
                                   "limit holds for it, too: see ulimit -f"));
}

TEST_F(LostOutput, OfTheRunFolderItselfNamesTheFile) {
  const std::string file = write(chain({{"sources", "{frames: 400}"}}));
  const Ended ended = limited(24, {"run", file, "--out", "run", "--quiet", "--isolate", "none"});
  EXPECT_EQ(ended.exit_code, 3) << ended.out << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(" cannot be written (it is beyond the file size limit"));
}

TEST_F(LostOutput, OfAnAblationNamesTheFileAndCostsNoCellThatWasFinished) {
  write(chain({{"sources", "{frames: 12, truth: true}"}}));
  write(
      "weft: 1\nname: plan\npipeline: pipeline.yaml\ndata_use: tuning\naxes:\n"
      "  distance: {set: solvers.distance_m, values: [0.2, 0.3, 0.4]}\n"
      "data: {plain: {seeds: 2-3, seed_setting: source.frames}, long: {}}\n",
      "plan.yaml");
  const std::vector<std::string> ablate{"ablate",  "plan.yaml", "--out", "cells",
                                        "--quiet", "--isolate", "none"};
  const auto finished = [&] {
    std::set<std::string> keys;
    for (const auto& file : fs::directory_iterator(path("cells/results"))) {
      for (const std::string& line : read_lines(file.path().string())) {
        EXPECT_TRUE(keys.insert(line.substr(line.find("\"key\""), 40)).second) << "twice";
      }
    }
    return keys;
  };
  std::set<std::string> before;
  int stopped = 0;
  for (const int kb : {8, 12, 16, 24}) {
    const Ended ended = limited(kb, ablate);
    EXPECT_EQ(ended.signal, 0);
    if (ended.exit_code != 0) {
      ++stopped;
      EXPECT_EQ(ended.exit_code, 3) << ended.out << ended.err;
      EXPECT_THAT(ended.err, HasSubstr(path("cells/"))) << kb;
      EXPECT_THAT(ended.err, HasSubstr(" cannot be written (it is beyond the file size limit"))
          << kb;
    }
    if (!fs::exists(path("cells/results"))) continue;
    const auto now = finished();
    EXPECT_TRUE(std::includes(now.begin(), now.end(), before.begin(), before.end())) << kb;
    before = now;
  }
  EXPECT_GT(stopped, 1);
  EXPECT_EQ(weft(ablate).exit_code, 0);
  EXPECT_EQ(finished().size(), 9U);
}

TEST_F(LostOutput, NeverTakesWhatAPipelineReads) {
  ASSERT_EQ(weft({"run", write(overlay(3, "path: film.avi")), "--out", "film"}).exit_code, 0);
  const std::string film = path("film/film.avi"), before = read_text(film);
  write("fx: 100\nfy: 100\ncx: 139.5\ncy: 68.5\nwidth: 280\nheight: 138\ndistortion: null\n",
        "camera.yaml");
  const std::string text =
      "weft: 1\nsource: {use: sources/video, params: {path: film/film.avi, camera: camera.yaml}}\n"
      "template: {use: templates/test.scripted}\nsinks:\n"
      "  - {use: sinks/overlay, params: {path: '" +
      film + "'}, overwrite: true}\n";
  const std::string file = write(text);
  for (const char* command : {"check", "run"}) {
    const Ended refused = weft({command, file});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, StartsWith(file + ":5:41: 'path': " + film +
                                        " would overwrite what 'path' of sources/video reads, at " +
                                        file + ":2:45; choose another path\n"));
  }
  EXPECT_EQ(read_text(film), before);
}

TEST_F(LostOutput, OfAnEarlierRunStaysWhenItsPipelineRunsAgain) {
  ASSERT_EQ(weft({"run", write(overlay(3, "path: o.avi")), "--out", "one"}).exit_code, 0);
  const std::string before = read_text(path("one/o.avi"));
  ASSERT_EQ(
      weft({"run", "one/pipeline.yaml", "--out", "two", "--set", "source.frames=2"}).exit_code, 0);
  EXPECT_EQ(read_text(path("one/o.avi")), before);
  EXPECT_EQ(frames_in(path("two/o.avi")), 2);
}

TEST_F(LostOutput, OfStillsFollowsTheRuleOfOutputs) {
  fs::create_directory(path("film"));
  write("precious", "film/000000.png");
  const std::string file = write(overlay(1, "path: '" + path("film.avi") + "', stills_every: 1"));
  const Ended refused = weft({"check", file});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("'stills': " + path("film") + " is a folder that is not"));
}

TEST_F(LostOutput, OfCommandsReplacesNoFileUnasked) {
  ASSERT_EQ(weft({"run", write(chain()), "--out", "run"}).exit_code, 0);
  for (const char* option : {"--csv", "--json"}) {
    write("precious", "mine");
    const Ended refused = weft({"eval", "run", option, "mine", "--no-save"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_EQ(refused.err,
              "error: mine: is there already; choose another name, or give --overwrite\n");
    EXPECT_EQ(read_text(path("mine")), "precious");
    EXPECT_EQ(weft({"eval", "run", option, "mine", "--overwrite"}).exit_code, 0);
    EXPECT_NE(read_text(path("mine")), "precious");
    EXPECT_EQ(weft({"eval", "run", option, "/dev/null"}).exit_code, 0);
  }
}

}  // namespace
}  // namespace weft
