// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/run_report.hpp"

#include <filesystem>
#include <weft/core/whole_file.hpp>

#include "lab/report/runs/run_page.hpp"
#include "lab/report/text/table_files.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

Result<std::vector<std::string>> write_tables(const RunData& run) {
  std::string head = "# " + markdown_escaped(run.metrics.run) + "\n\n";
  for (const std::string& sentence : sentences_of(run)) {
    head += "- " + markdown_escaped(sentence) + "\n";
  }
  std::vector<TextTable> sheets{reasons_sheet(run), stages_sheet(run), frames_sheet(run)};
  std::erase_if(sheets, [](const TextTable& sheet) { return sheet.rows.empty(); });
  return write_table_files(run.folder + "/report", head + "\n", std::move(sheets));
}

}  // namespace

bool is_run_folder(const std::string& folder) {
  std::error_code code;
  return fs::exists(folder + "/frames.jsonl", code);
}

Result<ReportFiles> write_run_report(const std::string& folder, const ReportOptions& options) {
  const auto assets = read_assets(options.assets);
  if (!assets) return assets.error();
  const auto run = read_run_data(folder, options.unwarping_sink);
  if (!run) return run.error();
  auto files = write_tables(*run);
  if (!files) return files.error();
  const std::string file = options.page.empty() ? folder + "/report.html" : options.page;
  const Page page = page_of(*run, assets->scripted());
  if (auto written = write_whole(page_html(page, *assets), file); !written) return written.error();
  return ReportFiles{file, *std::move(files), assets->scripted()};
}

}  // namespace weft::lab
