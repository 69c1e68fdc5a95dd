// SPDX-License-Identifier: Apache-2.0
#include "lab/report/page.hpp"

#include "lab/report/parts.hpp"

namespace weft::lab {

Page page_of(const Results& results, const ReportTables& tables, const Figures& figures,
             bool scripted) {
  std::vector<Section> sections = {
      {"verdicts", "In short", verdicts_part(results, tables)},
      {"results", "Results", results_part(results, tables)},
      {"compared", "What was compared", compared_part(results, tables)},
      {"comparisons", "Comparisons", comparisons_part(results, tables)},
      {"expectations", "Expectations", expectations_part(results, tables)},
      {"errors", "Errors", scripted ? curves_part(tables, figures) : ""},
      {"axes", "Along an axis", scripted ? sweeps_part(results, figures) : ""},
      {"filters", "Filters",
       filters_part(results, tables) + (scripted ? scores_part(tables) : std::string())},
      {"confidence", "Confidence", certainty_part(results, tables, scripted)},
      {"times", "Times", times_part(results, tables, scripted)},
      {"worst", "Worst frames", worst_part(results, figures)},
      {"shapes", "Estimate and truth in 3D", scripted ? viewer_part(figures) : ""},
      {"reproduce", "Every cell, and how to run it again", reproduce_part(results, tables)}};
  return {results.plan.name, "Report of an ablation, made by Weft " + results.version + ".",
          results.folder, std::move(sections),
          scripted ? to_json(results, tables, figures) : std::string()};
}

}  // namespace weft::lab
