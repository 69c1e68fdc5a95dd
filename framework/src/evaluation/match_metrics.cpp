// SPDX-License-Identifier: Apache-2.0
#include <weft/core/statistics.hpp>
#include <weft/evaluation/match_metrics.hpp>

namespace weft::evaluation {
namespace {

constexpr double kPercent = 100.0;

double percent(std::int64_t part, std::int64_t whole) {
  return kPercent * static_cast<double>(part) / static_cast<double>(whole);
}

double mean_or_unknown(const std::vector<double>& values) {
  return values.empty() ? FilterMetrics::kNoRate : mean(values);
}

}  // namespace

std::vector<std::int8_t> label_matches(const Correspondences& matches, const TruthMap& truth,
                                       const Eigen::Vector2d& m_per_px, const Pinhole& camera,
                                       double tolerance_px) {
  std::vector<std::int8_t> labels;
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    const Eigen::Vector2d template_px(matches.template_px(n, 0), matches.template_px(n, 1));
    const Eigen::Vector2d image_px(matches.image_px(n, 0), matches.image_px(n, 1));
    const auto true_m = truth.at(template_px.cwiseProduct(m_per_px));
    if (!true_m || !(true_m->z() > 0.0)) {
      labels.push_back(-1);
    } else {
      labels.push_back((project(camera, *true_m) - image_px).norm() < tolerance_px ? 1 : 0);
    }
  }
  return labels;
}

FilterCounts count_filter(const Array<std::uint8_t>& before, const Array<std::uint8_t>& after,
                          const std::vector<std::int8_t>& labels) {
  FilterCounts counts;
  for (std::int64_t n = 0; n < before.rows(); ++n) {
    if (before(n) == 0) continue;
    const bool kept = after(n) != 0;
    const std::int8_t label = labels[static_cast<std::size_t>(n)];
    ++counts.entered;
    counts.kept += kept;
    counts.mismatches += label == 0;
    counts.correct += label == 1;
    counts.rejected_wrong += label == 0 && !kept;
    counts.rejected_right += label == 1 && !kept;
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

}  // namespace weft::evaluation
