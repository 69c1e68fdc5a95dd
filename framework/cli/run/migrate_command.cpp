// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <weft/core/whole_file.hpp>

#include "cli/commands.hpp"
#include "cli/output/report_text.hpp"
#include "cli/standard_components.hpp"
#include "lab/ablation/plan/plan.hpp"
#include "yaml/replace.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

struct MigrateOptions {
  std::vector<std::string> files;
  bool check = false;
  bool to_stdout = false;
};

/// The former names that a file itself uses, without those of files that it extends.
std::pair<std::vector<host::FormerName>, ConfigReport> former_names_in(
    const std::string& file, const host::Registry& registry) {
  if (lab::is_plan(file)) return lab::former_names_in_plan(file, registry, standard_helpers());
  auto document = read_base(file, registry, host::PathRules::of_process({}, {}));
  std::vector<host::FormerName> found = std::move(document.former_names);
  std::erase_if(found, [](const host::FormerName& each) { return each.at.source != 0; });
  ConfigReport report{std::move(document.sources), std::move(document.problems), true, {}};
  report.sort();
  return {std::move(found), std::move(report)};
}

/// Writes through links and keeps the permissions.
Result<void> rewrite(const std::string& file, const std::string& text) {
  std::error_code code;
  const fs::path target = fs::canonical(file, code);
  if (code) return Error{Errc::io, code.message(), file};
  const fs::perms permissions = fs::status(target, code).permissions();
  auto written = write_whole(text, target);
  if (written && !code) fs::permissions(target, permissions, code);
  return written;
}

void migrate_file(const std::string& file, const MigrateOptions& options,
                  const host::Registry& registry, Context& context) {
  const auto fail = [&](const Error& error, int exit_code) {
    print_error(error);
    context.exit_code = exit_code;
  };
  auto [found, report] = former_names_in(file, registry);
  std::erase_if(found, [](const host::FormerName& each) { return each.after.empty(); });
  if (!report.ok()) {
    print_report(report);
    context.exit_code = kBadConfiguration;
    return;
  }
  const auto text = yaml::read_text(file);
  if (!text) return fail(text.error(), kInputOutput);
  std::vector<yaml::Replacement> replacements;
  for (const host::FormerName& each : found) {
    const yaml::Replacement next{each.at, each.before, each.after};
    if (std::find(replacements.begin(), replacements.end(), next) != replacements.end()) continue;
    replacements.push_back(next);
    fmt::print(options.to_stdout ? stderr : stdout, "{}: {} -> {} ({})\n",
               place_in(report.sources, each.at), each.before, each.after, each.what);
  }
  const auto changed = yaml::replaced(*text, std::move(replacements));
  if (!changed) {
    return fail({changed.error().code, changed.error().message, file + ":" + changed.error().where},
                kBadConfiguration);
  }
  if (options.to_stdout) fmt::print("{}", *changed);
  if (found.empty()) {
    if (!options.to_stdout) fmt::print("{}: up to date\n", file);
    return;
  }
  if (options.check) context.exit_code = std::max(context.exit_code, kDifferent);
  if (options.check || options.to_stdout) return;
  if (auto written = rewrite(file, *changed); !written) fail(written.error(), kInputOutput);
}

}  // namespace

void add_migrate_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<MigrateOptions>();
  CLI::App* command = app.add_subcommand(
      "migrate", "Replace deprecated names in pipelines and ablation plans by the current ones");
  command->add_option("FILE", options->files, "Pipelines, plans and cameras (YAML)")
      ->type_name("")
      ->required();
  auto* check = command->add_flag("--check", options->check,
                                  "Print the changes and write nothing; exit code 1 if any");
  command
      ->add_flag("--stdout", options->to_stdout,
                 "Print the changed text of the files instead of writing them")
      ->excludes(check);
  command->footer(
      "Comments and layout stay as they are. Names in components that are not installed are not\n"
      "changed.\n"
      "Exit codes:\n"
      "  0  the files have current names\n"
      "  1  --check: a file has a deprecated name\n"
      "  2  the command line or a file is wrong\n"
      "  3  a file cannot be read or written");
  command->callback([&context, options] {
    const host::Registry registry = context.registry();
    for (const std::string& file : options->files) migrate_file(file, *options, registry, context);
  });
}

}  // namespace weft::cli
