// SPDX-License-Identifier: Apache-2.0
// Each check of `weft plugins check` must fail for a plugin that breaks its rule, and hold for one
// that does nothing wrong.
#include "kit/conformance/conformance.hpp"

#include <gmock/gmock.h>

#include <set>

#include "../misbehaving.hpp"
#include "kit/conformance/check_in_child.hpp"
#include "kit/conformance/check_list.hpp"
#include "kit/conformance/groups.hpp"

namespace weft::misbehaving {
namespace {

using conformance::Verdict;
using ::testing::HasSubstr;

const std::string kUnruly = WEFT_UNRULY_FOLDER;
constexpr const char* kFaulty = "filters/test_faulty";

/// The library of faults in a separate folder, because it chooses its fault when it is loaded.
class FaultyFolder {
 public:
  explicit FaultyFolder(const std::string& fault) {
    for (const char* ending : {".so", ".plugin.yaml"}) {
      const std::string name = std::string("filters_test_faulty") + ending;
      fs::copy_file(std::string(WEFT_FAULTY_FOLDER) + "/" + name, folder_.path() / name);
    }
    setenv("WEFT_FAULT", fault.c_str(), 1);
  }
  ~FaultyFolder() { unsetenv("WEFT_FAULT"); }
  FaultyFolder(const FaultyFolder&) = delete;
  FaultyFolder& operator=(const FaultyFolder&) = delete;

  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
};

conformance::Report checked(const std::string& folder, const std::string& id,
                            const std::string& params, const std::string& only) {
  conformance::Asked asked;
  asked.subjects = {id};
  asked.params = params;
  asked.plugin_folders = {folder};
  const auto candidates = conformance::candidates(asked);
  if (!candidates) throw std::runtime_error(candidates.error().message);
  return conformance::check(candidates->front(), {only, false});
}

/// A fault of filters/test_faulty, or another component.
struct Broken {
  const char *fault, *check, *seen;

