// SPDX-License-Identifier: Apache-2.0
#include "report/runs/run_report.hpp"

#include <filesystem>
#include <weft/core/whole_file.hpp>

#include "report/runs/run_page.hpp"

namespace weft::evaluation {
namespace {

namespace fs = std::filesystem;

Result<std::vector<std::string>> write_tables(const RunData& run) {
  const std::string folder = run.folder + "/report";
  std::error_code code;
  fs::create_directories(folder, code);
  std::vector<std::string> files;
  std::string markdown = "# " + markdown_escaped(run.metrics.run) + "\n\n";
  for (const std::string& sentence : sentences_of(run)) {
    markdown += "- " + markdown_escaped(sentence) + "\n";
  }
  markdown += "\n";
  for (const TextTable& sheet : {reasons_sheet(run), stages_sheet(run), frames_sheet(run)}) {
    if (sheet.rows.empty()) continue;
    files.push_back(folder + "/" + sheet.id + ".csv");
    if (auto written = write_whole(to_csv(sheet), files.back()); !written) return written.error();
    markdown += to_markdown(sheet);
  }
  files.push_back(folder + "/tables.md");
  if (auto written = write_whole(markdown, files.back()); !written) return written.error();
  return files;
}

}  // namespace

bool is_run_folder(const std::string& folder) {
  std::error_code code;
  return fs::exists(folder + "/frames.jsonl", code);
}

Result<ReportFiles> write_run_report(const std::string& folder, const ReportOptions& options) {
  const auto assets = read_assets(options.assets);
  if (!assets) return assets.error();
  const auto run = read_run_data(folder);
  if (!run) return run.error();
  auto files = write_tables(*run);
  if (!files) return files.error();
  const std::string file = options.page.empty() ? folder + "/report.html" : options.page;
  const Page page = page_of(*run, assets->scripted());
  if (auto written = write_whole(page_html(page, *assets), file); !written) return written.error();
  return ReportFiles{file, *std::move(files), assets->scripted()};
}

}  // namespace weft::evaluation
