// SPDX-License-Identifier: Apache-2.0
#include "lab/report/report.hpp"

#include <weft/core/whole_file.hpp>

#include "lab/report/notes.hpp"
#include "lab/report/page.hpp"
#include "lab/report/sheets.hpp"
#include "lab/report/text/table_files.hpp"

namespace weft::lab {
namespace {

/// A text in code marks that are longer than any mark in it.
std::string markdown_code(const std::string& text) {
  std::string mark = "`";
  while (text.find(mark) != std::string::npos) mark += '`';
  const std::string space = mark.size() > 1 ? " " : "";
  return mark + space + text + space + mark;
}

/// The text before the tables: the plan and a summary of the results.
std::string markdown_head(const Results& results, const ReportTables& tables) {
  std::string text = "# " + markdown_escaped(results.plan.name) + "\n\nMade by Weft " +
                     markdown_escaped(results.version) + " with " +
                     markdown_code(results.plan.command) + ".\n\n";
  for (const auto& [name, value] : facts_of(results, tables)) {
    text += "- " + markdown_escaped(name) + ": " + markdown_escaped(value) + "\n";
  }
  text += "\n";
  for (const std::string& notice : notices_of(results, tables)) {
    text += "> " + markdown_escaped(notice) + "\n\n";
  }
  for (const Verdict& verdict : verdicts_of(tables)) {
    text += "- " + (verdict.about.empty() ? "" : "**" + markdown_escaped(verdict.about) + "** ") +
            markdown_escaped(verdict.text) + "\n";
    for (const auto* list : {&verdict.unlike, &verdict.like}) {
      for (const std::string& separate : *list) text += "  - " + markdown_escaped(separate) + "\n";
    }
  }
  return text + "\n";
}

}  // namespace

Result<ReportFiles> write_report(const std::string& folder, const ReportOptions& options) {
  const auto assets = read_assets(options.assets);
  if (!assets) return assets.error();
  const auto results = read_results(folder);
  if (!results) return results.error();
  const auto tables = make_tables(*results);
  if (!tables) return tables.error();
  const auto figures = make_figures(*results, *tables);
  if (!figures) return figures.error();
  auto files = write_table_files(folder + "/report", markdown_head(*results, *tables),
                                 all_sheets(*results, *tables));
  if (!files) return files.error();
  const std::string page = options.page.empty() ? folder + "/report.html" : options.page;
  const Page content = page_of(*results, *tables, *figures, assets->scripted());
  if (auto written = write_whole(page_html(content, *assets), page); !written) {
    return written.error();
  }
  return ReportFiles{page, *std::move(files), assets->scripted()};
}

}  // namespace weft::lab
