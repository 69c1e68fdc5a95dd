// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lab/statistics/better.hpp"

/// Declarations of metrics. A struct of metrics lists its members once, in their order, in
///
///   template <class Self, class Visit>
///   static void fields(Self& self, Visit&& visit) {
///     visit({"mean_mm", "mean over the points", Better::lower, "mean"}, self.mean_mm);
///   }
///
/// JSON in both directions, the CSV file, columns of tables, the paths of `metric:`, the better
/// direction of a metric and docs/metrics.md follow from it. A member is a number, a text, an
/// enumeration, a list of numbers or texts, a struct of metrics, or a list of such structs. The
/// `stage`, `kind` or `part` of a struct identifies it in a list. A visitor has, besides
/// operator(),
///
///    derived(field, value)           a value computed from other members, which readers ignore
///    object(field, there, f)         members of some frames, in a nested object in JSON
///    when(there, f)                  members of some frames: f(visit)
///    optional(member)                the members of a struct that some frames lack
///    keyed(field, pairs)             structs by the name of their stage or part
namespace weft::lab {

/// Converts a share of 1.
inline constexpr double kPercent = 100.0;
inline constexpr double kMmPerM = 1000.0;

struct MetricField {
  const char* name;     ///< in files and paths; it ends in the unit: "mean_mm", "tpr_percent"
  const char* meaning;  ///< half a sentence
  std::optional<Better> better = std::nullopt;  ///< direction of improvement, if any
  const char* column = nullptr;  ///< title in the tables of the program, which omit members without
                                 ///< one; a struct with a title, even an empty one, has its own
                                 ///< columns
  int decimals = 2;              ///< decimals of a number in a table
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
