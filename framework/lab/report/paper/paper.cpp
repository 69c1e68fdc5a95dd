// SPDX-License-Identifier: Apache-2.0
#include "lab/report/paper/paper.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <weft/core/whole_file.hpp>

#include "lab/report/paper/pdf.hpp"
#include "lab/report/sheets.hpp"
#include "lab/report/text/latex.hpp"

namespace weft::lab {

std::string origin_of(const Results& results) {
  const PlanRecord& plan = results.plan;
  return fmt::format(
      "{}: Weft {}, {}\nsequences (name and data seed): {}\nrun seeds: {}; data for: {}; "
      "alignment: {}\n",
      plan.name, results.version, plan.command, fmt::join(plan.sequences, ", "),
      fmt::join(plan.seeds, ", "), plan.data_use.empty() ? "not stated in the plan" : plan.data_use,
      results.alignment);
}

Result<PaperFiles> write_paper(const std::string& folder) {
  const auto results = read_results(folder);
  if (!results) return results.error();
  const auto tables = make_tables(*results);
  if (!tables) return tables.error();
  std::error_code code;
  std::filesystem::create_directories(folder + "/paper", code);
  const std::string origin = origin_of(*results);
  PaperFiles paper;
  const auto write = [&](const std::string& name, const std::string& text) {
    paper.files.push_back(folder + "/paper/" + name);
    return write_whole(text, paper.files.back());
  };
  for (const TextTable& sheet : all_sheets(*results, *tables)) {
    if (sheet.id == "cells") continue;
    if (auto written = write(sheet.id + ".tex", to_latex(sheet, origin)); !written) {
      return written.error();
    }
  }
  const std::string errors = error_figure(*results, *tables);
  const std::string figure = errors.empty() ? filter_figure(*results, *tables) : errors;
  paper.figures = !figure.empty();
  if (!paper.figures) return paper;
  const char* name = errors.empty() ? "filters.svg" : "errors.svg";
  if (auto written = write(name, figure); !written) return written.error();
  auto pdf = write_pdf(paper.files.back());
  if (!pdf) return pdf.error();
  paper.pdf = pdf->has_value();
  if (paper.pdf) paper.files.push_back(**std::move(pdf));
  return paper;
}

}  // namespace weft::lab
