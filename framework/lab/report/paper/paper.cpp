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

Result<void> write_figures(const std::vector<PanelFigure>& figures, const std::string& folder,
                           const std::string& origin, PaperFiles& files) {
  for (const PanelFigure& figure : figures) {
    const Drawing drawing = figure.drawing();
    const std::string file = folder + "/" + drawing.name;
    files.figures = true;
    if (auto done = write_whole(to_pgf(drawing, origin), file + ".pgf"); !done) return done;
    if (auto done = write_whole(to_svg_file(drawing, origin), file + ".svg"); !done) return done;
    files.files.insert(files.files.end(), {file + ".pgf", file + ".svg"});
    auto pdf = write_pdf(file + ".svg");
    if (!pdf) return pdf.error();
    files.pdf = pdf->has_value();
    if (files.pdf) files.files.push_back(**std::move(pdf));
  }
  return {};
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
  for (const ComparisonResult& comparison : tables->comparisons) {
    const TextTable matrix = matrix_sheet(comparison);
    if (matrix.rows.empty()) continue;
    if (auto written = write(matrix.id + ".tex", to_latex(matrix, origin)); !written) {
      return written.error();
    }
  }
  const auto figures = panel_figures(*results, *tables);
  if (auto done = write_figures(figures, folder + "/paper", origin, paper); !done) {
    return done.error();
  }
  return paper;
}

}  // namespace weft::lab
