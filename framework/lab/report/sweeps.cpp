// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <weft/core/index.hpp>

#include "lab/report/curves.hpp"
#include "lab/statistics/roc.hpp"

namespace weft::lab {
namespace {

/// Combinations that differ only in the number that an axis sweeps, in its ascending order.
struct Family {
  std::vector<std::string> others;  ///< values of the other axes; of this one the family, if any
  std::vector<std::pair<double, std::size_t>> members;  ///< number, combination
};

std::vector<Family> families_along(const Results& results, const ReportTables& tables,
                                   std::size_t axis) {
  std::vector<Family> families;
  std::map<std::vector<std::string>, std::size_t> places;
  for (std::size_t i = 0; i < tables.combinations.size(); ++i) {
    std::vector<std::string> others = tables.combinations[i].values;
    const PlanAxis& swept = results.plan.axes[axis];
    const auto place_on_axis = to_index(
        std::find(swept.values.begin(), swept.values.end(), others[axis]) - swept.values.begin());
    const double value =
        place_on_axis < swept.numbers.size() ? swept.numbers[place_on_axis] : kUnknown;
    if (std::isnan(value)) continue;
    if (swept.families.empty()) {
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(axis));
    } else {
      others[axis] = swept.families[place_on_axis];
    }
    const auto [place, fresh] = places.try_emplace(others, families.size());
    if (fresh) families.push_back({others, {}});
    families[place->second].members.emplace_back(value, i);
  }
  for (Family& family : families) std::sort(family.members.begin(), family.members.end());
  return families;
}

/// True if the stage gets the same matches for all values, but does not reject the same ones.
bool is_threshold(const ReportTables& tables, const Family& family, const std::string& stage) {
  const FilterRates* first = nullptr;
  bool decides = false;
  for (const auto& [value, index] : family.members) {
    const Combination& combination = tables.combinations[index];
    if (combination.failed + combination.missing > 0) continue;
    const FilterRates* rates = combination.filter(stage);
    if (rates == nullptr) return false;
    if (first == nullptr) first = rates;
    if (rates->entered != first->entered || rates->mismatches != first->mismatches ||
        rates->correct != first->correct) {
      return false;
    }
    decides = decides || rates->tpr_percent != first->tpr_percent ||
              rates->fpr_percent != first->fpr_percent;
  }
  return decides && first->mismatches > 0 && first->correct > 0;
}

SweepCurve roc_along(const ReportTables& tables, const Family& family, const std::string& stage) {
  std::vector<RocPoint> points;
  for (const auto& [value, index] : family.members) {
    const FilterRates* rates = tables.combinations[index].filter(stage);
    if (rates != nullptr) points.push_back({value, rates->fpr_percent, rates->tpr_percent});
  }
  const RocCurve roc = roc_curve(std::move(points));
  SweepCurve curve{family.others, {}, {{}, {}}, {}, roc.auc_percent, roc.partial_auc_percent};
  for (const RocPoint& point : roc.points) {
    curve.values.push_back(static_cast<float>(point.threshold));
    curve.figures[0].push_back(static_cast<float>(point.fpr_percent));
    curve.figures[1].push_back(static_cast<float>(point.tpr_percent));
  }
  return curve;
}

/// The measures of a combination, in the order of response_measures.
std::vector<double> response_of(const ReportTables& tables, std::size_t index) {
  std::vector<double> figures;
  if (tables.has_error) figures.push_back(tables.combinations[index].mean_mm);
  for (const std::string& stage : tables.filter_stages) {
    const FilterRates* rates = tables.combinations[index].filter(stage);
    const FilterRates known = rates == nullptr ? FilterRates{} : *rates;
    for (const double figure :
         {known.kept_percent, known.precision_percent, known.tpr_percent, known.fpr_percent}) {
      figures.push_back(figure);
    }
  }
  return figures;
}

std::vector<std::string> response_measures(const ReportTables& tables) {
  std::vector<std::string> measures;
  if (tables.has_error) measures.emplace_back(kErrorMeasure);
  for (const std::string& stage : tables.filter_stages) {
    for (const char* measure : {"kept (n_s), %", "precision (AoS), %", "TPR, %", "FPR, %"}) {
      measures.push_back(stage + ": " + measure);
    }
  }
  return measures;
}

Sweep response_along(const ReportTables& tables, std::size_t axis,
                     const std::vector<Family>& families) {
  Sweep sweep{axis, "", response_measures(tables), {}};
  for (const Family& family : families) {
    SweepCurve curve;
    curve.others = family.others;
    curve.figures.resize(sweep.measures.size());
    for (const auto& [value, index] : family.members) {
      curve.values.push_back(static_cast<float>(value));
      curve.error_band.add(value, tables.combinations[index].interval_mm);
      const std::vector<double> figures = response_of(tables, index);
      for (std::size_t m = 0; m < figures.size(); ++m) {
        curve.figures[m].push_back(static_cast<float>(figures[m]));
      }
    }
    sweep.curves.push_back(std::move(curve));
  }
  return sweep;
}

/// True if the numbers along some curve differ.
bool changes(const Sweep& sweep, std::size_t measure) {
  return std::any_of(sweep.curves.begin(), sweep.curves.end(), [&](const SweepCurve& curve) {
    std::set<float> different;
    for (const float figure : curve.figures[measure]) {
      if (!std::isnan(figure)) different.insert(figure);
    }
    return different.size() > 1;
  });
}

void drop_constant_measures(Sweep& sweep) {
  for (std::size_t m = sweep.measures.size(); m-- > 0;) {
    if (changes(sweep, m)) continue;
    const auto place = static_cast<std::ptrdiff_t>(m);
    sweep.measures.erase(sweep.measures.begin() + place);
    for (SweepCurve& curve : sweep.curves) curve.figures.erase(curve.figures.begin() + place);
  }
}

}  // namespace

std::vector<PlanAxis> other_axes(const Results& results, const Sweep& sweep) {
  std::vector<PlanAxis> others = results.plan.axes;
  PlanAxis& own = others[sweep.axis];
  if (own.families.empty()) {
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(sweep.axis));
    return others;
  }
  own.values.clear();
  for (const std::string& family : own.families) {
    const bool known = std::find(own.values.begin(), own.values.end(), family) != own.values.end();
    if (!family.empty() && !known) own.values.push_back(family);
  }
  return others;
}

std::vector<Sweep> sweeps_of(const Results& results, const ReportTables& tables) {
  std::vector<Sweep> sweeps;
  for (std::size_t axis = 0; axis < results.plan.axes.size(); ++axis) {
    if (results.plan.axes[axis].swept.empty()) continue;
    const std::vector<Family> families = families_along(results, tables, axis);
    for (const std::string& stage : tables.filter_stages) {
      Sweep roc{axis, stage, {"FPR, %", "TPR, %"}, {}};
      for (const Family& family : families) {
        if (is_threshold(tables, family, stage)) {
          roc.curves.push_back(roc_along(tables, family, stage));
        }
      }
      if (!roc.curves.empty()) sweeps.push_back(std::move(roc));
    }
    Sweep response = response_along(tables, axis, families);
    drop_constant_measures(response);
    if (!response.measures.empty()) sweeps.push_back(std::move(response));
  }
  return sweeps;
}

}  // namespace weft::lab
