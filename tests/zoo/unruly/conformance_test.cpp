// SPDX-License-Identifier: Apache-2.0
// Each check of `weft plugins check` must fail for a plugin that breaks its rule, and hold for one
// that does nothing wrong.
#include "conformance/conformance.hpp"

#include <gmock/gmock.h>

#include <set>

#include "../zoo.hpp"
#include "conformance/check_list.hpp"

namespace weft::zoo {
namespace {

using conformance::Verdict;
using ::testing::HasSubstr;

const std::string kUnruly = WEFT_UNRULY_FOLDER;

conformance::Report checked(const std::string& file, const std::string& id,
                            const std::string& params, const std::string& only) {
  conformance::Asked asked;
  asked.subjects = {id};
  asked.params = params;
  asked.plugin_folders = {file.empty() ? kUnruly : file};
  const auto candidates = conformance::candidates(asked);
  if (!candidates) throw std::runtime_error(candidates.error().message);
  return conformance::check(candidates->front(), {only, false});
}

struct Broken {
  const char *id, *params, *check, *seen;
};

std::string unruly(const std::string& misdeed) { return "{misdeed: " + misdeed + "}"; }

class BrokenPlugin : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenPlugin, FailsTheCheckOfTheRuleThatItBreaks) {
  const Broken& broken = GetParam();
  const std::string params =
      broken.params[0] == '{' ? std::string(broken.params) : unruly(broken.params);
  const auto report = checked("", broken.id, params, broken.check);
  ASSERT_EQ(report.findings.size(), 1u) << broken.check;
  EXPECT_EQ(report.findings[0].check, broken.check);
  EXPECT_EQ(report.findings[0].verdict, Verdict::fails) << report.findings[0].seen;
  EXPECT_THAT(report.findings[0].seen, HasSubstr(broken.seen));
}

constexpr const char* kUnrulyId = "filters/zoo_unruly";
constexpr const char* kLaxId = "filters/zoo_lax";
constexpr const char* kLoudId = "filters/zoo_loud";

const Broken kBroken[] = {
    {kLoudId, "{}", "load/symbol", "zoo_loud_counter"},
    {kLoudId, "{}", "load/static_tls", "DF_STATIC_TLS"},
    {kLoudId, "{}", "load/time", "when it is first needed"},
    {kLoudId, "{}", "load/silent", "prints"},
    {kLoudId, "{}", "load/threads", "starts a thread"},
    {kLoudId, "{}", "load/opens_nothing", "/etc/passwd"},
    {kLaxId, "{}", "table/methods", "its role does not have"},
    {"filters/zoo_changing", "{}", "table/unknown_extension", "weft.there_is_no_such/1"},
    {"filters/zoo_changing", "{}", "table/extensions_stable", "another table each time"},
    {kUnrulyId, "knows_all_methods", "table/unknown_method", "status 0"},
    {kUnrulyId, "reads_on", "table/older_host", "ended by signal 11"},
    {kUnrulyId, "knows_newer_host", "table/newer_host", "differs"},
    {kLaxId, "{}", "parameters/beyond", "share = nan is accepted"},
    {kLaxId, "{}", "parameters/wrong_type", "share = a text is accepted"},
    {kLaxId, "{}", "parameters/unknown", "what is that"},
    {kUnrulyId, "{}", "parameters/ends", "ended by signal 6"},
    {kUnrulyId, "{}", "parameters/pairs", "ended by signal 6"},
    {kUnrulyId, "{first: 1}", "parameters/live", "first set between two frames"},
    {kUnrulyId, "pads_nothing", "contract/padded_inputs", "differs"},
    {kUnrulyId, "runs_forward", "contract/backward_inputs", "differs"},
    {kUnrulyId, "wants_alignment", "contract/aligned_inputs", "differs"},
    {kUnrulyId, "counts_arrays", "contract/unknown_arrays", "differs"},
    {kUnrulyId, "counts_slots", "contract/undeclared_slots", "differs"},
    {kUnrulyId, "reads_memory", "contract/dirty_memory", "differs"},
    {kUnrulyId, "ignores_null", "contract/no_memory", "gives null"},
    {kUnrulyId, "ends_behind", "contract/output_bounds", "inlier_mask/diag.more"},
    {kUnrulyId, "silent_error", "contract/error_text", "says not why"},
    {kUnrulyId, "latin_error", "contract/error_text", "no UTF-8"},
    {"filters/zoo_truthful", "{}", "contract/nan_inputs", "where the truth is NaN"},
    {kUnrulyId, "counts_calls", "calls/repeated", "differs"},
    {kUnrulyId, "counts_instances", "calls/created_anew", "differs"},
    {kUnrulyId, "remembers_frame", "calls/shuffled_frames", "differs"},
    {kUnrulyId, "remembers_thread", "calls/any_thread", "differs"},
    {kUnrulyId, "uses_threads", "calls/threads", "differs"},
    {kUnrulyId, "shares", "calls/at_once", "differs"},
    {kUnrulyId, "counts_prepares", "calls/prepared_twice", "differs"},
    {kUnrulyId, "needs_prepare", "calls/unprepared", "ended by signal 6"},
    {kUnrulyId, "locale", "limits/locale", "changes it"},
#if defined(__x86_64__)
    {kUnrulyId, "rounding", "limits/floating_point", "process changes it"},
    {kLoudId, "{}", "load/floating_point", "-ffast-math"},
#endif
    {kUnrulyId, "signals", "limits/signals", "changes it"},
    {kUnrulyId, "folder", "limits/working_directory", "changes it"},
    {kUnrulyId, "umask", "limits/umask", "changes it"},
    {kUnrulyId, "environment", "limits/environment", "changes it"},
    {kUnrulyId, "generator", "limits/generator", "rand()"},
    {kUnrulyId, "seed", "limits/seed", "with another seed"},
    {kUnrulyId, "files", "limits/descriptors", "open files behind"},
    {kUnrulyId, "threads", "limits/threads", "threads behind"},
    {kUnrulyId, "memory", "limits/memory", "MiB, time after time"},
    {kUnrulyId, "slow_memory", "limits/memory", "bytes of the heap"},
    {kUnrulyId, "hunger", "limits/large", "16 GiB are not enough"},
    {kUnrulyId, "deaf", "limits/cancelled", "it goes on for"},
    {"filters/zoo_bossy", "{}", "limits/opencv_threads", "for others"},
};

INSTANTIATE_TEST_SUITE_P(Conformance, BrokenPlugin, ::testing::ValuesIn(kBroken),
                         [](const auto& broken) {
                           std::string name =
                               std::string(broken.param.check) + "_" +
                               (broken.param.params[0] == '{' ? "" : broken.param.params);
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

TEST(Conformance, HoldsForAFilterThatDoesNothingWrong) {
  conformance::Asked asked;
  asked.subjects = {kUnrulyId};
  asked.plugin_folders = {kUnruly};
  const auto candidates = conformance::candidates(asked);
  ASSERT_TRUE(candidates);
  for (const char* group : {"load", "table", "contract", "calls"}) {
    const auto report = conformance::check(candidates->front(), {group, false});
    EXPECT_GT(report.count(Verdict::holds), 2u) << group;
    for (const auto& finding : report.findings) {
      EXPECT_NE(finding.verdict, Verdict::fails) << finding.check << ": " << finding.seen;
      EXPECT_NE(conformance::find_check(finding.check), nullptr) << finding.check;
    }
  }
}

TEST(Conformance, ComparesTheManifestWithWhatTheLibrarySays) {
  const TemporaryFolder folder;
  for (const char* ending : {".so", ".plugin.yaml"}) {
    const std::string name = std::string("filters_zoo_unruly") + ending;
    fs::copy_file(kUnruly + "/" + name, folder.path() / name);
  }
  std::string manifest = read_file(folder / "filters_zoo_unruly.plugin.yaml");
  manifest.replace(manifest.find("default: 0"), 10, "default: 7");
  write_file(folder / "filters_zoo_unruly.plugin.yaml", manifest);
  const auto of_manifest = checked(folder.path().string(), kUnrulyId, "{}", "load/manifest");
  ASSERT_EQ(of_manifest.findings.size(), 1u);
  EXPECT_THAT(of_manifest.findings[0].seen, HasSubstr("not what the library says"));
  const auto of_default = checked(folder.path().string(), kUnrulyId, "{}", "parameters/defaults");
  ASSERT_EQ(of_default.findings.size(), 1u);
  EXPECT_THAT(of_default.findings[0].seen, HasSubstr("default 7 is outside 0 to 1"));
}

TEST(Conformance, NamesTheCheckThatACrashOrAnExitEnds) {
  const auto spoilt =
      checked(WEFT_DEADLY_FOLDER, "filters/zoo_deadly", "{deed: spoil}", "contract");
  ASSERT_FALSE(spoilt.findings.empty());
  EXPECT_EQ(spoilt.findings.back().check, "contract/with_a_usual_input");
  EXPECT_THAT(spoilt.findings.back().seen,
              HasSubstr("it wrote into its input correspondences/kept: ended by signal 11"));
  const auto left = checked(WEFT_DEADLY_FOLDER, "filters/zoo_leaving", "{}", "contract");
  ASSERT_FALSE(left.findings.empty());
  EXPECT_EQ(left.findings.back().check, "contract/its_parameters");
  EXPECT_THAT(left.findings.back().seen, HasSubstr("it ended its process with exit code 0"));
}

TEST(Conformance, TellsALibraryThatCannotBeLoaded) {
  const auto report = checked(kFolder, "filters/zoo_needs_missing", "{}", "load");
  ASSERT_FALSE(report.findings.empty());
  EXPECT_TRUE(report.fails());
}

TEST(Conformance, TakesADeviationThatIsSaidAndRefusesOneThatDoesNotOccur) {
  conformance::Asked asked;
  asked.subjects = {"filters/zoo_wrong_output"};
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
      "load/layout",     // what has a damaged table is refused before
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
}  // namespace weft::zoo