  bool is_other() const { return std::string_view(fault).starts_with("filters/"); }
};

class BrokenPlugin : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenPlugin, FailsTheCheckOfTheRuleThatItBreaks) {
  const Broken& broken = GetParam();
  const FaultyFolder faulty(broken.is_other() ? "" : broken.fault);
  const auto report = broken.is_other() ? checked(kUnruly, broken.fault, "{}", broken.check)
                                        : checked(faulty.path(), kFaulty, "{}", broken.check);
  ASSERT_EQ(report.findings.size(), 1u) << broken.check;
  EXPECT_EQ(report.findings[0].check, broken.check);
  EXPECT_EQ(report.findings[0].verdict, Verdict::fails) << report.findings[0].seen;
  EXPECT_THAT(report.findings[0].seen, HasSubstr(broken.seen));
}

const Broken kBroken[] = {
    {"filters/test_loud", "load/symbol", "test_loud_counter"},
    {"filters/test_loud", "load/static_tls", "DF_STATIC_TLS"},
    {"load_slow", "load/time", "when it is first needed"},
    {"load_prints", "load/silent", "prints"},
    {"load_thread", "load/threads", "starts a thread"},
    {"describing_opens_file", "load/opens_nothing", "/etc/hostname"},
    {"other_methods", "table/methods", "its role does not have"},
    {"answers_unknown_extension", "table/unknown_extension", "weft.there_is_no_such/1"},
    {"extension_moves", "table/extensions_stable", "another table each time"},
    {"answers_all_methods", "table/unknown_method", "status 0"},
    {"reads_past_call", "table/older_host", "ended by signal 11"},
    {"confused_by_newer_host", "table/newer_host", "differs"},
    {"accepts_out_of_range", "parameters/beyond", "strictness = nan is accepted"},
    {"accepts_wrong_type", "parameters/wrong_type", "strictness = a text is accepted"},
    {"refuses_unknown", "parameters/unknown", "there is no such parameter"},
    {"crashes_at_end_of_range", "parameters/ends", "ended by signal 6"},
    {"crashes_in_corner", "parameters/pairs", "ended by signal 6"},
    {"keeps_first_number", "parameters/live", "strictness set between two frames"},
    {"ignores_padding", "contract/padded_inputs", "differs"},
    {"runs_forward", "contract/backward_inputs", "differs"},
    {"needs_aligned_inputs", "contract/aligned_inputs", "differs"},
    {"uses_unknown_array", "contract/unknown_arrays", "differs"},
    {"uses_undeclared_slot", "contract/undeclared_slots", "differs"},
    {"reads_uninitialised", "contract/dirty_memory", "differs"},
    {"ok_without_memory", "contract/no_memory", "gives null"},
    {"writes_past_output", "contract/output_bounds", "inlier_mask/"},
    {"error_without_text", "contract/error_text", "without a reason"},
    {"text_not_utf8", "contract/error_text", "no UTF-8"},
    {"filters/test_truthful", "contract/nan_inputs", "where the truth is NaN"},
    {"counts_calls", "calls/repeated", "differs"},
    {"counts_instances", "calls/created_anew", "differs"},
    {"depends_on_frame_order", "calls/shuffled_frames", "differs"},
    {"depends_on_thread", "calls/any_thread", "differs"},
    {"depends_on_threads", "calls/threads", "differs"},
    {"shares_instances", "calls/at_once", "differs"},
    {"crashes_prepared_twice", "calls/prepared_twice", "ended by signal 6"},
    {"crashes_unprepared", "calls/unprepared", "ended by signal 6"},
    {"writes_call", "calls/structs", "it wrote into its weft_call: ended by signal 11"},
    {"writes_host", "calls/structs", "it wrote into the function table of the host: ended by"},
    {"writes_record", "calls/structs", "it wrote into the records of its inputs: ended by"},
    {"writes_array_entry", "calls/structs", "it wrote into the array entries of its inputs: ended"},
    {"swaps_arrays", "calls/structs", "it wrote into the array entries of its inputs: ended by"},
    {"keeps_call", "calls/structs", "after a call had returned it used its weft_call: ended by"},
    {"logs_escape", "calls/log", "the control character 0x1b"},
    {"logs_lines", "calls/log", "the control character 0x0a"},
    {"logs_bad_text", "calls/log", "no UTF-8"},
    {"logs_huge", "calls/log", "more than 4096 bytes"},
    {"logs_often", "calls/log", "more than 100 texts in a call"},
    {"invokes_others", "calls/invocations", "it invokes the handle 1, which it was not given"},
    {"crashes_at_exit", "calls/exit", "the end of the program is ended by signal 11"},
    {"destructor_crashes", "calls/exit", "the end of the program is ended by signal 11"},
    {"hangs_at_exit", "calls/exit", "does not end after its calls"},
    {"prints_at_exit", "calls/exit", "it prints 'a last word' when the program ends"},
    {"changes_exit_code", "calls/exit", "it changes the exit code of the program to 3"},
    {"changes_locale", "limits/locale", "changes it"},
    {"changes_locale_of_streams", "limits/locale", "changes it"},
#if defined(__x86_64__)
    {"flushes_denormals", "limits/floating_point", "process changes it"},
    {"changes_precision", "limits/floating_point", "process changes it"},
    {"load_flushes", "load/floating_point", "-ffast-math"},
#endif
    {"changes_signal_handler", "limits/signals", "changes it"},
    {"changes_folder", "limits/working_directory", "changes it"},
    {"changes_umask", "limits/umask", "changes it"},
    {"changes_environment", "limits/environment", "changes it"},
    {"limits_files", "limits/process", "process changes it, from '1: "},
    {"starts_timer", "limits/process", "to 'timers: armed"},
    {"changes_priority", "limits/process", "to 'priority: nice "},
    {"changes_terminate", "limits/process", "to 'terminate handler"},
    {"changes_umask@load", "limits/umask", "loading changes it"},
    {"changes_umask@create", "limits/umask", "create changes it"},
    {"changes_umask@prepare", "limits/umask", "prepare changes it"},
    {"changes_umask@destroy", "limits/umask", "destroy changes it"},
    {"prints", "limits/silent", "process prints: use weft_host.log"},
    {"uses_global_generator", "limits/generator", "rand()"},
    {"undeclared_seed", "limits/seed", "with another seed"},
    {"leaks_descriptor", "limits/descriptors", "open files behind"},
    {"leaves_thread", "limits/threads", "threads behind"},
    {"returns_twice", "limits/processes", "leaves a process behind"},
    {"leaks_memory", "limits/memory", "MiB, time after time"},
    {"leaks_slowly", "limits/memory", "bytes of the heap"},
    {"needs_much_memory", "limits/large", "16 GiB are not enough"},
    {"deaf", "limits/cancelled", "it goes on for"},
    {"filters/test_bossy", "limits/opencv_threads", "for others"},
};

INSTANTIATE_TEST_SUITE_P(Conformance, BrokenPlugin, ::testing::ValuesIn(kBroken),
                         [](const auto& broken) {
                           std::string name = broken.param.check;
                           if (!broken.param.is_other())
                             name += std::string("_") + broken.param.fault;
                           for (char& c : name) c = c == '/' || c == '@' ? '_' : c;
                           return name;
                         });

TEST(Conformance, HoldsForAFilterThatDoesNothingWrong) {
  const FaultyFolder faulty("");
  for (const char* group : {"load", "table", "contract", "calls"}) {
    const auto report = checked(faulty.path(), kFaulty, "{}", group);
    EXPECT_GT(report.count(Verdict::holds), 2u) << group;
    for (const auto& finding : report.findings) {
      EXPECT_NE(finding.verdict, Verdict::fails) << finding.check << ": " << finding.seen;
      EXPECT_NE(conformance::find_check(finding.check), nullptr) << finding.check;
    }
  }
}

TEST(Conformance, ComparesTheManifestWithWhatTheLibrarySays) {
  const FaultyFolder faulty("");
  const std::string file = faulty.path() + "/filters_test_faulty.plugin.yaml";
  std::string manifest = read_file(file);
  const std::string fallback = "default: 0.5";
  manifest.replace(manifest.find(fallback), fallback.size(), "default: 7");
  write_file(file, manifest);
  const auto of_manifest = checked(faulty.path(), kFaulty, "{}", "load/manifest");
  ASSERT_EQ(of_manifest.findings.size(), 1u);
  EXPECT_THAT(of_manifest.findings[0].seen,
              HasSubstr("differs from the library's own description"));
  const auto of_default = checked(faulty.path(), kFaulty, "{}", "parameters/defaults");
  ASSERT_EQ(of_default.findings.size(), 1u);
  EXPECT_THAT(of_default.findings[0].seen, HasSubstr("default 7 is outside 0 to 1"));
}

TEST(Conformance, ChecksSeveralComponentsAtOnceAndReportsThemInTheirOrder) {
  const FaultyFolder faulty("logs_lines");
  conformance::Asked asked;
  asked.subjects = {kFaulty, "filters/test_truthful", kFaulty};
  asked.plugin_folders = {faulty.path(), kUnruly};
  const auto candidates = conformance::candidates(asked);
  ASSERT_TRUE(candidates);
  std::vector<std::string> reported;
  conformance::check_all(*candidates, {"calls/log", false}, 2, [&](const auto& report) {
    ASSERT_EQ(report.findings.size(), 1u);
    reported.push_back(report.id + " " + to_text(report.findings[0].verdict));
  });
  EXPECT_THAT(reported,
              ::testing::ElementsAre("filters/test_faulty fails", "filters/test_truthful holds",
                                     "filters/test_faulty fails"));
}

TEST(Conformance, ReportsHowManyRepetitionsABudgetLeft) {
  const FaultyFolder faulty("");
  const auto made = [&](double effort) {
    conformance::Asked asked;
    asked.subjects = {kFaulty};
    asked.plugin_folders = {faulty.path()};
    const auto candidates = conformance::candidates(asked);
    if (!candidates) throw std::runtime_error(candidates.error().message);
    return conformance::check(candidates->front(), {"parameters/pairs", false, effort});
  };
  const auto none = made(0.0), all = made(1.0);
  ASSERT_EQ(none.findings.size(), 1u);
  EXPECT_EQ(none.findings[0].seen, "reduced: 0 of 200 pairs");
  EXPECT_TRUE(conformance::is_reduced(none.findings[0]));
  ASSERT_EQ(all.findings.size(), 1u);
  EXPECT_EQ(all.findings[0].seen, "200 pairs");
}

TEST(Conformance, EndsAComponentThatLogsForEver) {
  const FaultyFolder faulty("logs_for_ever");
  conformance::Asked asked;
  asked.subjects = {kFaulty};
  asked.plugin_folders = {faulty.path()};
  const auto candidates = conformance::candidates(asked);
  ASSERT_TRUE(candidates);
  const conformance::Setting setting(candidates->front());
  const auto findings = conformance::check_in_child(
      "calls/log", {"calls/log", false}, std::chrono::seconds(1),
      [&](conformance::Notebook& notebook) { conformance::check_calls(setting, notebook); });
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].seen,
              HasSubstr("it logs more than 100 texts in a call: not done after 1 s"));
}

