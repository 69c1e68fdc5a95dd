// SPDX-License-Identifier: Apache-2.0
#include "lab/report/notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lab/report/sheets.hpp"

namespace weft::lab {
namespace {

std::string alignment_text(const Results& results) {
  if (results.alignment == "scale") return "after one scale a frame was taken out";
  if (results.alignment == "rigid") return "after one rigid motion a frame was taken out";
  return "without any alignment";
}

std::string data_use_text(const std::string& use) {
  if (use == "reporting") return "reporting: by the plan nothing was tuned on these sequences";
  if (use == "tuning") return "tuning: not for publication";
  return "not stated in the plan";
}

struct Counts {
  std::int64_t done = 0, failed = 0, missing = 0;
  std::int64_t frames_in_error = 0;
  std::string first_error = {};
  bool use_truth = false;
};

Counts count_cells(const ReportTables& tables) {
  Counts counts;
  for (const Combination& combination : tables.combinations) {
    counts.done += combination.done;
    counts.failed += combination.failed;
    counts.missing += combination.missing;
    counts.frames_in_error += combination.frames_in_error;
    if (counts.first_error.empty() && !combination.first_error.empty()) {
      counts.first_error = combination.name + ", " + combination.first_error;
    }
    counts.use_truth = counts.use_truth || combination.uses_truth;
  }
  return counts;
}

std::size_t distinct_keys(const Results& results) {
  std::set<std::string> keys;
  for (const PlanCell& cell : results.plan.cells) keys.insert(cell.key);
  return keys.size();
}

template <class List>
std::string listed(const List& values) {
  return fmt::format("{}", fmt::join(values, ", "));
}

/// The verdicts of the pairs of a table, to compare with those of another.
std::vector<std::pair<std::string, Call>> calls_of(const ComparisonTable& table) {
  std::vector<std::pair<std::string, Call>> calls;
  for (const PairComparison& pair : table.pairs) {
    calls.emplace_back(pair.a + "\n" + pair.b, pair.verdict);
  }
  return calls;
}

Verdict verdict_of(const ComparisonResult& comparison) {
  Verdict verdict{comparison.plan.axis, comparison.table.headline, {}, {}};
  if (comparison.table.pairs.empty()) {
    verdict.text = "There is nothing to compare.";
    return verdict;
  }
  const auto calls = calls_of(comparison.table);
  for (const SeparateComparison& separate : comparison.separate) {
    for (const ComparisonTable& table : separate.tables) {
      if (table.pairs.empty()) continue;
      (calls_of(table) == calls ? verdict.like : verdict.unlike).push_back(table.headline);
    }
  }
  return verdict;
}

}  // namespace

std::string counted(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string combinations_note(const Results& results, const ReportTables& tables) {
  std::string text;
  if (tables.has_error) {
    text = fmt::format(
        "Mean: over the n sequences, each the mean over its seeds, of the mean 3D error of the "
        "solved frames. A frame's error is the mean distance of its true points from their places "
        "on the estimated mesh, {}. 95 %: of the mean, by a bootstrap over sequences, from {} "
        "sequences on. Worst: the largest mean error of a frame in any cell. ",
        alignment_text(results), kLeastSequences);
  }
  if (!shown_metrics(results, tables).empty()) {
    text += "Further metrics are those that the plan shows, averaged over cells like the mean. ";
  }
  return text +
         "Frames failed: with truth, but without a shape, or off by more than a tenth of the "
         "template's diagonal. A cell that failed as a whole failed at each of them. A frame that "
         "is off enters the mean, the others enter none.";
}

std::string comparisons_note() {
  return fmt::format(
      "A − B: mean over the n sequences of the difference, paired by sequence, frame and seed. The "
      "values of other axes count as further seeds. Column p: of the exact test of the "
      "differences' signs. Column p, Holm: corrected for every test of the comparison, at most "
      "0.05 names the better one. 95 %: corrected like p, so that zero lies outside where one is "
      "named. Smallest effect: the difference that would be named 4 times in 5, a dash where n is "
      "too small for this number of tests. No value only A, only B: of all places compared, those "
      "where one has no value and the other has one. A frame that is off has a value. Too few: no "
      "outcome of n sequences could be called among these tests, and always below {}. Sequences on "
      "which both are the same count in n, but call nothing.",
      kLeastSequences);
}

std::string expectations_note() {
  return "Measured: the mean over the cells that are selected. A cell without the figure misses "
         "the expectation too.";
}

std::string filters_note(const Results& results) {
  const std::string tolerance =
      std::isfinite(results.match_tolerance_px)
          ? fmt::format(" A match is correct up to {:.4g} px from its true place.",
                        results.match_tolerance_px)
          : "";
  return "TPR: mismatches that were rejected; FPR: inliers that were rejected; kept (n_s): of "
         "those that entered; precision (AoS): correct, of those kept. Each is the mean over the "
         "frames in which it is defined, then over seeds, then over the n sequences." +
         tolerance;
}

std::string times_note() {
  return "Wall time for a frame, of cells that ran alone with nothing shared; means over "
         "sequences, each the mean over its seeds. Cells whose stages were cached have none.";
}

std::string cells_note(const Results& results) {
  return "A cell again: " + run_command(results, "KEY") + ", with its key.";
}

std::vector<std::string> notices_of(const Results& results, const ReportTables& tables) {
  const Counts counts = count_cells(tables);
  std::vector<std::string> notices;
  if (counts.failed > 0) {
    notices.push_back(
        fmt::format("{} of {} cells failed: they enter no mean, but their frames count as failed.",
                    counts.failed, results.plan.cells.size()));
  }
  if (counts.frames_in_error > 0) {
    const std::string first =
        counts.first_error.empty() ? "" : "; the first: " + counts.first_error;
    notices.push_back(fmt::format("{} frames had an error{}.", counts.frames_in_error, first));
  }
  if (counts.missing > 0) {
    notices.push_back(
        fmt::format("{} of {} cells have not been run yet: the figures cover the existing cells.",
                    counts.missing, results.plan.cells.size()));
  }
  if (!results.records.damaged.empty()) {
    constexpr std::size_t kMost = 5;
    std::vector<std::string> places;
    for (const Damage& damage : results.records.damaged) {
      if (places.size() < kMost) places.push_back(damage.where + " (" + damage.what + ")");
    }
    notices.push_back(fmt::format("{} omitted: {}{}. To run these cells again: {}",
                                  counted(results.records.damaged.size(), "damaged result"),
                                  listed(places),
                                  results.records.damaged.size() > kMost ? ", ..." : "",
                                  ablate_command(results, " --retry damaged")));
  }
  if (results.records.unchecked > 0) {
    notices.push_back(fmt::format(
        "{} of an older program: their lines have no check, so that a change in them would not be "
        "noticed.",
        counted(results.records.unchecked, "result")));
  }
  if (results.plan.data_use == "tuning") {
    notices.emplace_back(
        "The sequences of this plan are for tuning: its figures are not for publication.");
  }
  if (results.accept_rebuilt) {
    notices.emplace_back(
        "Results of components that were built again are mixed here (--accept-rebuilt).");
  }
  if (counts.use_truth) {
    notices.emplace_back(
        "Some combinations have a component that may read the truth: they are no measurement, and "
        "their rows are marked.");
  }
  return notices;
}

std::vector<Verdict> verdicts_of(const ReportTables& tables) {
  std::vector<Verdict> verdicts;
  for (const ComparisonResult& comparison : tables.comparisons) {
    verdicts.push_back(verdict_of(comparison));
  }
  if (verdicts.empty()) {
    verdicts.push_back({"", "The plan names no comparison, so no difference is named.", {}, {}});
  }
  if (tables.expectations.empty()) return verdicts;
  const auto met = std::count_if(tables.expectations.begin(), tables.expectations.end(),
                                 [](const ExpectationOutcome& outcome) { return outcome.met; });
  verdicts.push_back(
      {"", fmt::format("Expectations: {} of {} met.", met, tables.expectations.size()), {}, {}});
  return verdicts;
}

std::vector<std::pair<std::string, std::string>> facts_of(const Results& results,
                                                          const ReportTables& tables) {
  const Counts counts = count_cells(tables);
  std::vector<std::pair<std::string, std::string>> facts;
  for (const PlanAxis& axis : results.plan.axes) facts.emplace_back(axis.name, listed(axis.values));
  facts.emplace_back(counted(results.plan.sequences.size(), "sequence"),
                     listed(results.plan.sequences));
  facts.emplace_back(counted(results.plan.seeds.size(), "seed"), listed(results.plan.seeds));
  facts.emplace_back("data for", data_use_text(results.plan.data_use));
  facts.emplace_back(
      "cells",
      fmt::format("{} planned: {} done, {} failed, {} not run; {} with separate settings or data",
                  results.plan.cells.size(), counts.done, counts.failed, counts.missing,
                  distinct_keys(results)));
  if (!results.processors.empty()) facts.emplace_back("processor", listed(results.processors));
  return facts;
}

}  // namespace weft::lab
