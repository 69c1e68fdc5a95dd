// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lab/statistics/better.hpp"

/// How metrics are declared. A struct of metrics tells its members once, in their order, in
///
///   template <class Self, class Visit>
///   static void fields(Self& self, Visit&& visit) {
///     visit({"mean_mm", "mean over the points", Better::lower, "mean"}, self.mean_mm);
///   }
///
/// JSON both ways, the CSV file, columns of tables, the paths of `metric:`, which way a metric is
/// better and docs/metrics.md follow from it. A member is a number, a text, an enumeration, a list
/// of numbers or texts, a struct of metrics, or a list of such structs, told apart by their
/// `stage`, `kind` or `part`. A visitor has, besides operator(),
///
///   derived(field, value)           what follows from other members, so that no reader takes it
///   object(field, there, f)         members of some frames, in an object of their own in JSON
///   when(there, f)                  members of some frames: f(visit)
///   optional(member)                the members of a struct that some frames lack
///   keyed(field, pairs)             structs by the name of their stage or part
namespace weft::lab {

/// Of a share of 1.
inline constexpr double kPercent = 100.0;
inline constexpr double kMmPerM = 1000.0;

struct MetricField {
  const char* name;     ///< in files and paths; it ends in the unit: "mean_mm", "tpr_percent"
  const char* meaning;  ///< half a sentence
  std::optional<Better> better = std::nullopt;  ///< direction of improvement, if any
  const char* column = nullptr;  ///< title in the tables of the program, which leave out the rest;
                                 ///< a struct with one, even empty, has its own columns in them
  int decimals = 2;              ///< of a number there
  double factor = 1.0;           ///< from the member to what is written; 100 for a share of 1
  bool or_null = false;          ///< an empty text is null in JSON
};

inline constexpr auto kLower = Better::lower;
inline constexpr auto kHigher = Better::higher;

template <class T>
concept MetricStruct = requires(T& metrics, int& visit) {
  T::fields(metrics, visit);
};

}  // namespace weft::lab
