// SPDX-License-Identifier: Apache-2.0
#include "lab/results/plan_record.hpp"

#include <algorithm>
#include <cmath>

#include "lab/metrics/runs/json_file.hpp"
#include "lab/results/cell_line.hpp"
#include "lab/results/checked_document.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json axis_json(const PlanAxis& axis) {
  ordered_json object{{"name", axis.name}, {"values", axis.values}};
  if (axis.swept.empty()) return object;
  object["swept"] = axis.swept;
  object["numbers"] = axis.numbers;
  if (!axis.families.empty()) object["families"] = axis.families;
  return object;
}

ordered_json cell_json(const PlanCell& cell, const std::vector<PlanAxis>& axes) {
  ordered_json values = ordered_json::object();
  for (std::size_t i = 0; i < axes.size(); ++i) values[axes[i].name] = cell.values[i];
  return {{"cell", cell.index}, {"axes", std::move(values)}, {"sequence", cell.sequence},
          {"seed", cell.seed},  {"key", cell.key},           {"group", cell.group}};
}

ordered_json expectation_json(const PlanExpectation& expectation) {
  ordered_json where = ordered_json::object();
  for (const auto& [name, value] : expectation.where) where[name] = value;
  ordered_json entry{{"where", std::move(where)}, {"metric", expectation.metric}};
  if (!std::isnan(expectation.at_most)) entry["at_most"] = expectation.at_most;
  if (!std::isnan(expectation.at_least)) entry["at_least"] = expectation.at_least;
  return entry;
}

ordered_json comparison_json(const PlanComparison& comparison) {
  ordered_json entry{
      {"axis", comparison.axis}, {"reference", nullptr}, {"metric", comparison.metric}};
  if (!comparison.reference.empty()) entry["reference"] = comparison.reference;
  return entry;
}

/// The name of an axis value, a sequence or the like: a text, a plain value, or an object's name.
std::string name_of(const json& value) {
  if (value.is_object()) return name_of(value.at("name"));
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::vector<std::string> names_of(const json& values) {
  std::vector<std::string> names;
  for (const json& value : values) names.push_back(name_of(value));
  return names;
}

/// A text that may be null or absent.
std::string text_or_empty(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? "" : name_of(*found);
}

PlanCell cell_from(const json& entry, const std::vector<PlanAxis>& axes) {
  PlanCell cell;
  cell.index = entry.at("cell");
  for (const PlanAxis& axis : axes) {
    cell.values.push_back(name_of(entry.at("axes").at(axis.name)));
  }
  cell.sequence = name_of(entry.at("sequence"));
  cell.seed = entry.at("seed");
  cell.key = entry.at("key");
  cell.group = text_in(entry, "group");
  return cell;
}

PlanAxis axis_from(const json& entry) {
  PlanAxis axis{entry.at("name"), names_of(entry.at("values")), entry.value("swept", ""), {}, {}};
  if (axis.swept.empty()) return axis;
  for (const json& number : entry.at("numbers")) {
    axis.numbers.push_back(number.is_null() ? kUnknown : number.get<double>());
  }
  axis.numbers.resize(axis.values.size(), kUnknown);
  if (entry.contains("families")) {
    axis.families = names_of(entry.at("families"));
    axis.families.resize(axis.values.size());
  }
  return axis;
}

PlanExpectation expectation_from(const json& entry) {
  PlanExpectation expectation;
  for (const auto& [name, value] : entry.at("where").items()) {
    expectation.where.emplace_back(name, name_of(value));
  }
  expectation.metric = entry.at("metric");
  expectation.at_least = number_of(entry, "at_least");
  expectation.at_most = number_of(entry, "at_most");
  return expectation;
}

PlanRecord plan_from(const json& object) {
  PlanRecord plan;
  plan.name = object.at("name");
  plan.file = text_in(object, "file");
  plan.command = object.value("command", "");
  plan.data_use = object.value("data_use", "");
  for (const json& axis : object.at("axes")) plan.axes.push_back(axis_from(axis));
  for (const json& data : object.value("data", json::array())) {
    plan.data.push_back({data.at("name"), names_of(data.at("sequences"))});
  }
  plan.sequences = names_of(object.at("sequences"));
  plan.seeds = object.at("seeds").get<std::vector<std::uint64_t>>();
  plan.show = names_of(object.value("show", json::array()));
  for (const json& one : object.value("comparisons", json::array())) {
    plan.comparisons.push_back({one.at("axis"), one.at("metric"), text_or_empty(one, "reference")});
  }
  for (const json& one : object.value("expect", json::array())) {
    plan.expectations.push_back(expectation_from(one));
  }
  for (const json& cell : object.at("cells")) plan.cells.push_back(cell_from(cell, plan.axes));
  return plan;
}

}  // namespace

