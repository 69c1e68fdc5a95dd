// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <weft/core/text_file.hpp>

#include "cli/commands.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/program_root.hpp"
#include "cli/standard_components.hpp"
#include "lab/report/pairs/pair_report.hpp"
#include "lab/report/paper/paper.hpp"
#include "lab/report/report.hpp"
#include "lab/report/runs/run_report.hpp"

namespace weft::cli {
namespace {

/// Fails where a folder is neither of a run nor of an ablation.
Result<void> check_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (auto found =
          check_input(folder, InputKind::folder, "give one that `weft run` or `weft ablate` wrote");
      !found) {
    return found.error();
  }
  if (lab::is_run_folder(folder)) return {};
  if (!fs::exists(folder + "/plan.json", code) && !fs::exists(folder + "/results", code)) {
    return Error{
        Errc::not_found,
        "is neither the folder of a run (it has no frames.jsonl) nor of an ablation (it has "
        "no plan.json); give one that `weft run` or `weft ablate` wrote",
        folder};
  }
  return {};
}

/// Writes the report of a run or of an ablation, depending on the folder, or compares two.
Result<lab::ReportFiles> write_report_of(const std::string& folder, const std::string& other,
                                         const lab::ReportOptions& options) {
  if (auto known = check_folder(folder); !known) return known.error();
  if (!other.empty()) {
    if (auto known = check_folder(other); !known) return known.error();
    return lab::write_pair_report(folder, other, options);
  }
  return lab::is_run_folder(folder) ? lab::write_run_report(folder, options)
                                    : lab::write_report(folder, options);
}

void print_paper(const std::string& folder, Context& context) {
  const auto paper =
      lab::is_run_folder(folder)
          ? Result<lab::PaperFiles>(
                Error{Errc::invalid_value,
                      "--paper needs the folder of an ablation; this is a run folder", folder})
          : lab::write_paper(folder);
  if (!paper) {
    print_error(paper.error());
    context.exit_code = kInputOutput;
    return;
  }
  for (const std::string& file : paper->files) fmt::print("{}\n", file);
  if (paper->figures && !paper->pdf) {
    fmt::print("(no PDF: figures are also written as PDF where librsvg2-bin is installed)\n");
  }
}

bool is_same(const std::string& a, const std::string& b) {
  std::error_code code;
  return std::filesystem::equivalent(a, b, code);
}

}  // namespace

void add_report_command(CLI::App& app, Context& context) {
  struct Options {
    std::string folder, other;
    std::string page;
    bool overwrite = false, paper = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "report",
      "Write one page with the tables, figures and shapes of a run or an ablation, or compare two");
  command->add_option("DIR", options->folder, "Folder that `weft run` or `weft ablate` wrote")
      ->required();
  CLI::Option* other = command->add_option("OTHER", options->other,
                                           "A second run or ablation that DIR is compared with");
  command->add_option("--out", options->page,
                      "The page (default: DIR/report.html, of two DIR/with_OTHER.html)");
  add_overwrite(*command, options->overwrite);
  command
      ->add_flag("--paper", options->paper,
                 "Write tables for LaTeX and figures as SVG, PGF (and PDF) instead, to DIR/paper")
      ->excludes(other);
  command->callback([&context, options] {
    if (options->paper) return print_paper(options->folder, context);
    const std::string own = options->folder + "/report.html";
    if (!options->page.empty() && !is_same(options->page, own)) {
      if (auto fresh = check_new_file(options->page, options->overwrite); !fresh) {
        print_error(fresh.error());
        context.exit_code = kInputOutput;
        return;
      }
    }
    const auto files = write_report_of(
        options->folder, options->other,
        {options->page, (program_root() / "share/weft/report").string(), unwarping_sink()});
    if (!files) {
      print_error(files.error());
      context.exit_code =
          files.error().code == Errc::incompatible ? kBadConfiguration : kInputOutput;
      return;
    }
    fmt::print("{}{}\n", files->page,
               files->figures ? "" : "  (tables only: the figures need npm, see the page)");
    for (const std::string& file : files->tables) fmt::print("{}\n", file);
  });
}

}  // namespace weft::cli
