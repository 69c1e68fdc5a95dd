// SPDX-License-Identifier: Apache-2.0
#include "lab/report/tables/tables.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <weft/core/statistics.hpp>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/statistics/bootstrap.hpp"

namespace weft::lab {
namespace {

/// Mean over the sequences of the mean over the cells of each; cells without a figure are omitted.
struct MeansBySequence {
  std::map<std::string, std::vector<double>> by_sequence;

  void add(const std::string& sequence, double value) {
    if (std::isfinite(value)) by_sequence[sequence].push_back(value);
  }
  std::int64_t sequences() const { return static_cast<std::int64_t>(by_sequence.size()); }
  std::vector<double> means() const {
    std::vector<double> result;
    for (const auto& [name, values] : by_sequence) result.push_back(mean(values));
    return result;
  }
  double value() const { return mean(means()); }
};

std::string joined_name(const Results& results, const std::vector<std::string>& values) {
  std::string name, all;
  for (std::size_t a = 0; a < values.size(); ++a) {
    all += (all.empty() ? "" : " · ") + values[a];
    if (results.plan.axes[a].values.size() > 1) name += (name.empty() ? "" : " · ") + values[a];
  }
  if (!name.empty()) return name;
  return all.empty() ? results.plan.name : all;
}

void take_worst(Combination& row, const PlanCell& cell, const CellRecord& record) {
  if (!std::isfinite(record.worst_mm) || record.worst_mm <= row.worst_mm) return;
  row.worst_mm = record.worst_mm;
  row.worst_place =
      cell.sequence + ", seed " + std::to_string(cell.seed) + ", frame " + record.worst_frame;
}

void take_errors(Combination& row, const PlanCell& cell, const CellRecord& record) {
  row.frames_in_error += record.frames_in_error;
  if (!row.first_error.empty() || record.first_error.empty()) return;
  row.first_error =
      cell.sequence + ", seed " + std::to_string(cell.seed) + ", " + record.first_error;
}

void fill(const Results& results, Combination& row) {
  MeansBySequence error;
  std::vector<MeansBySequence> shown(results.plan.show.size());
  for (const std::size_t index : row.cells) {
    const PlanCell& cell = results.plan.cells[index];
    const CellRecord& record = results.record(cell);
    row.done += record.outcome == CellOutcome::done ? 1 : 0;
    row.failed += record.outcome == CellOutcome::failed ? 1 : 0;
    row.missing += record.outcome == CellOutcome::missing ? 1 : 0;
    const SequenceSize size = results.size(cell);
    row.frames += size.frames;
    row.solved += record.solved;
    row.truth_frames += size.truth_frames;
    row.failures += record.failures + size.truth_frames - record.truth_frames;
    row.uses_truth = row.uses_truth || !record.truth_users.empty();
    for (const std::string& text : record.implements) {
      const bool known =
          std::find(row.implements.begin(), row.implements.end(), text) != row.implements.end();
      if (!known) row.implements.push_back(text);
    }
    error.add(cell.sequence, record.mean_mm);
    for (std::size_t m = 0; m < shown.size(); ++m) {
      shown[m].add(cell.sequence, record.figure(results.plan.show[m]));
    }
    take_worst(row, cell, record);
    take_errors(row, cell, record);
  }
  row.mean_mm = error.value();
  row.interval_mm = bootstrap_interval(error.means());
  row.sequences = error.sequences();
  for (const MeansBySequence& metric : shown) row.shown.push_back(metric.value());
}

void add_counts(const std::vector<std::int64_t>& counts, std::vector<std::int64_t>& sums) {
  sums.resize(std::max(sums.size(), counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) sums[i] += counts[i];
}

/// Rates of one filter stage: means over sequences; counts: sums.
struct FilterMeans {
  FilterSummary summary;
  MeansBySequence tpr, fpr, kept, precision;

  void add(const std::string& sequence, const FilterRates& rates) {
    tpr.add(sequence, rates.tpr_percent);
    fpr.add(sequence, rates.fpr_percent);
    kept.add(sequence, rates.kept_percent);
    precision.add(sequence, rates.precision_percent);
    summary.rates.entered += rates.entered;
    summary.rates.mismatches += rates.mismatches;
    summary.rates.correct += rates.correct;
    add_counts(rates.scores_of_mismatches, summary.rates.scores_of_mismatches);
    add_counts(rates.scores_of_correct, summary.rates.scores_of_correct);
  }
  FilterSummary finish() {
    summary.rates.tpr_percent = tpr.value();
    summary.rates.fpr_percent = fpr.value();
    summary.rates.kept_percent = kept.value();
    summary.rates.precision_percent = precision.value();
    summary.sequences = kept.sequences();
    return summary;
  }
};

struct TimeMeans {
  MeansBySequence mean_ms, median_ms, mean_processor_ms;
};

/// The element for a stage, made at the end when it is the first of its stage.
template <class T>
T& of_stage(std::vector<std::pair<std::string, T>>& parts, const std::string& stage) {
  for (auto& [name, part] : parts) {
    if (name == stage) return part;
  }
  return parts.emplace_back(stage, T{}).second;
}

void fill_stages(const Results& results, Combination& row) {
  std::vector<std::pair<std::string, FilterMeans>> filters;
  std::vector<std::pair<std::string, TimeMeans>> times;
  MeansBySequence processor_ms;
  for (const std::size_t index : row.cells) {
    const PlanCell& cell = results.plan.cells[index];
    const CellRecord& record = results.record(cell);
    row.certainty.add(record.certainty);
    for (const FilterRates& rates : record.filters) {
      of_stage(filters, rates.stage).add(cell.sequence, rates);
    }
    processor_ms.add(cell.sequence, record.processor_ms);
    for (const StageTime& time : record.times) {
      TimeMeans& means = of_stage(times, time.stage);
      means.mean_ms.add(cell.sequence, time.mean_ms);
      means.median_ms.add(cell.sequence, time.median_ms);
      means.mean_processor_ms.add(cell.sequence, time.mean_processor_ms);
    }
  }
  for (auto& [stage, means] : filters) {
    means.summary.rates.stage = stage;
    row.filters.push_back(means.finish());
  }
  row.processor_ms = processor_ms.value();
  for (const auto& [stage, means] : times) {
    row.times.push_back(
        {stage, means.mean_ms.value(), means.median_ms.value(), means.mean_processor_ms.value()});
  }
}

/// A page of all cells and curves of a large plan would be too large to open: it has the best
/// combinations, and the cells of those with failures.
void choose_parts_of_page(const Results& results, std::vector<Combination>& combinations) {
  constexpr std::size_t kMostSelectable = 64, kMostFailing = 100, kMostCells = 2000;
  for (const std::size_t index : best_combinations(combinations, kMostSelectable)) {
    combinations[index].selectable = combinations[index].detailed = true;
  }
  std::size_t failing = 0;
  for (Combination& each : combinations) {
    const bool fails = each.failed + each.missing > 0 && ++failing <= kMostFailing;
    each.detailed = each.detailed || fails || results.plan.cells.size() <= kMostCells;
  }
}

}  // namespace

std::vector<std::size_t> best_combinations(const std::vector<Combination>& combinations,
                                           std::size_t most) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < combinations.size(); ++i) {
    if (std::isfinite(combinations[i].mean_mm)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return combinations[a].mean_mm < combinations[b].mean_mm;
  });
  if (order.size() > most) order.resize(most);
  std::sort(order.begin(), order.end());
  return order;
}