std::string PlanRecord::value_of(const PlanCell& cell, const std::string& of) const {
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (axes[axis].name == of) return cell.values[axis];
  }
  if (of == "sequence") return cell.sequence;
  if (of == "seed") return std::to_string(cell.seed);
  if (of != "data") return "";
  for (const PlanData& each : data) {
    const std::vector<std::string>& all = each.sequences;
    if (std::find(all.begin(), all.end(), cell.sequence) != all.end()) return each.name;
  }
  return "";
}

bool PlanRecord::selects(const Selection& where, const PlanCell& cell) const {
  return std::all_of(where.begin(), where.end(), [&](const auto& condition) {
    return value_of(cell, condition.first) == condition.second;
  });
}

std::vector<std::string> PlanRecord::shown_metrics() const {
  if (!show.empty()) return show;
  return {"all.error_solved.mean_mm", "counts.solved_percent"};
}

std::set<std::string> PlanRecord::metrics() const {
  const std::vector<std::string> shown = shown_metrics();
  std::set<std::string> named(shown.begin(), shown.end());
  for (const PlanComparison& comparison : comparisons) named.insert(comparison.metric);
  for (const PlanExpectation& expectation : expectations) named.insert(expectation.metric);
  return named;
}

std::string to_json(const PlanRecord& plan) {
  ordered_json axes = ordered_json::array(), data = ordered_json::array();
  ordered_json cells = ordered_json::array();
  ordered_json comparisons = ordered_json::array(), expect = ordered_json::array();
  for (const PlanAxis& axis : plan.axes) axes.push_back(axis_json(axis));
  for (const PlanData& each : plan.data) {
    data.push_back({{"name", each.name}, {"sequences", each.sequences}});
  }
  for (const PlanCell& cell : plan.cells) cells.push_back(cell_json(cell, plan.axes));
  for (const PlanComparison& each : plan.comparisons) comparisons.push_back(comparison_json(each));
  for (const PlanExpectation& each : plan.expectations) expect.push_back(expectation_json(each));
  ordered_json object{{"name", plan.name},
                      {"file", plan.file},
                      {"command", plan.command},
                      {"data_use", plan.data_use},
                      {"axes", std::move(axes)},
                      {"sequences", plan.sequences},
                      {"data", std::move(data)},
                      {"seeds", plan.seeds},
                      {"show", plan.show},
                      {"cells", std::move(cells)},
                      {"comparisons", std::move(comparisons)},
                      {"expect", std::move(expect)}};
  return checked_document(std::move(object), 1);
}

Result<PlanRecord> read_plan_record(const std::string& file) {
  const auto object = read_json_object(file);
  if (!object) return object.error();
  if (const auto same = compare_check(*object, file); !same) {
    return same.error();
  }
  try {
    PlanRecord plan = plan_from(*object);
    for (const PlanCell& cell : plan.cells) {
      if (is_key(cell.key)) continue;
      return Error{
          Errc::invalid_data,
          "the key of cell " + std::to_string(cell.index) + " is not made of 32 hexadecimal digits",
          file};
    }
    return plan;
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, reason_of(mistake), file};
  }
}

}  // namespace weft::lab
