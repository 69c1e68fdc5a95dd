// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "lab/metrics/forms/every_declaration.hpp"
#include "lab/metrics/forms/table_parts.hpp"

namespace weft::lab {

/// The titles of the members that have a column, or their values as people read them.
class TableColumns : public EveryDeclaration<TableColumns> {
 public:
  enum class What { titles, values };

  TableColumns(What what, TableRow& row) : what_(what), row_(row) {}

  template <class Member>
  void operator()(const MetricField& field, const Member& member) {
    if (field.column == nullptr) return;
    if constexpr (MetricStruct<const Member>) {
      Member::fields(member, *this);
    } else {
      row_.push_back(what_ == What::titles ? field.column : text_of(field, member));
    }
  }

  using EveryDeclaration::derived;
  template <class Value>
  void derived(const MetricField& /*field*/, const std::optional<Value>& /*value*/) {}

  template <class Metrics>
  void optional(const std::optional<Metrics>& metrics) {
    const Metrics given = metrics.value_or(Metrics{});
    Metrics::fields(given, *this);
  }

  template <class Pairs>
  void keyed(const MetricField& /*field*/, const Pairs& /*pairs*/) {}

 private:
  template <class Member>
  static std::string text_of(const MetricField& field, const Member& member) {
    if constexpr (std::is_floating_point_v<Member>) {
      return decimal(field.factor * member, field.decimals);
    } else if constexpr (std::is_integral_v<Member>) {
      return std::to_string(member);
    } else if constexpr (std::is_same_v<Member, std::string>) {
      return member.empty() ? kNoValue : printable(member);
    } else {
      return kNoValue;
    }
  }

  What what_;
  TableRow& row_;
};

/// Behind the cells of `start`.
template <class Metrics>
TableRow titles_of(TableRow start = {}) {
  const Metrics any{};
  TableColumns columns(TableColumns::What::titles, start);
  Metrics::fields(any, columns);
  return start;
}

template <class Metrics>
TableRow values_of(const Metrics& metrics, TableRow start = {}) {
  TableColumns columns(TableColumns::What::values, start);
  Metrics::fields(metrics, columns);
  return start;
}

}  // namespace weft::lab
