// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/report/figures.hpp"
#include "lab/report/sheets.hpp"
#include "lab/report/text/base64.hpp"
#include "lab/report/text/page.hpp"

namespace weft::lab {
namespace {

using nlohmann::ordered_json;

ordered_json band_json(const Band& band) {
  return {{"x", packed(band.x)}, {"low", packed(band.low)}, {"high", packed(band.high)}};
}

ordered_json curve_json(const Curve& curve) {
  ordered_json object{{"x", packed(curve.x)}, {"y", packed(curve.y)}};
  if (!curve.band.x.empty()) object["band"] = band_json(curve.band);
  return object;
}

ordered_json treatment_json(const Results& results, const ReportTables& tables,
                            const Figures& figures, std::size_t index) {
  const Combination& combination = tables.combinations[index];
  ordered_json stages = ordered_json::array();
  for (const StageTime& time : combination.times) {
    stages.push_back({{"stage", time.stage}, {"ms", time.mean_ms}});
  }
  std::vector<float> said, came_true, frames;
  for (const ConfidenceBin& bin : combination.certainty.bins) {
    if (bin.frames == 0) continue;
    said.push_back(static_cast<float>(bin.said));
    came_true.push_back(static_cast<float>(bin.came_true));
    frames.push_back(static_cast<float>(bin.frames));
  }
  return {
      {"id", index},
      {"name", combination.name},
      {"mean_mm", combination.mean_mm},
      {"low_mm", combination.interval_mm.low},
      {"high_mm", combination.interval_mm.high},
      {"processor_ms", combination.processor_ms},
      {"reliability", {{"x", packed(said)}, {"y", packed(came_true)}, {"frames", packed(frames)}}},
      {"drawn", std::count(figures.drawn.begin(), figures.drawn.end(), index) > 0},
      {"distribution", curve_json(distribution_of(results, combination))},
      {"by_frame", curve_json(figures.over_frames[index].error)},
      {"by_frame_difference", curve_json(figures.over_frames[index].difference)},
      {"stages", std::move(stages)}};
}

ordered_json sweep_json(const Results& results, const Sweep& sweep) {
  ordered_json others = ordered_json::array(), curves = ordered_json::array();
  for (const PlanAxis& axis : other_axes(results, sweep)) {
    others.push_back(
        {{"name", axis.name}, {"values", axis.values}, {"families", !axis.families.empty()}});
  }
  for (const SweepCurve& curve : sweep.curves) {
    ordered_json figures = ordered_json::array();
    for (const std::vector<float>& figure : curve.figures) figures.push_back(packed(figure));
    curves.push_back({{"others", curve.others},
                      {"values", packed(curve.values)},
                      {"figures", std::move(figures)},
                      {"band", band_json(curve.error_band)},
                      {"auc", curve.auc_percent},
                      {"partial_auc", curve.partial_auc_percent}});
  }
  return {{"axis", results.plan.axes[sweep.axis].swept},
          {"roc", !sweep.stage.empty()},
          {"measures", sweep.measures},
          {"banded_measure", kErrorMeasure},
          {"others", std::move(others)},
          {"curves", std::move(curves)}};
}

/// The scores that a filter gives the matches: one entry for each combination in which it gives
/// scores.
ordered_json scores_json(const Results& results, const ReportTables& tables,
                         const std::string& stage) {
  ordered_json axes = ordered_json::array(), combinations = ordered_json::array();
  for (const PlanAxis& axis : results.plan.axes) {
    axes.push_back({{"name", axis.name}, {"values", axis.values}});
  }
  for (const Combination& combination : tables.combinations) {
    const FilterRates* rates = combination.filter(stage);
    if (rates == nullptr) continue;
    const ScoreShares shares = scores_of(*rates);
    if (shares.mismatches.empty() && shares.correct.empty()) continue;
    combinations.push_back({{"values", combination.values},
                            {"mismatches", packed(shares.mismatches)},
                            {"correct", packed(shares.correct)}});
  }
  return {{"axes", std::move(axes)}, {"combinations", std::move(combinations)}};
}

ordered_json view_json(const CellView& view, const CellRecord& record) {
  ordered_json frames = ordered_json::array();
  for (const ViewFrame& frame : view.frames) {
    const auto error =
        std::find_if(record.errors.begin(), record.errors.end(),
                     [&](const FrameError& one) { return one.frame == frame.frame; });
    frames.push_back({{"frame", frame.frame},
                      {"state", frame.state},
                      {"mean_mm", error == record.errors.end() ? kUnknown : error->mean_mm},
                      {"vertices", packed(frame.vertices)},
                      {"truth", packed(frame.truth)},
                      {"placed", packed(frame.placed)}});
  }
  return {{"faces", base64_of(std::span<const std::uint32_t>(view.faces))},
          {"frames", std::move(frames)}};
}

ordered_json cell_json(const Results& results, const ShownCell& shown) {
  const PlanCell& cell = results.plan.cells[shown.cell];
  ordered_json object{{"name", shown.name}, {"command", command_of(results, cell)}};
  object.update(view_json(shown.view, results.record(cell)));
  return object;
}

}  // namespace

std::string to_json(const Results& results, const ReportTables& tables, const Figures& figures) {
  ordered_json object{{"measure", {{"name", "mean 3D error of a frame"}, {"unit", "mm"}}}};
  if (!tables.combinations.empty()) {
    object["reference"] = tables.combinations[figures.reference].name;
  }
  for (const char* list : {"treatments", "sweeps", "scores", "cells", "worst"}) {
    object[list] = ordered_json::array();
  }
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    if (!tables.combinations[i].selectable) continue;
    object["treatments"].push_back(treatment_json(results, tables, figures, i));
  }
  for (const Sweep& sweep : figures.sweeps) object["sweeps"].push_back(sweep_json(results, sweep));
  for (const std::string& stage : tables.filter_stages) {
    object["scores"].push_back(scores_json(results, tables, stage));
  }
  for (const ShownFrame& frame : figures.worst_frames) {
    object["worst"].push_back(
        view_json(frame.view, results.record(results.plan.cells[frame.cell])));
  }
  for (const ShownCell& cell : figures.cells) object["cells"].push_back(cell_json(results, cell));
  return script_safe(object.dump(-1, ' ', true, ordered_json::error_handler_t::replace));
}

}  // namespace weft::lab
