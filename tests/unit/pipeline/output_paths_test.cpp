// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::lines;
using testing::Ran;
using testing::read_lines;
using testing::read_text;

/// A pipeline whose source reads `input` and whose sinks have these keys beside `use`.
std::string pipeline(const std::string& input, const std::vector<std::string>& sinks) {
  std::string text = "weft: 1\nsource: {use: sources/test.scripted, params: {" +
                     (input.empty() ? "" : "path: '" + input + "'") +
                     "}}\ntemplate: {use: templates/test.scripted}\nsinks:\n";
  for (const std::string& sink : sinks) text += "  - {use: sinks/test.scripted, " + sink + "}\n";
  return text;
}

std::string to(const std::string& path) { return "params: {path: '" + path + "'}"; }

std::string over(const std::string& path) { return to(path) + ", overwrite: true"; }

class OutputPaths : public testing::PipelineTest {
 protected:
  /// The only error of a pipeline, or "ok".
  std::string answer(const std::string& input, const std::vector<std::string>& sinks) const {
    const auto report = check(pipeline(input, sinks)).second;
    if (report.ok()) return "ok";
    EXPECT_EQ(report.problems.size(), 1U) << report.text();
    return lines(report).front();
  }
  std::string answer(const std::string& sink) const { return answer("", {sink}); }
};

TEST_F(OutputPaths, NeverGoOverWhatIsThereUnlessTheEntrySaysSo) {
  write("precious", "notes.txt");
  fs::create_directories(path("full/inner"));
  fs::create_directory(path("empty"));
  fs::create_symlink("nowhere", path("dangling"));
  const std::string fix =
      "; choose a path where nothing is, such as a relative one, which is below the run folder, or "
      "write 'overwrite: true' beside 'use'";
  EXPECT_EQ(answer(to(path("notes.txt"))),
            "5:47: 'path': " + path("notes.txt") + " is a file" + fix);
  EXPECT_EQ(answer(to("../notes.txt")), "5:47: 'path': " + path("notes.txt") + " is a file" + fix);
  EXPECT_EQ(answer(to(path("full/"))),
            "5:47: 'path': " + path("full") + " is a folder that is not empty" + fix);
  EXPECT_EQ(answer(to(path("dangling"))), "5:47: 'path': " + path("dangling") + " is a link" + fix);
  EXPECT_EQ(answer(over(path("notes.txt"))), "ok");
  EXPECT_EQ(answer(over(path("full"))), "ok");
  EXPECT_EQ(answer(to(path("empty"))), "ok");
  EXPECT_EQ(answer(to(path("new.txt"))), "ok");
  EXPECT_EQ(answer(to("new.txt")), "ok");
  EXPECT_EQ(answer(to("/dev/null")), "ok");
  EXPECT_EQ(read_text(path("notes.txt")), "precious");
  write("precious", "bell\a");
  EXPECT_THAT(answer("params: {path: \"" + path("bell\\a") + "\"}"),
              HasSubstr("bell\\x07 is a file"));
}

TEST_F(OutputPaths, ThatKeepNothingNeedNoPermission) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", path("link"));
  for (const std::string& each : {path("pipe"), path("link"), std::string("/dev/stdout")}) {
    EXPECT_EQ(answer(to(each)), "ok") << each;
  }
  EXPECT_THAT(answer("", {to(path("pipe")), to(path("link"))}),
              HasSubstr("is the 'path' of sinks/test.scripted"));
}

TEST_F(OutputPaths, AreRefusedBeforeAnythingIsWritten) {
  write("precious", "notes.txt");
  const auto [pipeline_, report] = check(pipeline("", {over(path("notes.txt"))}));
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(run(pipeline("", {over(path("notes.txt"))})).frames.size(), 3U);
  EXPECT_EQ(read_lines(path("notes.txt")).size(), 3U);
}

TEST_F(OutputPaths, NeverGoOverWhatThePipelineReads) {
  fs::create_directory(path("in"));
  const std::string input = write("precious", "in/a.png");
  const auto refused = [&](const std::string& output, const std::string& given) {
    EXPECT_EQ(answer(given, {over(output)}),
              "5:47: 'path': " + output + " would overwrite what 'path' of sources/test.scripted " +
                  "reads, at " + path("pipeline.yaml") + ":2:53; choose another path")
        << given;
  };
  fs::create_symlink("a.png", path("in/link"));
  fs::create_symlink(path("in"), path("door"));
  ASSERT_EQ(link(input.c_str(), path("twin").c_str()), 0);
  for (const std::string& given : {input, path("in/*.png"), path("*/[a-b].png"), path("in"),
                                   path("door/a.png"), path("door/*.png"), path("in/link")}) {
    refused(input, given);
    refused(path("in/link"), given);
    refused(path("door/a.png"), given);
    refused(path("twin"), given);
    refused(path("in"), given);
    refused(path("door"), given);
  }
  refused(path("in/new.png"), path("in/*.png"));
  refused(path("in/new.txt"), path("in"));
  refused(path("door/new.txt"), path("in"));
  refused(path("in/new.txt"), path("door"));
  EXPECT_EQ(answer(path("in/*.png"), {to(path("in/new.txt"))}), "ok");
  EXPECT_EQ(answer(input, {to(path("in/a.png.avi"))}), "ok");
}

