// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/figures.hpp"

#include <cmath>
#include <map>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/statistics/bootstrap.hpp"

namespace weft::bench {
namespace {

constexpr std::size_t kStatuses = 5;

double time_of(const host::Spent& spent, Time time) {
  return time == Time::wall ? spent.ms : spent.processor_ms;
}

host::Spent less(host::Spent whole, const host::Spent& part) {
  whole.ms -= part.ms;
  whole.processor_ms -= part.processor_ms;
  whole.allocations.blocks -= part.allocations.blocks;
  whole.allocations.bytes -= part.allocations.bytes;
  return whole;
}

}  // namespace

Spread spread_of(std::span<const double> values) {
  return {static_cast<std::int64_t>(values.size()), percentile(values, 50.0),
          percentile(values, 95.0), percentile(values, 99.0)};
}

std::vector<Part> parts_of(const std::vector<std::string>& names,
                           const std::vector<Sample>& samples) {
  std::vector<Part> parts;
  for (const std::string& name : names) parts.push_back({name, {}, {}});
  parts.push_back({kHost, {}, {}});
  parts.push_back({kFrame, {}, {}});
  for (Part& part : parts) part.statuses.resize(kStatuses);
  const auto add = [](Part& part, const Sample& sample, const host::Spent& took) {
    part.samples.push_back({sample.turn, sample.repetition, sample.frame, took});
  };
  for (const Sample& sample : samples) {
    host::Spent rest = sample.spent.whole;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const PartSpent& spent = sample.spent.parts[i];
      ++parts[i].statuses[to_index(spent.status)];
      if (spent.status == StageStatus::skipped) continue;
      add(parts[i], sample, spent.took);
      rest = less(rest, spent.took);
    }
    add(parts[names.size()], sample, rest);
    add(parts[names.size() + 1], sample, sample.spent.whole);
  }
  return parts;
}

Ratio ratio_of(const Part& part, const Part& over, Time time) {
  std::map<std::pair<int, std::int64_t>, double> others;
  for (const PartSample& sample : over.samples) {
    others[{sample.repetition, sample.frame}] = time_of(sample.took, time);
  }
  Ratio ratio;
  std::map<std::int64_t, std::vector<double>> by_turn;
  for (const PartSample& sample : part.samples) {
    const auto other = others.find({sample.repetition, sample.frame});
    const double own = time_of(sample.took, time);
    // A clock that did not move gives no ratio.
    if (other == others.end() || !(other->second > 0.0) || !(own > 0.0)) continue;
    by_turn[sample.turn].push_back(std::log(own / other->second));
    ++ratio.pairs;
  }
  std::vector<double> logs;
  for (const auto& [turn, each] : by_turn) logs.push_back(mean(each));
  ratio.turns = static_cast<std::int64_t>(logs.size());
  if (logs.empty()) return ratio;
  ratio.ratio = std::exp(mean(logs));
  const Interval interval = lab::bootstrap_interval(logs);
  ratio.interval = {std::exp(interval.low), std::exp(interval.high)};
  return ratio;
}

}  // namespace weft::bench
