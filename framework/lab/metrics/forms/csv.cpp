// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <type_traits>
#include <weft/core/csv_field.hpp>
#include <weft/core/whole_file.hpp>

#include "lab/metrics/forms/metrics_report.hpp"

namespace weft::lab {
namespace {

/// Fields of a frame by the names of their columns, in the order in which they are first met.
struct Columns {
  std::vector<std::string> names;
  std::map<std::string, std::string> fields;  ///< fields of the last visited frame

  void put(const std::string& name, std::string field) {
    if (!fields.contains(name)) names.push_back(name);
    fields[name] = std::move(field);
  }
};

/// With `there` false a column is named and its field left empty.
class CsvWriter {
 public:
  explicit CsvWriter(Columns& columns, bool there = true, std::string prefix = {})
      : columns_(columns), there_(there), prefix_(std::move(prefix)) {}

  template <class Member>
  void operator()(const MetricField& field, const Member& member) {
    if constexpr (MetricStruct<const Member>) {
      CsvWriter inner(columns_, there_, prefix_ + field.name + "_");
      Member::fields(member, inner);
    } else {
      columns_.put(prefix_ + field.name, there_ ? text_of(field, member) : "");
    }
  }

  template <class Member>
  void derived(const MetricField& field, const Member& member) {
    (*this)(field, member);
  }

  template <class Metrics>
  void derived(const MetricField& field, const std::optional<Metrics>& metrics) {
    CsvWriter inner(columns_, there_ && metrics, prefix_ + field.name + "_");
    const Metrics given = metrics.value_or(Metrics{});
    Metrics::fields(given, inner);
  }

  /// Members of a nested JSON object have no prefix here.
  template <class Members>
  void object(const MetricField& /*field*/, bool there, Members&& members) {
    when(there, members);
  }

  template <class Members>
  void when(bool there, Members&& members) {
    CsvWriter inner(columns_, there_ && there, prefix_);
    members(inner);
  }

  template <class Metrics>
  void optional(const std::optional<Metrics>& metrics) {
    CsvWriter inner(columns_, there_ && metrics, prefix_);
    const Metrics given = metrics.value_or(Metrics{});
    Metrics::fields(given, inner);
  }

  template <class Metrics>
  void keyed(const MetricField& /*field*/,
             const std::vector<std::pair<std::string, Metrics>>& pairs) {
    for (const auto& [stage, metrics] : pairs) {
      CsvWriter inner(columns_, there_, prefix_ + stage + "_");
      Metrics::fields(metrics, inner);
    }
  }

 private:
  template <class Member>
  static std::string text_of(const MetricField& field, const Member& member) {
    if constexpr (std::is_same_v<Member, bool>) {
      return member ? "1" : "0";
    } else if constexpr (std::is_enum_v<Member>) {
      return to_string(member);
    } else if constexpr (std::is_floating_point_v<Member>) {
      return std::isfinite(member) ? fmt::format("{:.9g}", field.factor * member) : "";
    } else if constexpr (std::is_integral_v<Member>) {
      return std::to_string(member);
    } else {
      return csv_field(member);
    }
  }

  Columns& columns_;
  bool there_;
  std::string prefix_;
};

std::string row_of(const std::vector<std::string>& fields) {
  std::string row;
  for (const std::string& field : fields) row += (row.empty() ? "" : ",") + field;
  return row + "\n";
}

}  // namespace

std::string to_csv(const RunMetrics& metrics) {
  Columns columns;
  std::vector<std::map<std::string, std::string>> rows;
  CsvWriter writer(columns);
  for (const FrameMetrics& frame : metrics.frames) {
    for (auto& [name, field] : columns.fields) field.clear();
    FrameMetrics::fields(frame, writer);
    writer({"alignment", "of the 3D errors"}, metrics.alignment);
    rows.push_back(columns.fields);
  }
  const FrameMetrics none;
  if (rows.empty()) FrameMetrics::fields(none, writer);
  std::vector<std::string> fields;
  for (const std::string& name : columns.names) fields.push_back(csv_field(name));
  std::string text = row_of(fields);
  for (auto& row : rows) {
    fields.clear();
    for (const std::string& name : columns.names) fields.push_back(row[name]);
    text += row_of(fields);
  }
  return text;
}

Result<void> write_csv(const RunMetrics& metrics, const std::string& file) {
  return write_whole(to_csv(metrics), file);
}

}  // namespace weft::lab
