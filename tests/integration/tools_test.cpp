// SPDX-License-Identifier: Apache-2.0
// The commands that look into plugins, runs and machines, as users start them.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::chain;
using testing::Child;
using ::testing::ElementsAre;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::read_lines;
using testing::read_text;
using ::testing::StartsWith;

constexpr const char* kLibrary = "sources_test.scripted";

/// The program in a separate folder.
class Tools : public testing::PipelineTest {
 protected:
  std::vector<std::string> command(const std::vector<std::string>& arguments,
                                   const std::string& plugins = WEFT_TEST_PLUGINS) const {
    std::vector<std::string> words{
        "/usr/bin/env", "-C", folder_, "WEFT_PLUGIN_PATH=", WEFT_PROGRAM, "--plugin-path", plugins};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
  }

  Ended weft(const std::vector<std::string>& arguments) const {
    return Child(command(arguments), path("printed")).wait();
  }

  /// Where only the plugins of the folder are looked for, besides those beside the program.
  Ended weft_with(const std::string& plugins, const std::vector<std::string>& arguments) const {
    return Child(command(arguments, plugins), path("printed")).wait();
  }

  /// Where a library does something when it is loaded.
  Ended weft_falling(const std::string& action, const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = command(arguments, WEFT_FALLS_FOLDER);
    words.insert(words.begin() + 3, "WEFT_FALLS=" + action);
    return Child(words, path("printed")).wait();
  }

  /// A copy of the library of scripted components, and of its manifest with a change.
  std::string copy_plugins(const std::string& folder, bool library, bool manifest,
                           const std::string& replace = {}, const std::string& by = {}) const {
    fs::create_directories(path(folder));
    const std::string from = std::string(WEFT_TEST_PLUGINS) + "/" + kLibrary;
    const std::string to = fs::canonical(path(folder)).string() + "/" + kLibrary;
    if (library) fs::copy_file(from + ".so", to + ".so");
    if (manifest) {
      const std::string text = read_text(from + ".plugin.yaml");
      std::ofstream(to + ".plugin.yaml")
          << (replace.empty() ? text : std::regex_replace(text, std::regex(replace), by));
    }
    return to + ".so";
  }

  static json parsed(const Ended& ended) {
    json value = json::parse(ended.out, nullptr, false);
    EXPECT_FALSE(value.is_discarded()) << ended.out << ended.err;
    return value;
  }
};

