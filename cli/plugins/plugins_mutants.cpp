// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugins_mutants.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>

#include "cli/output/program_root.hpp"
#include "cli/output/scratch_folder.hpp"
#include "mutants/trial.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kTooFewCaught = 1;
constexpr std::chrono::seconds kLongest{1200};  ///< more than a group may take

std::vector<std::string> check_words(const std::string& manifest, std::string_view group) {
  const std::string program = program_root() / "bin/weft";
  return {program, "plugins", "check", "--only", std::string(group), manifest};
}

}  // namespace

void check_mutants(const MutantOptions& options, Context& context) {
  const auto refuse = [&](const Error& error, int code) {
    print_error(error);
    context.exit_code = code;
  };
  const std::string folder = context.plugin_path.empty()
                                 ? (program_root() / "lib/weft/plugins").string()
                                 : context.plugin_path.front();
  const auto originals = mutants::originals_in(folder, options.ids);
  if (!originals) return refuse(originals.error(), kBadConfiguration);
  const std::string library = program_root() / "lib/weft/mutant.so";
  if (std::error_code code; !fs::exists(library, code)) {
    return refuse({Errc::not_found,
                   "is missing; it comes with the package weft-dev, or the component dev of "
                   "`cmake --install`",
                   library},
                  kInputOutput);
  }
  fmt::print("seed {}, {} plugins\n", options.seed, originals->size());
  const mutants::Drawn drawn = mutants::draw(*originals, options.seed, options.count);
  for (const mutants::Operator* unused : drawn.unused) {
    fmt::print("{}: applies to none of the plugins\n", unused->name);
  }
  const auto told = [](const mutants::Trial& trial) {
    fmt::print("{}: {}, {}\n", trial.mutant.name(), trial.verdict.is_caught ? "caught" : "SURVIVED",
               trial.verdict.why);
    std::fflush(stdout);
  };
  const auto scratch = ScratchFolder::make("weft-mutants");
  if (!scratch) return refuse(scratch.error(), kInputOutput);
  const auto trials = mutants::try_mutants(drawn.mutants, library, scratch->path(),
                                           {check_words, kLongest, options.jobs}, told);
  if (!trials) return refuse(trials.error(), kInputOutput);
  for (const std::string& wrong : trials->wrong) fmt::print("original {}\n", wrong);
  fmt::print("\n{}\n{}\n{} of {} mutants are caught\n", mutants::table_of(*trials),
             mutants::table_of_groups(*trials), trials->caught(), trials->trials.size());
  if (!trials->is_enough()) context.exit_code = kTooFewCaught;
}

}  // namespace weft::cli
