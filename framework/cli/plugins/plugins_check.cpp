// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugins_check.hpp"

#include <fmt/core.h>
#include <sched.h>

#include <algorithm>
#include <memory>
#include <weft/core/whole_file.hpp>

#include "cli/output/json_text.hpp"
#include "cli/plugins/check_report.hpp"

namespace weft::cli {
namespace {

constexpr int kContractBroken = 1;
constexpr double kEffortForAll = 0.05;  ///< share of the calls that checks repeat

struct CheckOptions {
  conformance::Asked asked;
  conformance::Choice choice;
  std::string junit;
  int jobs = 0;  ///< 0: one per available processor
  bool full = false, json = false, verbose = false, list = false;
};

int available_processors() {
  cpu_set_t set;
  const bool is_known = sched_getaffinity(0, sizeof(set), &set) == 0;
  return is_known ? std::max(CPU_COUNT(&set), 1) : 1;
}

std::vector<conformance::Report> made(const std::vector<conformance::Candidate>& candidates,
                                      const CheckOptions& options) {
  std::vector<conformance::Report> reports;
  const int jobs = options.jobs > 0 ? options.jobs : available_processors();
  conformance::check_all(candidates, options.choice, jobs, [&](const conformance::Report& report) {
    reports.push_back(report);
    if (!options.json) print_report(report, options.verbose);
  });
  return reports;
}

void check_plugins(CheckOptions options, Context& context) {
  const auto refuse = [&](const Error& error, int code) {
    print_error(error);
    context.exit_code = code;
  };
  if (options.list) return print_check_list();
  if (options.asked.subjects.empty() != options.asked.all) {
    return refuse(
        {Errc::invalid_value, "name what to check, or give --all for what is installed", {}},
        kBadConfiguration);
  }
  const std::string& only = options.choice.only;
  if (!only.empty() && !conformance::is_known(only)) {
    return refuse({Errc::invalid_value,
                   "there is no group or check '" + only + "'; --list prints all of them",
                   {}},
                  kBadConfiguration);
  }
  options.asked.plugin_folders = context.plugin_path;
  if (options.asked.all && !options.full) options.choice.effort = kEffortForAll;
  const auto candidates = conformance::candidates(options.asked);
  if (!candidates) {
    const bool is_file = candidates.error().code == Errc::io;
    return refuse(candidates.error(), is_file ? kInputOutput : kBadConfiguration);
  }
  if (!options.json) fmt::print("seed {}\n", options.asked.seed);
  const auto reports = made(*candidates, options);
  if (options.json) {
    print_json(report_json(reports, options.asked.seed));
  } else {
    print_summary(reports);
  }
  for (const conformance::Report& report : reports) {
    if (report.fails()) context.exit_code = kContractBroken;
  }
  if (options.junit.empty()) return;
  if (auto written = write_whole(report_junit(reports), options.junit); !written) {
    refuse(written.error(), kInputOutput);
  }
}

}  // namespace

void add_check_of_plugins(CLI::App& plugins, Context& context) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = plugins.add_subcommand(
      "check", "Hold plugins to the binary contract and to that of their role");
  command->footer(
      "Exit codes:\n"
      "  0  all executed checks pass\n"
      "  1  one fails\n"
      "  2  the arguments are wrong, or there is no such plugin\n"
      "  3  a file cannot be read or written");
  command
      ->add_option("ID_OR_FILE", options->asked.subjects,
                   "Ids (role/name), libraries (.so) or manifests")
      ->type_name("");
  command->add_flag("--all", options->asked.all, "Every installed plugin");
  command->add_flag(
      "--full", options->full,
      "With --all, also make all repetitions; --all reduces some checks to a twentieth");
  command->add_option("--jobs", options->jobs, "Components at once; by default one per CPU core")
      ->check(CLI::PositiveNumber)
      ->option_text("N");
  command->add_flag("--brief", options->choice.brief, "What takes a second or two");
  command
      ->add_option("--only", options->choice.only,
                   "One group or check, such as limits or "
                   "limits/memory")
      ->option_text("GROUP_OR_CHECK");
  command
      ->add_option("--params", options->asked.params,
                   "Parameters of the one component that is checked, as YAML: \"{name: value}\"")
      ->option_text("PARAMS");
  command->add_option("--replay", options->asked.seed, "Draw as the run that printed this seed did")
      ->option_text("SEED");
  command->add_flag("-v,--verbose", options->verbose, "A line for each check");
  command->add_flag("--json", options->json,
                    "Print JSON: {seed, components: [{id, library, fails, skipped, checks: [{name, "
                    "outcome, seen}]}]}; outcome is holds, fails, deviates or does not apply");
  command->add_option("--junit", options->junit, "Also write JUnit's XML")->option_text("FILE");
  command->add_flag("--list", options->list, "Print all checks as a table; check nothing");
  command->callback([&context, options] { check_plugins(*options, context); });
}

}  // namespace weft::cli
