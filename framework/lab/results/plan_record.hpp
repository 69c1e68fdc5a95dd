// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/statistics/unknown.hpp"

/// The plan of an ablation as its results folder keeps it (plan.json): names, numbers and keys of
/// the merged parts, not the settings themselves.
namespace weft::lab {

/// Which cells: names of axes, `data`, `sequence` or `seed`, each with a value as the plan has it.
using Selection = std::vector<std::pair<std::string, std::string>>;

/// An axis of the plan and the names of its values, in the plan's order.
struct PlanAxis {
  std::string name;
  std::vector<std::string> values;  ///< [.] names
  std::string swept;                ///< the number that it sweeps; empty: it sweeps none
  std::vector<double> numbers;  ///< with `swept`, one a value; NaN: the value sets no such number
  std::vector<std::string>
      families;  ///< one a value, where `swept` is several numbers; empty: none
};

/// A group of sequences under one name of the plan.
struct PlanData {
  std::string name;
  std::vector<std::string> sequences;  ///< [.] names
};

/// Comparison of the plan: the values of an axis, in a metric, the rest paired.
struct PlanComparison {
  std::string axis, metric;
  std::string reference;  ///< a value of the axis; empty: each with each
};

/// A figure that the plan expects of the mean over the cells that `where` selects.
struct PlanExpectation {
  Selection where;
  std::string metric;
  double at_least = kUnknown, at_most = kUnknown;  ///< NaN: no bound
};

struct PlanCell {
  std::int64_t index = 0;           ///< [] number of the cell
  std::vector<std::string> values;  ///< one for each axis
  std::string sequence;
  std::uint64_t seed = 0;  ///< [] run seed
  std::string key;
  std::string group;  ///< cells of one group read the same frames
};

struct PlanRecord {
  std::string name, file;
  std::string command;                        ///< that repeats the ablation
  std::string data_use;                       ///< "tuning", "reporting" or empty
  std::vector<PlanAxis> axes;                 ///< [.] in the order of the plan
  std::vector<PlanData> data;                 ///< [.] in the order of the plan
  std::vector<std::string> sequences;         ///< sequences of all data
  std::vector<std::uint64_t> seeds;           ///< [.] run seeds
  std::vector<std::string> show;              ///< metrics that the plan wants in its table
  std::vector<PlanComparison> comparisons;    ///< [.] in the order of the plan
  std::vector<PlanExpectation> expectations;  ///< [.] in the order of the plan
  std::vector<PlanCell> cells;                ///< [.] all cells of the grid

  /// "myneighbor" of the axis `filter`, "plain" of `data`, "plain_101" of `sequence`, "1" of
  /// `seed`; empty where the plan has no such name.
  std::string value_of(const PlanCell& cell, const std::string& of) const;
  bool selects(const Selection& where, const PlanCell& cell) const;

  /// The metrics that it wants to see, or those that most plans want.
  std::vector<std::string> shown_metrics() const;
  /// All that it names or shows, each once.
  std::set<std::string> metrics() const;
};

/// As plan.json, the same bytes for the same plan.
std::string to_json(const PlanRecord& plan);

/// Reads plan.json. Fails with not_found where there is none, with invalid_data where it is
/// damaged.
Result<PlanRecord> read_plan_record(const std::string& file);

}  // namespace weft::lab
