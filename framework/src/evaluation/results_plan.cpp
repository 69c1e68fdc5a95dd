// SPDX-License-Identifier: Apache-2.0
#include <weft/core/quote.hpp>

#include "cell_line.hpp"
#include "json_file.hpp"
#include "results_json.hpp"

namespace weft::evaluation {
namespace {

using nlohmann::json;

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

Result<json> read_json(const std::string& file) {
  auto content = read_json_object(file);
  if (content || content.error().code != Errc::not_found) return content;
  return Error{Errc::not_found,
               "there is no such file; a results folder is what `weft ablate` writes", file};
}

Result<void> read_manifest(const std::string& file, Results& results) {
  const auto manifest = read_json(file);
  if (!manifest) return manifest.error();
  const std::string schema = text_in(*manifest, "schema");
  if (schema != kFolderSchema) {
    return Error{Errc::incompatible,
                 "the schema is " + quote(schema) + ", this program reads '" + kFolderSchema + "'",
                 file};
  }
  results.version = manifest->value("weft", "");
  results.accept_rebuilt = manifest->value("accept_rebuilt", false);
  if (const auto metrics = manifest->find("metrics"); metrics != manifest->end()) {
    results.alignment = metrics->value("alignment", results.alignment);
    results.match_tolerance_px = number_of(*metrics, "match_tolerance_px");
  }
  return {};
}

/// A text that may be null or absent.
std::string text_or_empty(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? "" : name_of(*found);
}

PlanCell plan_cell(const json& entry, const std::vector<PlanAxis>& axes) {
  PlanCell cell;
  cell.index = entry.at("cell");
  for (const PlanAxis& axis : axes) {
    cell.values.push_back(name_of(entry.at("axes").at(axis.name)));
  }
  cell.sequence = name_of(entry.at("sequence"));
  cell.seed = entry.at("seed");
  cell.key = entry.at("key");
  return cell;
}

PlanAxis plan_axis(const json& entry) {
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

PlanExpectation plan_expectation(const json& entry) {
  PlanExpectation expectation;
  for (const auto& [name, value] : entry.at("where").items()) {
    expectation.where.emplace_back(name, name_of(value));
  }
  expectation.metric = entry.at("metric");
  expectation.at_least = number_of(entry, "at_least");
  expectation.at_most = number_of(entry, "at_most");
  return expectation;
}

void fill_plan(const json& plan, Results& results) {
  results.name = plan.at("name");
  results.command = plan.value("command", "");
  results.data_use = plan.value("data_use", "");
  for (const json& axis : plan.at("axes")) {
    results.axes.push_back(plan_axis(axis));
  }
  results.sequences = names_of(plan.at("sequences"));
  results.seeds = plan.at("seeds").get<std::vector<std::uint64_t>>();
  for (const json& data : plan.value("data", json::array())) {
    for (const std::string& sequence : names_of(data.at("sequences"))) {
      results.data_of[sequence] = data.at("name");
    }
  }
  results.show = names_of(plan.value("show", json::array()));
  for (const json& one : plan.value("comparisons", json::array())) {
    results.comparisons.push_back(
        {one.at("axis"), one.at("metric"), text_or_empty(one, "reference")});
  }
  for (const json& one : plan.value("expect", json::array())) {
    results.expectations.push_back(plan_expectation(one));
  }
  for (const json& cell : plan.at("cells")) {
    results.cells.push_back(plan_cell(cell, results.axes));
  }
}

}  // namespace

double number_of(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? kUnknown : found->get<double>();
}

Result<Results> read_results_plan(const std::string& folder) {
  Results results;
  results.folder = folder;
  std::string file = folder + "/manifest.json";
  try {
    if (auto read = read_manifest(file, results); !read) return read.error();
    file = folder + "/plan.json";
    const auto plan = read_json(file);
    if (!plan) return plan.error();
    fill_plan(*plan, results);
    for (const PlanCell& cell : results.cells) {
      if (is_key(cell.key)) continue;
      return Error{
          Errc::invalid_data,
          "the key of cell " + std::to_string(cell.index) + " is not made of 32 hexadecimal digits",
          file};
    }
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, reason_of(mistake), file};
  }
  return results;
}

}  // namespace weft::evaluation
