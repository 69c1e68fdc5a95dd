// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/panel.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <weft/core/statistics.hpp>

namespace weft::lab {
namespace {

using Values = std::vector<std::optional<double>>;
using Rows = std::map<PanelPlace, Values>;

std::vector<std::string> treatments_of(const std::vector<Observation>& observations) {
  std::vector<std::string> treatments;
  std::map<std::string, bool> known;
  for (const Observation& each : observations) {
    if (known.try_emplace(each.treatment, true).second) treatments.push_back(each.treatment);
  }
  return treatments;
}

Error twice(const std::string& treatment, const PanelPlace& place) {
  return {
      Errc::invalid_data,
      "treatment '" + treatment + "' has two results at " + to_string(place) + "; keep one of them",
      {}};
}

Result<Rows> fill(const std::vector<Observation>& observations,
                  const std::vector<std::string>& treatments) {
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < treatments.size(); ++i) index[treatments[i]] = i;
  Rows rows;
  for (const Observation& each : observations) {
    const PanelPlace place{each.sequence, each.seed, each.frame};
    if (each.frame == kEveryFrame && std::isfinite(each.value)) {
      return Error{Errc::invalid_data, "a value of treatment '" + each.treatment + "' stands for " +
                                           to_string(place) + "; only a failure may"};
    }
    Values& results = rows[place];
    results.resize(treatments.size());
    std::optional<double>& result = results[index[each.treatment]];
    if (result) return twice(each.treatment, place);
    result = std::isfinite(each.value) ? each.value : kUnknown;
  }
  return rows;
}

/// Spreads the failures of a sequence and seed as a whole over its frames, if there are any.
Result<Rows> spread(Rows rows, const std::vector<std::string>& treatments) {
  for (auto whole = rows.begin(); whole != rows.end();) {
    const PanelPlace& place = whole->first;
    auto each = rows.lower_bound({place.sequence, place.seed, 0});
    if (place.frame != kEveryFrame || each == whole) {
      ++whole;
      continue;
    }
    for (; each != whole; ++each) {
      for (std::size_t t = 0; t < treatments.size(); ++t) {
        if (!whole->second[t]) continue;
        if (each->second[t]) return twice(treatments[t], each->first);
        each->second[t] = kUnknown;
      }
    }
    whole = rows.erase(whole);
  }
  return rows;
}

}  // namespace

std::string to_string(const PanelPlace& place) {
  return "sequence " + place.sequence + ", seed " + std::to_string(place.seed) +
         (place.frame == kEveryFrame ? ", every frame" : ", frame " + std::to_string(place.frame));
}

bool PanelRow::failed(std::size_t treatment) const {
  return results[treatment] && std::isnan(*results[treatment]);
}

bool PanelRow::has_value(std::size_t treatment) const {
  return results[treatment] && !std::isnan(*results[treatment]);
}

std::vector<std::string> Panel::sequences() const {
  std::vector<std::string> names;
  for (const PanelRow& row : rows) {
    if (names.empty() || names.back() != row.place.sequence) names.push_back(row.place.sequence);
  }
  return names;
}

Result<Panel> make_panel(const std::vector<Observation>& observations) {
  if (observations.empty()) {
    return Error{Errc::invalid_data, "there are no results to compare"};
  }
  Panel panel{treatments_of(observations), {}};
  auto rows = fill(observations, panel.treatments);
  if (!rows) return rows.error();
  rows = spread(*std::move(rows), panel.treatments);
  if (!rows) return rows.error();
  for (auto& [place, results] : *rows) panel.rows.push_back({place, std::move(results)});
  return panel;
}

std::vector<SequenceMean> sequence_means(
    const Panel& panel, const std::function<std::optional<double>(const PanelRow&)>& value) {
  std::vector<SequenceMean> sequences;
  std::vector<double> frames, seeds;
  std::int64_t rows = 0;
  for (std::size_t i = 0; i < panel.rows.size(); ++i) {
    const PanelPlace& place = panel.rows[i].place;
    if (const auto result = value(panel.rows[i])) frames.push_back(*result);
    const PanelPlace* next = i + 1 < panel.rows.size() ? &panel.rows[i + 1].place : nullptr;
    const bool same_sequence = next != nullptr && next->sequence == place.sequence;
    if (same_sequence && next->seed == place.seed) continue;
    rows += static_cast<std::int64_t>(frames.size());
    if (!frames.empty()) seeds.push_back(mean(frames));
    frames.clear();
    if (same_sequence) continue;
    if (!seeds.empty()) sequences.push_back({place.sequence, mean(seeds), rows});
    seeds.clear();
    rows = 0;
  }
  return sequences;
}

std::vector<double> means_of(const std::vector<SequenceMean>& sequences) {
  std::vector<double> means;
  for (const SequenceMean& each : sequences) means.push_back(each.mean);
  return means;
}

}  // namespace weft::lab