TEST_F(Tools, WhySaysWhereAUsablePluginWasFound) {
  const Ended ended = weft({"plugins", "why", "filters/test.scripted"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(ended.out, std::string("filters/test.scripted can be used\n  used: ") +
                           "filters/test.scripted 1.0.0 in " +
                           fs::canonical(WEFT_TEST_PLUGINS).string() + "/" + kLibrary +
                           ".so (--plugin-path)\n");
  const json why = parsed(weft({"plugins", "why", "filters/test.scripted", "--json"}));
  EXPECT_EQ(why["usable"], true);
  EXPECT_EQ(why["found"][0]["state"], "used");
  EXPECT_EQ(why["found"][0]["origin"], "--plugin-path");
}

TEST_F(Tools, WhySuggestsTheNearestId) {
  const Ended ended = weft({"plugins", "why", "filters/test.scriptde"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.out, StartsWith("filters/test.scriptde cannot be used\n"));
  EXPECT_THAT(ended.out, HasSubstr("did you mean 'filters/test.scripted'?"));
}

TEST_F(Tools, WhySaysWhatShadowsAPlugin) {
  const std::string copy = copy_plugins("second", true, true);
  const json by_id = parsed(
      weft({"--plugin-path", path("second"), "plugins", "why", "solvers/test.scripted", "--json"}));
  EXPECT_EQ(by_id["usable"], true);
  ASSERT_EQ(by_id["found"].size(), 2U);
  EXPECT_EQ(by_id["found"][1]["state"], "shadowed");
  EXPECT_EQ(by_id["found"][1]["library"], copy);
  EXPECT_THAT(by_id["found"][1]["cause"].get<std::string>(), HasSubstr("is found first, in"));
  const Ended by_file = weft({"--plugin-path", path("second"), "plugins", "why", copy});
  EXPECT_EQ(by_file.exit_code, 2);
  EXPECT_THAT(by_file.out, HasSubstr("shadowed: solvers/test.scripted 1.0.0 in " + copy));
}

TEST_F(Tools, WhyNamesCauseAndFixOfEachRefusal) {
  struct Case {
    const char* name;
    bool library, manifest;
    const char *replace, *by, *cause, *fix;
  };
  for (const Case& each : std::vector<Case>{
           {"unknown", true, false, "", "", "it has no manifest beside it",
            "run: weft plugins describe"},
           {"lonely", false, true, "", "", "the library is missing", "build or install"},
           {"stale", true, true, "build_id: \"[0-9a-f]{4}", "build_id: \"beef",
            "its manifest belongs to another build of it", "run: weft plugins describe"},
           {"old", true, true, "needs_minor: ", "needs_minor: 9", "it needs plugin ABI 1.9",
            "rebuild the plugin"},
           {"foreign", true, true, "isa: \\[", "isa: [\"sse9\", ",
            "it needs processor features that this version of Weft does not know: sse9",
            "rebuild the plugin without"},
           {"broken", true, true, "weft_plugin: 1", "weft_plugin: [", "its manifest cannot be read",
            "run: weft plugins describe"}}) {
    if (std::string(each.name) == "foreign") {
      // An empty list must stay a list.
      copy_plugins(each.name, true, true, "isa: \\[[^\\]]*\\]", "isa: [\"sse9\"]");
    } else {
      copy_plugins(each.name, each.library, each.manifest, each.replace, each.by);
    }
    const std::string file = fs::canonical(path(each.name)).string() + "/" + kLibrary + ".so";
    // The library is named after its first component, by which it is known without its manifest.
    const Ended by_id = weft_with(path(each.name), {"plugins", "why", "sources/test.scripted"});
    EXPECT_EQ(by_id.exit_code, 2) << each.name;
    EXPECT_THAT(by_id.out, HasSubstr("sources/test.scripted cannot be used")) << each.name;
    EXPECT_THAT(by_id.out, HasSubstr("refused: sources/test.scripted " + file)) << each.name;
    EXPECT_THAT(by_id.out, HasSubstr(each.cause)) << each.name;
    EXPECT_THAT(by_id.out, HasSubstr(each.fix)) << each.name;
    const std::string given =
        each.manifest ? file.substr(0, file.size() - 3) + ".plugin.yaml" : file;
    const Ended by_file = weft_with(path(each.name), {"plugins", "why", given});
    EXPECT_EQ(by_file.exit_code, 2) << each.name;
    EXPECT_THAT(by_file.out, HasSubstr(each.cause)) << each.name;
  }
}

TEST_F(Tools, WhyFindsLibrariesThatAreMissing) {
  const Ended ended =
      weft_with(WEFT_MISBEHAVING_FOLDER, {"plugins", "why", "filters/test_needs_missing"});
  EXPECT_EQ(ended.exit_code, 2) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("libtest_absent.so"));
  EXPECT_THAT(ended.out, HasSubstr("install the library it needs"));
}

TEST_F(Tools, WhySaysThatAFolderIsNotSearched) {
  const std::string copy = copy_plugins("elsewhere", true, true);
  fs::create_directories(path("empty"));
  const Ended ended = weft_with(path("empty"), {"plugins", "why", copy});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.out, HasSubstr("its folder is not searched"));
  EXPECT_THAT(ended.out, HasSubstr("add: --plugin-path " + fs::path(copy).parent_path().string()));
  const Ended none = weft({"plugins", "why", path("nothing.so")});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("there is no such file"));
  const Ended text = weft({"plugins", "why", write("a: b")});
  EXPECT_EQ(text.exit_code, 2);
  EXPECT_THAT(text.out, HasSubstr("is no plugin: give a library"));
}

TEST_F(Tools, ShowsAPluginAsJson) {
  const json shown = parsed(weft({"plugins", "show", "templates/test.scripted", "--json"}));
  EXPECT_EQ(shown["id"], "templates/test.scripted");
  std::set<std::string> keys;
  for (const auto& [key, value] : shown.items()) keys.insert(key);
  EXPECT_EQ(keys,
            (std::set<std::string>{"id", "version", "summary", "reference", "implements", "licence",
                                   "methods", "needs", "reads", "produces", "determinism", "random",
                                   "uses_truth", "extensions", "library", "origin", "parameters"}));
  EXPECT_EQ(shown["methods"], json::parse(R"([{"name": "build", "takes": [],
      "makes": [{"slot": "template", "always": true}]}])"));
  const auto columns = std::find_if(shown["parameters"].begin(), shown["parameters"].end(),
                                    [](const json& each) { return each["name"] == "columns"; });
  ASSERT_NE(columns, shown["parameters"].end());
  EXPECT_EQ(*columns, json::parse(R"({"name": "columns", "type": "i64", "list": false,
      "required": false, "default": 6, "range": [2, 100], "help": "vertices in a row"})"));
  const Ended unknown = weft({"plugins", "show", "templates/nothing", "--json"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.out, "");
}

