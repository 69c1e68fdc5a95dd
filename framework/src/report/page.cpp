// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include <fmt/format.h>

#include <vector>

#include "report/parts.hpp"
#include "report/sheets.hpp"

namespace weft::evaluation {
namespace {

struct Section {
  const char* id;
  const char* title;
  std::string content;  ///< HTML; a section without it is left out
};

std::string header(const Results& results) {
  return fmt::format(
      "<header><button type=\"button\" id=\"theme\" hidden>Light / dark</button>\n"
      "<h1>{}</h1>\n<p class=\"muted\">Report of an ablation, made by Weft {}.</p></header>\n",
      html_escaped(results.plan.name), html_escaped(results.version));
}

std::string footer(const Results& results, const PageAssets& assets) {
  std::string text = fmt::format(
      "<footer><p>Written from <code>{}</code> by <code>weft report</code>. The page holds all "
      "that "
      "it shows and loads nothing.</p>\n",
      html_escaped(results.folder));
  if (!assets.licences.empty()) {
    text += "<details><summary>Licences of the libraries in this page</summary><pre>" +
            html_escaped(assets.licences) + "</pre></details>\n";
  }
  return text + "</footer>\n";
}

std::vector<Section> sections_of(const Results& results, const ReportTables& tables,
                                 const Figures& figures, bool scripted) {
  std::vector<Section> sections = {
      {"verdicts", "In short", verdicts_part(results, tables)},
      {"results", "Results", results_part(results, tables)},
      {"compared", "What was compared", compared_part(results, tables)},
      {"comparisons", "Comparisons", comparisons_part(tables, scripted)},
      {"expectations", "Expectations", expectations_part(results, tables)},
      {"errors", "Errors", scripted ? curves_part(tables) : ""},
      {"axes", "Along an axis", scripted ? sweeps_part(results, figures) : ""},
      {"filters", "Filters",
       filters_part(results, tables) + (scripted ? scores_part(tables) : std::string())},
      {"confidence", "Confidence", certainty_part(results, tables, scripted)},
      {"times", "Times", times_part(results, tables, scripted)},
      {"worst", "Worst frames", worst_part(results, figures)},
      {"shapes", "Estimate and truth in 3D", scripted ? viewer_part(figures) : ""},
      {"reproduce", "Every cell, and how to run it again", reproduce_part(results, tables)}};
  std::erase_if(sections, [](const Section& section) { return section.content.empty(); });
  return sections;
}

std::string body(const std::vector<Section>& sections) {
  std::string links, text;
  for (const auto& [id, title, content] : sections) {
    links += fmt::format("<a href=\"#{}\">{}</a>\n", id, title);
    text += fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, content);
  }
  return "<nav>" + links + "</nav>\n" + text;
}

}  // namespace

std::string page_html(const Results& results, const ReportTables& tables, const Figures& figures,
                      const PageAssets& assets) {
  const bool scripted = !assets.script.empty();
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n"
      "<link rel=\"icon\" href=\"data:,\">\n<style>\n",
      html_escaped(results.plan.name));
  page += assets.style + "</style></head>\n<body>\n" + header(results);
  if (!scripted) {
    page +=
        "<p class=\"notice\">This report has tables only: the figures and the 3D view are built "
        "with npm, which was absent when Weft was built. Install npm, run "
        "<code>scripts/bootstrap.sh</code>, build again and repeat <code>weft report</code>.</p>\n";
  }
  page += body(sections_of(results, tables, figures, scripted)) + footer(results, assets);
  if (scripted) {
    page += "<script type=\"application/json\" id=\"weft-data\">" +
            to_json(results, tables, figures) + "</script>\n<script>" + assets.script +
            "</script>\n";
  }
  return page + "</body></html>\n";
}

}  // namespace weft::evaluation
