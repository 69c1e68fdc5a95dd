// SPDX-License-Identifier: Apache-2.0
// sinks/stream in runs as users start them, in a shell with another program behind a pipe.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "shelled_program.hpp"

namespace weft {
namespace {

using testing::Ended;
using ::testing::HasSubstr;
using testing::read_lines;
using ::testing::StartsWith;

class PointsOut : public testing::ShelledProgram {
 protected:
  /// The scripted pipeline, whose sink is sinks/stream.
  std::string points(int frames, const std::string& params) const {
    std::string text = testing::chain({{"sources", "{frames: " + std::to_string(frames) + "}"}});
    const std::string sink = "{use: sinks/test.scripted, params: {}}";
    return write(text.replace(text.find(sink), sink.size(),
                              "{use: sinks/stream, params: {" + params + "}}"));
  }
};

TEST_F(PointsOut, AreTheOnlyContentOfTheStandardOutputTheyAreSentTo) {
  const std::string file = points(5, "path: /dev/stdout");
  const Ended ended = weft({"run", file, "--out", "run"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const std::vector<std::string> lines = read_lines(path("printed.out"));
  ASSERT_EQ(lines.size(), 5U) << ended.out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_THAT(lines[i], StartsWith("{\"frame\":" + std::to_string(i) + ","));
    EXPECT_EQ(lines[i].back(), '}');
  }
  EXPECT_THAT(ended.err, HasSubstr("ms p50"));
  EXPECT_THAT(ended.err, HasSubstr("5 frames, 0 failed: " + path("run\n")));
  // Elsewhere the words of a run stand where they always do.
  const Ended usual = weft({"run", points(5, "path: points"), "--out", "file"});
  EXPECT_THAT(usual.out, HasSubstr("5 frames, 0 failed: " + path("file\n")));
  EXPECT_EQ(read_lines(path("file/points")), lines);
}

TEST_F(PointsOut, AreReadByTheExampleBehindAPipeInBothFormats) {
  for (const std::string format : {"json_lines", "packed"}) {
    const std::string file = points(5, "path: /dev/stdout, format: " + format);
    const Ended ended =
        weft(R"("$0" "$@" | python3 ')" WEFT_POINTS_READER "' -", {"run", file, "--out", format});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    const std::vector<std::string> lines = read_lines(path("printed.out"));
    ASSERT_EQ(lines.size(), 5U) << ended.out << ended.err;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_THAT(lines[i], StartsWith("frame " + std::to_string(i) + "  "));
    }
  }
}

TEST_F(PointsOut, MayGoIntoANamedPipe) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string file = points(5, "path: '" + path("pipe") + "'");
  const Ended alone = weft({"run", file, "--out", "alone"});
  EXPECT_NE(alone.exit_code, 0);
  EXPECT_THAT(alone.err, HasSubstr("start its reader first"));
  // `exec` returns when both ends are open.
  const Ended ended = weft(R"(cat pipe > got & exec 3>pipe; "$0" "$@"; exec 3>&-; wait)",
                           {"run", file, "--out", "run"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("5 frames, 0 failed: " + path("run\n")));
  EXPECT_EQ(read_lines(path("got")).size(), 5U);
}

TEST_F(PointsOut, OnABrokenPipeAreAnErrorOfTheirSinkAndTheRunContinues) {
  const std::string file = points(400, "path: /dev/stdout");
  const Ended ended =
      weft(R"(("$0" "$@"; echo $? > code) | head -n 1)", {"run", file, "--out", "run"});
  EXPECT_EQ(read_lines(path("code")), std::vector<std::string>{"1"});
  EXPECT_EQ(read_lines(path("printed.out")).size(), 1U);
  EXPECT_THAT(ended.err,
              HasSubstr("no process reads /dev/stdout any more: keep its reader running"));
  EXPECT_EQ(read_lines(path("run/frames.jsonl")).size(), 400U);
}

TEST_F(PointsOut, NeedADestinationThatWeftCheckCanUnderstand) {
  const auto answer = [&](const std::string& params) {
    const Ended ended = weft({"check", points(5, params)});
    EXPECT_EQ(ended.exit_code, 2) << params;
    return ended.out + ended.err;
  };
  EXPECT_THAT(answer("to: stdout"),
              HasSubstr("'stdout' begins neither with tcp:// nor with udp://; write tcp://"));
  EXPECT_THAT(answer(""), HasSubstr("has neither 'to' nor 'path'"));
  EXPECT_THAT(answer("to: 'tcp://127.0.0.1:5005', path: x"), HasSubstr("has both"));
}

}  // namespace
}  // namespace weft
