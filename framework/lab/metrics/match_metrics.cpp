// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/match_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/truth/match_labels.hpp>

#include "lab/metrics/field.hpp"
#include "lab/statistics/unknown.hpp"

namespace weft::lab {
namespace {

double percent(std::int64_t part, std::int64_t whole) {
  return kPercent * static_cast<double>(part) / static_cast<double>(whole);
}

void add_score(double score, ScoreCounts& counts) {
  const double bins = static_cast<double>(counts.size());
  if (std::isnan(score)) return;
  ++counts[to_index(std::clamp(std::floor(bins * score), 0.0, bins - 1.0))];
}

void add(const ScoreCounts& counts, ScoreCounts& sums) {
  for (std::size_t i = 0; i < counts.size(); ++i) sums[i] += counts[i];
}

}  // namespace

FilterCounts count_filter(const Array<std::uint8_t>& before, const Array<std::uint8_t>& after,
                          const Array<double>& scores, const std::vector<std::int8_t>& labels) {
  FilterCounts counts;
  for (std::int64_t n = 0; n < before.rows(); ++n) {
    if (before(n) == 0) continue;
    const bool kept = after(n) != 0;
    const std::int8_t label = labels[to_index(n)];
    ++counts.entered;
    counts.kept += kept;
    counts.mismatches += label == kMismatch;
    counts.correct += label == kCorrectMatch;
    if (label == kMismatch) add_score(scores(n), counts.wrong_scores);
    if (label == kCorrectMatch) add_score(scores(n), counts.right_scores);
    counts.rejected_wrong += label == kMismatch && !kept;
    counts.rejected_right += label == kCorrectMatch && !kept;
  }
  return counts;
}

FilterMetrics summarise_filter(const std::string& stage, const std::vector<FilterCounts>& frames) {
  FilterMetrics metrics;
  metrics.stage = stage;
  std::vector<double> tpr, fpr, kept, precision, recall, f1;
  for (const FilterCounts& frame : frames) {
    metrics.entered += frame.entered;
    metrics.labelled += frame.labelled();
    metrics.mismatches += frame.mismatches;
    add(frame.wrong_scores, metrics.wrong_scores);
    add(frame.right_scores, metrics.right_scores);
    if (frame.entered > 0) kept.push_back(percent(frame.kept, frame.entered));
    if (frame.labelled() == 0) continue;
    ++metrics.frames;
    const std::int64_t right = frame.correct - frame.rejected_right;
    const std::int64_t wrong = frame.mismatches - frame.rejected_wrong;
    metrics.frames_without_mismatch += frame.mismatches == 0;
    metrics.frames_without_correct += frame.correct == 0;
    metrics.frames_without_kept += right + wrong == 0;
    if (frame.mismatches > 0) tpr.push_back(percent(frame.rejected_wrong, frame.mismatches));
    if (frame.correct > 0) fpr.push_back(percent(frame.rejected_right, frame.correct));
    if (frame.correct > 0) {
      recall.push_back(percent(right, frame.correct));
      f1.push_back(percent(2 * right, 2 * right + wrong + frame.rejected_right));
    }
    if (right + wrong > 0) precision.push_back(percent(right, right + wrong));
  }
  metrics.tpr_percent = mean_or_unknown(tpr);
  metrics.fpr_percent = mean_or_unknown(fpr);
  metrics.kept_percent = mean_or_unknown(kept);
  metrics.precision_percent = mean_or_unknown(precision);
  metrics.recall_percent = mean_or_unknown(recall);
  metrics.f1_percent = mean_or_unknown(f1);
  return metrics;
}

}  // namespace weft::lab
