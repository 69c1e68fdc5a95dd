// SPDX-License-Identifier: Apache-2.0
#include "lab/report/pairs/pair_report.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <weft/core/whole_file.hpp>

#include "lab/report/pairs/pair_content.hpp"
#include "lab/report/paper/paper.hpp"
#include "lab/report/runs/run_report.hpp"
#include "lab/report/text/table_files.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

/// For the script of the page, which has nothing to draw in it.
constexpr const char* kNoData =
    R"({"treatments": [], "sweeps": [], "scores": [], "cells": [], "worst": []})";

std::string name_of_folder(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
}

std::string verdict_part(const PairContent& content) {
  std::string text = "<div class=\"verdict\">\n";
  for (const std::string& sentence : content.sentences) {
    text += "<p>" + html_escaped(sentence) + "</p>\n";
  }
  text += "</div>\n";
  for (const std::string& refusal : content.refusals) {
    text += "<p class=\"notice\">" + html_escaped(refusal) + "</p>\n";
  }
  return text;
}

Page page_of(const PairContent& content, const std::string& a, const std::string& b,
             const std::string& note) {
  std::string figures;
  for (const PanelFigure& figure : content.figures) figures += to_html(figure, note);
  std::vector<Section> sections = {{"verdicts", "In short", verdict_part(content)},
                                   {"differences", "Differences", figures}};
  for (const TextTable& table : content.tables) {
    const std::string none = "<p>None.</p>\n";
    sections.push_back({table.id, table.title, table.rows.empty() ? none : to_html(table)});
  }
  sections.push_back(
      {"folders", "Folders",
       fmt::format("<dl class=\"facts\"><dt>A</dt><dd><code>{}</code></dd><dt>B</dt><dd><code>{}"
                   "</code></dd></dl>\n",
                   html_escaped(a), html_escaped(b))});
  return {"A: " + name_of_folder(a) + ", B: " + name_of_folder(b),
          "Comparison of two folders, made by Weft " + content.version + ".", a,
          std::move(sections), kNoData};
}

std::string markdown_head(const PairContent& content, const std::string& a, const std::string& b) {
  std::string text = "# A: " + markdown_escaped(a) + ", B: " + markdown_escaped(b) + "\n\n";
  for (const auto* list : {&content.sentences, &content.refusals}) {
    for (const std::string& sentence : *list) text += "- " + markdown_escaped(sentence) + "\n";
  }
  return text + "\n";
}

}  // namespace

Result<ReportFiles> write_pair_report(const std::string& a, const std::string& b,
                                      const ReportOptions& options) {
  std::error_code code;
  if (fs::equivalent(a, b, code)) {
    return Error{Errc::invalid_value, "is the first folder again: give two different ones", b};
  }
  if (is_run_folder(a) != is_run_folder(b)) {
    return Error{Errc::invalid_value,
                 fmt::format("is {}, the first folder {}: give two runs or two ablations",
                             is_run_folder(b) ? "a run" : "an ablation",
                             is_run_folder(a) ? "a run" : "an ablation"),
                 b};
  }
  const auto assets = read_assets(options.assets);
  if (!assets) return assets.error();
  auto content = is_run_folder(a) ? compare_runs(a, b) : compare_ablations(a, b);
  if (!content) return content.error();
  std::erase_if(content->figures, [](const PanelFigure& each) { return each.panels.empty(); });
  const std::string page =
      options.page.empty() ? a + "/with_" + name_of_folder(b) + ".html" : options.page;
  const std::string folder = fs::path(page).replace_extension().string();
  auto files = write_table_files(folder, markdown_head(*content, a, b), content->tables);
  if (!files) return files.error();
  PaperFiles figures;
  const std::string origin = "A: " + a + "\nB: " + b + "\n";
  if (auto done = write_figures(content->figures, folder, origin, figures); !done) {
    return done.error();
  }
  files->insert(files->end(), figures.files.begin(), figures.files.end());
  const Page whole = page_of(*content, a, b, "in <code>" + html_escaped(folder) + "</code>:");
  if (auto written = write_whole(page_html(whole, *assets), page); !written) {
    return written.error();
  }
  return ReportFiles{page, *std::move(files), assets->scripted()};
}

}  // namespace weft::lab
