// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/drawing/interval_chart.hpp"
#include "lab/report/tables/tables.hpp"

/// Figures of estimates with intervals, which a page shows without a script.
namespace weft::lab {

/// Panels over the same axis; none: there is nothing to show.
struct PanelFigure {
  std::vector<Drawing> panels;
  std::string caption;

  const std::string& name() const { return panels.front().name; }
  /// All panels side by side.
  Drawing drawing() const;
};

/// The treatments of a table, the best first; those without a value last.
std::vector<TreatmentSummary> ranked(const ComparisonTable& table, Better better);

/// The values of a comparison's axis, the best first.
PanelFigure ranking_figure(const ComparisonResult& comparison);
/// All combinations by their mean 3D error, the best first. Without truth, by the first metric of
/// the plan that has values.
PanelFigure ranking_figure(const Results& results, const ReportTables& tables);
/// The same ranking with one value of another axis at a time.
PanelFigure conditions_figure(const ComparisonResult& comparison, const SeparateComparison& axis);
/// The difference of each pair.
PanelFigure differences_figure(const ComparisonResult& comparison);
/// A panel for each pair: its difference on each sequence or kind of data.
PanelFigure scenes_figure(const ComparisonResult& comparison);
/// Two rates of a filter stage for each combination: rejected mismatches, and precision.
PanelFigure rates_figure(const ReportTables& tables, const std::string& stage);

/// All of a report.
std::vector<PanelFigure> panel_figures(const Results& results, const ReportTables& tables);

/// "2.4 [2.11, 2.69]".
std::string interval_text(double value, const Interval& interval);

/// The command that writes the figures of a results folder as files, as the beginning of a sentence
/// in HTML.
std::string paper_note(const std::string& folder);

/// The figure in a page. `note`, in HTML, states where its files are.
std::string to_html(const PanelFigure& figure, const std::string& note);

}  // namespace weft::lab