TEST(Conformance, NamesTheCheckThatACrashOrAnExitEnds) {
  const auto spoilt =
      checked(WEFT_DEADLY_FOLDER, "filters/test_deadly", "{deed: spoil}", "contract");
  ASSERT_FALSE(spoilt.findings.empty());
  EXPECT_EQ(spoilt.findings.back().check, "contract/with_a_usual_input");
  EXPECT_THAT(spoilt.findings.back().seen,
              HasSubstr("it wrote into its input correspondences/kept: ended by signal 11"));
  const auto left = checked(WEFT_DEADLY_FOLDER, "filters/test_leaving", "{}", "contract");
  ASSERT_FALSE(left.findings.empty());
  EXPECT_EQ(left.findings.back().check, "contract/its_parameters");
  EXPECT_THAT(left.findings.back().seen, HasSubstr("it ended its process with exit code 0"));
}

TEST(Conformance, TellsALibraryThatCannotBeLoaded) {
  const auto report = checked(kFolder, "filters/test_needs_missing", "{}", "load");
  ASSERT_FALSE(report.findings.empty());
  EXPECT_TRUE(report.fails());
}

TEST(Conformance, TakesADeviationThatIsSaidAndRefusesOneThatDoesNotOccur) {
  conformance::Asked asked;
  asked.subjects = {"filters/test_wrong_output"};
  asked.plugin_folders = {kFolder};
  const auto candidates = conformance::candidates(asked);
  ASSERT_TRUE(candidates);
  conformance::Candidate candidate = candidates->front();
  candidate.deviations = {"with matches that were rejected before", "with 1 match"};
  const auto report = conformance::check(candidate, {"contract", true});
  const auto verdict_of = [&](const std::string& check) {
    for (const auto& finding : report.findings) {
      if (finding.check == check) return finding.verdict;
    }
    return Verdict::does_not_apply;
  };
  EXPECT_EQ(verdict_of("contract/with_matches_that_were_rejected_before"), Verdict::deviates);
  EXPECT_EQ(verdict_of("contract/with_1_match"), Verdict::fails);
}

/// Proved by a plugin that breaks it, or why it is not.
TEST(Conformance, HasABrokenPluginForEachCheckOfItsOwn) {
  std::set<std::string> proved = {"load/manifest", "parameters/defaults", "load/binds_now"};
  for (const Broken& broken : kBroken) proved.insert(broken.check);
  const std::set<std::string> unproved = {
      "load/layout",     // damaged tables are refused before
      "load/processor",  // libraries for other processors are refused before
      "load/strip",      // the linker writes no build-id that strip removes
      "calls/sanitized", "calls/state", "limits/clock",  // never apply
      "limits/isolated",  // proved by ProgramFindsWhatDiffersInAWorker
  };
  for (const auto& info : conformance::all_checks()) {
    // See contract_test.cpp, and geometry_test.cpp of the flawed ones.
    const bool of_role =
        (info.name.starts_with("contract/") && info.brief) || info.name.starts_with("geometry/");
    EXPECT_TRUE(of_role || proved.count(info.name) + unproved.count(info.name) == 1) << info.name;
  }
}

}  // namespace
}  // namespace weft::misbehaving
