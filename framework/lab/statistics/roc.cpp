// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/roc.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

constexpr double kPartialPercent = 10.0;

/// Area under points in ascending FPR from 0 up to an FPR, as a share of what it could be, percent.
double area_percent(const std::vector<RocPoint>& points, double up_to_percent) {
  double area = 0.0;
  RocPoint from{0.0, 0.0, 0.0};
  const auto add = [&](RocPoint to) {
    if (to.fpr_percent > up_to_percent) {
      const double share = (up_to_percent - from.fpr_percent) / (to.fpr_percent - from.fpr_percent);
      to.tpr_percent = from.tpr_percent + share * (to.tpr_percent - from.tpr_percent);
      to.fpr_percent = up_to_percent;
    }
    area += 0.5 * (from.tpr_percent + to.tpr_percent) * (to.fpr_percent - from.fpr_percent);
    from = to;
  };
  for (const RocPoint& point : points) {
    if (from.fpr_percent < up_to_percent) add(point);
  }
  if (from.fpr_percent < up_to_percent) add({0.0, 100.0, 100.0});
  return area / up_to_percent;
}

}  // namespace

RocCurve roc_curve(std::vector<RocPoint> points) {
  RocCurve curve;
  curve.undefined = static_cast<std::int64_t>(std::erase_if(points, [](const RocPoint& point) {
    return !std::isfinite(point.fpr_percent) || !std::isfinite(point.tpr_percent);
  }));
  std::stable_sort(points.begin(), points.end(), [](const RocPoint& a, const RocPoint& b) {
    return a.fpr_percent != b.fpr_percent ? a.fpr_percent < b.fpr_percent
                                          : a.tpr_percent < b.tpr_percent;
  });
  curve.points = std::move(points);
  if (curve.points.empty()) return curve;
  curve.auc_percent = area_percent(curve.points, 100.0);
  curve.partial_auc_percent = area_percent(curve.points, kPartialPercent);
  return curve;
}

RocCurve average_roc_curve(const std::vector<RocPoint>& frames) {
  struct Rates {
    std::vector<double> fpr, tpr;
  };
  std::map<double, Rates> thresholds;
  for (const RocPoint& frame : frames) {
    Rates& rates = thresholds[frame.threshold];
    if (std::isfinite(frame.fpr_percent)) rates.fpr.push_back(frame.fpr_percent);
    if (std::isfinite(frame.tpr_percent)) rates.tpr.push_back(frame.tpr_percent);
  }
  std::vector<RocPoint> points;
  for (const auto& [threshold, rates] : thresholds) {
    points.push_back({threshold, mean(rates.fpr), mean(rates.tpr)});
  }
  return roc_curve(std::move(points));
}

}  // namespace weft::lab