TEST_F(Tools, DescribesALibraryAsJsonAndWritesNothing) {
  const std::string copy = copy_plugins("plugins", true, false);
  const json described = parsed(weft({"plugins", "describe", copy, "--json"}));
  EXPECT_EQ(described["weft_plugin"], 1);
  EXPECT_TRUE(described["abi"][0].is_number_integer());
  EXPECT_EQ(described["components"][0]["id"], "sources/test.scripted");
  EXPECT_EQ(described["components"][0]["parameters"][0]["default"], json::array());
  EXPECT_FALSE(fs::exists(path("plugins/sources_test.scripted.plugin.yaml")));
  const Ended written = weft({"plugins", "describe", copy});
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_TRUE(fs::exists(path("plugins/sources_test.scripted.plugin.yaml")));
  EXPECT_EQ(weft({"plugins", "describe", write("text", "a.so"), "--json"}).exit_code, 3);
}

TEST_F(Tools, OutliveALibraryThatEndsItsProcessWhenItIsLoaded) {
  const std::string library = std::string(WEFT_FALLS_FOLDER) + "/filters_test_falls.so";
  for (const std::string action : {"fault", "exit"}) {
    const auto says = HasSubstr("it ends the process that loads it");
    const Ended why = weft_falling(action, {"plugins", "why", "filters/test_falls"});
    EXPECT_EQ(why.exit_code, 2) << why.err;
    EXPECT_THAT(why.out, ::testing::AllOf(HasSubstr("refused: filters/test_falls"), says));
    const Ended described = weft_falling(action, {"plugins", "describe", library, "--json"});
    EXPECT_EQ(described.exit_code, 3);
    EXPECT_THAT(described.err, says);
    const json doctor = parsed(weft_falling(action, {"doctor", "--json"}));
    const json& devices = doctor["devices"]["of_plugins"];
    const auto of_it = std::find_if(devices.begin(), devices.end(), [](const json& entry) {
      return entry["plugins"][0] == "filters/test_falls";
    });
    ASSERT_NE(of_it, devices.end());
    EXPECT_THAT((*of_it)["reason"].get<std::string>(), says);
  }
}

TEST_F(Tools, HearNothingOfWhatALibraryPrints) {
  const std::string library = std::string(WEFT_FALLS_FOLDER) + "/filters_test_falls.so";
  const json described = parsed(weft_falling("print", {"plugins", "describe", library, "--json"}));
  EXPECT_EQ(described["components"][0]["id"], "filters/test_falls");
}