std::vector<Combination> combinations_of(const Results& results) {
  std::vector<Combination> rows;
  std::map<std::vector<std::string>, std::size_t> places;
  for (std::size_t c = 0; c < results.plan.cells.size(); ++c) {
    const PlanCell& cell = results.plan.cells[c];
    const auto [place, fresh] = places.try_emplace(cell.values, rows.size());
    if (fresh) {
      rows.emplace_back();
      rows.back().name = joined_name(results, cell.values);
      rows.back().values = cell.values;
    }
    rows[place->second].cells.push_back(c);
  }
  return rows;
}

const FilterRates* Combination::filter(const std::string& stage) const {
  for (const FilterSummary& summary : filters) {
    if (summary.rates.stage == stage) return &summary.rates;
  }
  return nullptr;
}

Result<ReportTables> make_tables(const Results& results) {
  ReportTables tables;
  tables.combinations = combinations_of(results);
  for (Combination& row : tables.combinations) {
    fill(results, row);
    fill_stages(results, row);
    tables.has_error = tables.has_error || std::isfinite(row.mean_mm);
    tables.has_times = tables.has_times || !row.times.empty();
    for (const FilterSummary& filter : row.filters) {
      const std::string& stage = filter.rates.stage;
      if (std::count(tables.filter_stages.begin(), tables.filter_stages.end(), stage) == 0) {
        tables.filter_stages.push_back(stage);
      }
    }
  }
  choose_parts_of_page(results, tables.combinations);
  for (const PlanExpectation& expectation : results.plan.expectations) {
    tables.expectations.push_back(judge(results, expectation));
  }
  for (const PlanComparison& plan : results.plan.comparisons) {
    auto table = compare(results, plan);
    if (!table) return table.error();
    auto separate = compare_separately(results, plan);
    if (!separate) return separate.error();
    auto scenes = scene_effects(results, plan, table->pairs);
    tables.comparisons.push_back(
        {plan, unit_of(plan.metric), *std::move(table), *std::move(separate), std::move(scenes)});
  }
  return tables;
}

}  // namespace weft::lab