TEST_F(OutputPaths, NeverGoOverThePipelineItselfOrALibrary) {
  write("weft: 1\n", "base.yaml");
  EXPECT_THAT(answer(over(path("pipeline.yaml"))),
              HasSubstr("would overwrite a file of this pipeline; choose another path"));
  const std::string text = "extends: base.yaml\n" + pipeline("", {over(path("base.yaml"))});
  EXPECT_THAT(check(text).second.text(), HasSubstr("would overwrite a file of this pipeline"));
  const host::Installed* sink = registry_.find("sinks/test.scripted");
  EXPECT_THAT(answer(over(sink->library->library)), HasSubstr("would overwrite the library of "));
  EXPECT_THAT(answer(over(sink->library->file)), HasSubstr("would overwrite the library of "));
  EXPECT_THAT(answer(over(WEFT_TEST_PLUGINS)), HasSubstr("would overwrite the library of "));
}

TEST_F(OutputPaths, OfOnePipelineStaySeparate) {
  const auto second = [&](const std::string& one, const std::string& other) {
    return answer("", {to(one), to(other)});
  };
  EXPECT_EQ(second("a.txt", "b/../a.txt"),
            "6:47: 'path': " + path("run/a.txt") + " is the 'path' of sinks/test.scripted at " +
                path("pipeline.yaml") + ":5:47; choose another path");
  EXPECT_THAT(second("a.txt", path("run/a.txt")), HasSubstr("6:47: 'path'"));
  EXPECT_THAT(second(path("new.avi"), path("new.avi/meshes")), HasSubstr("collides with"));
  EXPECT_THAT(second(path("new.avi/meshes"), path("new.avi")), HasSubstr("collides with"));
  EXPECT_EQ(second("meshes", "meshes/a.txt"), "ok") << "a folder may hold a file";
  EXPECT_EQ(second(".", "a.txt"), "ok");
  EXPECT_EQ(second("/dev/null", "/dev/null"), "ok");
  EXPECT_EQ(second("a.txt", "b.txt"), "ok");
}

TEST_F(OutputPaths, LeaveTheFilesOfTheRunFolderAlone) {
  for (const char* name : {"frames.jsonl", "frames", "frames/000000.npz", "manifest.json",
                           "pipeline.yaml", "template.npz", "trace.json", "dumps/x"}) {
    const std::string own = fs::path(name).begin()->string();
    EXPECT_EQ(answer(to(name)),
              "5:47: 'path': the run folder has its own " + own + "; choose another name");
  }
  EXPECT_THAT(answer(over("..")), HasSubstr("holds the run folder; choose another path"));
}

TEST_F(OutputPaths, MayBeAllowedOnTheCommandLine) {
  write("precious", "notes.txt");
  const std::string file = write(pipeline("", {to(path("notes.txt"))}));
  const auto set = [&](const std::string& setting) {
    return check_pipeline(file, registry_, path("run"), {setting}).second.text();
  };
  EXPECT_EQ(set("sinks.overwrite=true"), "");
  EXPECT_EQ(set("sinks.overwrite=maybe"),
            "--set sinks.overwrite=maybe, column 17: 'overwrite' must be true or false\n");
}

TEST_F(OutputPaths, OfAnEffectiveConfigurationAreInTheNewRunFolder) {
  const Ran first = run(pipeline("", {to("a/lines.txt")}));
  const auto [again, report] =
      check_pipeline(first.folder + "/pipeline.yaml", registry_, path("run2"));
  EXPECT_TRUE(report.ok()) << report.text();
  EXPECT_THAT(effective_yaml(again.config), HasSubstr("path: a/lines.txt"));
  const auto allowed = check(pipeline("", {over(path("lines.txt"))})).first;
  EXPECT_THAT(effective_yaml(allowed.config), HasSubstr("overwrite: true"));
  EXPECT_THAT(effective_yaml(allowed.config), HasSubstr("path: " + path("lines.txt")));
}

TEST_F(OutputPaths, AreNoneWhereThereIsNoRunFolder) {
  const std::string file = write(pipeline("", {to("lines.txt")}));
  EXPECT_EQ(lines(check_pipeline(file, registry_, "").second),
            std::vector<std::string>{
                "5:47: 'path': there is no run folder for what it writes; leave it out"});
}

TEST_F(OutputPaths, LoseTheirPermissionWithTheirPlugin) {
  write("precious", "notes.txt");
  write(pipeline("", {over(path("notes.txt")) + ", as: out"}), "base.yaml");
  const std::string other =
      "weft: 1\nextends: base.yaml\nsinks: [{use: sinks/test.visibility, as: out}]\n";
  const auto [config, report] = load(other);
  ASSERT_EQ(config.sinks.size(), 1U);
  EXPECT_FALSE(config.sinks[0].overwrite);
}

}  // namespace
}  // namespace weft