TEST_F(Tools, ATraceOfAKilledRunCanStillBeRead) {
  const std::string file = write(chain({{"sources", "{frames: 5000, sleep_ms: 5}"}}));
  Child child(command({"run", file, "--out", path("run")}), path("printed"));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (read_lines(path("run/trace.json")).size() < 60 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  child.send(SIGKILL);
  EXPECT_EQ(child.wait().signal, SIGKILL);
  const json trace = json::parse(read_text(path("run/trace.json")) + "]", nullptr, false);
  ASSERT_TRUE(trace.is_array());
  EXPECT_GE(trace.size(), 58U);
  EXPECT_EQ(trace.back()["ph"], "X");
}

TEST_F(Tools, ATraceShowsWhatRanInAWorker) {
  const std::string file = write(testing::head("{frames: 2}") +
                                 "stages:\n"
                                 "  - {use: matchers/test.pattern}\n"
                                 "  - {use: filters/test.warped, isolate: process}\n");
  const Ended ended = weft({"run", file, "--out", path("run"), "--dump", "filters"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const json trace = json::parse(read_text(path("run/trace.json")));
  std::map<int, std::string> processes;
  std::map<std::string, std::pair<double, double>> span;
  std::map<std::string, std::string> process_of;
  for (const json& event : trace) {
    if (event["name"] == "process_name") processes[event["pid"]] = event["args"]["name"];
    if (event["ph"] != "X" || event["args"].value("frame", -1) != 1) continue;
    const double begin = event["ts"], length = event["dur"];
    span[event["name"]] = {begin, begin + length};
    process_of[event["name"]] = processes[event["pid"]];
  }
  EXPECT_EQ(process_of["filters"], "weft");
  EXPECT_EQ(process_of["filters/warp"], "worker of filters");
  EXPECT_LE(span["filters"].first, span["filters/warp"].first);
  EXPECT_GE(span["filters"].second, span["filters/warp"].second);
  // This process makes the same result as a worker.
  EXPECT_EQ(weft({"replay", "filters", path("run")}).exit_code, 0);
}

/// A finished run with two dumps.
class ReplayTool : public Tools {
 protected:
  ReplayTool() {
    const std::string file = write(testing::head("{frames: 3}") +
                                   "stages:\n"
                                   "  - {use: matchers/test.pattern}\n"
                                   "  - {use: filters/test.warped}\n"
                                   "  - {use: warps/test.scripted}\n"
                                   "  - {use: passes/test.scripted}\n"
                                   "  - {use: solvers/test.scripted}\n");
    ran_ = weft({"run", file, "--out", path("run"), "--dump", "filters", "--dump", "solvers"});
  }
  Ended ran_;
};

TEST_F(ReplayTool, FindsNothingDifferent) {
  ASSERT_EQ(ran_.exit_code, 0) << ran_.err;
  for (const char* stage : {"filters", "solvers"}) {
    for (const std::string& records :
         {path("run"), path("run/dumps"), path("run/dumps/") + stage}) {
      const Ended ended = weft({"replay", stage, records, "--repeat", "3"});
      EXPECT_EQ(ended.exit_code, 0) << ended.err;
      EXPECT_THAT(ended.out, HasSubstr("frame 2: ok, "));
      EXPECT_THAT(ended.out, HasSubstr("3 calls: 3 identical, 0 different; median "));
    }
  }
  const Ended one = weft({"replay", "solvers", path("run/dumps/solvers/000001.npz")});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, StartsWith("frame 1: ok, "));
  EXPECT_THAT(one.out, HasSubstr(" ms, identical\n1 calls: 1 identical"));
}

TEST_F(ReplayTool, FindsTheDumpOfACallInTheWorkingDirectory) {
  fs::copy(path("run/dumps/solvers"), folder_);  // where the program runs
  const Ended ended = weft({"replay", "solvers", "000001.npz"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
}

TEST_F(ReplayTool, ReportsDifferences) {
  const std::vector<std::string> replay{"replay", "solvers", path("run")};
  std::vector<std::string> changed = replay;
  changed.insert(changed.end(), {"--params", "{distance_m: 0.25}", "--out", path("new")});
  const Ended reported = weft(changed);
  EXPECT_EQ(reported.exit_code, 0) << reported.err;
  EXPECT_THAT(reported.out, HasSubstr("    out.shape/vertices_m: 90 of 90 values differ, by at "
                                      "most 0.05\n"));
  EXPECT_THAT(reported.out, HasSubstr("3 calls: 0 identical, 3 different"));
  EXPECT_TRUE(fs::exists(path("new/000002.npz")));
  const Ended again = weft(changed);
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("is not an empty folder"));

  // Without other parameters a difference is a failure.
  const std::string stage = path("run/dumps/solvers/stage.yaml");
  const std::string text = read_text(stage);
  write(std::regex_replace(text, std::regex("distance_m: [0-9.]+"), "distance_m: 0.3"),
        "run/dumps/solvers/stage.yaml");
  EXPECT_EQ(weft(replay).exit_code, 1);
}

TEST_F(ReplayTool, SaysWhatIsWrong) {
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  };
  write("no npz", "damaged/000000.npz");
  fs::create_directories(path("damaged"));
  fs::copy(path("run/dumps/solvers"), path("damaged"));
  write("no npz", "damaged/000000.npz");
  for (const Case& each : std::vector<Case>{
           {{"solver", path("run")}, 2, "did you mean 'solvers'?"},
           {{"filters", path("run/dumps/solvers")}, 2, "the dump has the stage 'solvers'"},
           {{"solvers", path("run"), "--params", "{distance: 1}"}, 2, "did you mean 'distance_m'?"},
           {{"solvers", path("run"), "--params", "{refuse: true}"}, 2, "refuses as scripted"},
           {{"solvers", path("run"), "--repeat", "0"}, 2, "--repeat"},
           {{"solvers"}, 2, "RECORDS is required"},
           {{"solvers", path("nowhere")}, 3, "there is no such file"},
           {{"solvers", path("run/frames")}, 3, "holds no dump"},
           {{"solvers", path("damaged")}, 3, "cannot be read as an npz file"}}) {
    std::vector<std::string> arguments{"replay"};
    arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
    const Ended ended = weft(arguments);
    EXPECT_EQ(ended.exit_code, each.exit_code) << each.message;
    EXPECT_THAT(ended.err, HasSubstr(each.message));
  }
}

TEST_F(ReplayTool, ReportsTheAvailableStages) {
  const Ended ended = weft(
      {"run", path("pipeline.yaml"), "--out", path("b"), "--dump", "solver", "--isolate", "none"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_EQ(ended.err, "error: --dump: no stage is called 'solver'; did you mean 'solvers'?\n");
  EXPECT_FALSE(fs::exists(path("b")));
}

TEST_F(Tools, DoctorTellsTheMachineAndThePlugins) {
  copy_plugins("stale", true, true, "build_id: \"[0-9a-f]{4}", "build_id: \"beef");
  const Ended ended = weft({"--plugin-path", path("stale"), "doctor", "--json"});
  const json report = parsed(ended);
  EXPECT_EQ(ended.exit_code, report["usable"].get<bool>() ? 0 : 1);
  EXPECT_EQ(report["temporary"]["writable"], true);
  EXPECT_EQ(report["isolation"]["usable"], true) << report["isolation"];
  EXPECT_FALSE(report["processor"]["name"].get<std::string>().empty());
  ASSERT_GE(report["folders"].size(), 2U);
  EXPECT_EQ(report["folders"][0]["refused"], 0);
  EXPECT_GE(report["folders"][0]["usable"], 19);
  EXPECT_EQ(report["folders"][1]["usable"], 0);
  EXPECT_EQ(report["folders"][1]["refused"], 1);
  ASSERT_GE(report["plugins"]["refused"].size(), 1U);
  EXPECT_THAT(report["plugins"]["refused"][0]["fix"].get<std::string>(),
              StartsWith("run: weft plugins describe"));
  bool all = true;
  for (const json& plugin : report["demo"]) {
    EXPECT_EQ(plugin["usable"].get<bool>(), plugin["reason"].get<std::string>().empty());
    all = all && plugin["usable"].get<bool>();
  }
  EXPECT_EQ(report["usable"], all);
  const Ended text = weft({"doctor"});
  EXPECT_EQ(text.exit_code, all ? 0 : 1);
  EXPECT_THAT(text.out, StartsWith("weft        "));
  EXPECT_THAT(text.out, HasSubstr(all ? "the demo pipeline can run" : "cannot run"));
}

TEST_F(Tools, DoctorListsTheDevicesOfPlugins) {
  const json report = parsed(weft({"doctor", "--json"}));
  bool scripted = false;
  for (const json& library : report["devices"]["of_plugins"]) {
    EXPECT_EQ(library["reason"], "") << library;
    if (library["plugins"][0] != "detectors/test.device") continue;
    scripted = true;
    EXPECT_EQ(library["devices"], json::array({"scripted device", "another one"}));
  }
  EXPECT_TRUE(scripted);
  EXPECT_THAT(weft({"doctor"}).out,
              HasSubstr("\ndevice      1: another one for detectors/test.device, "));
}

TEST_F(Tools, DoctorLooksAtThePluginsOfTheDemo) {
  const std::string demo = read_text(WEFT_DEMO);
  std::set<std::string> used, examined;
  const std::regex use("use: ([a-z_/]+)");
  for (std::sregex_iterator match(demo.begin(), demo.end(), use), end; match != end; ++match) {
    used.insert((*match)[1]);
  }
  const json report = parsed(weft({"doctor", "--json"}));
  for (const json& plugin : report["demo"]) examined.insert(plugin["id"]);
  EXPECT_EQ(examined, used);
}

}  // namespace
}  // namespace weft
