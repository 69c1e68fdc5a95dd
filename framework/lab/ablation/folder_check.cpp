// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/folder_check.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <weft/core/quote.hpp>

#include "lab/metrics/runs/json_file.hpp"
#include "lab/results/cell_line.hpp"
#include "lab/results/checked_document.hpp"
#include "lab/results/result_lines.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A new folder, or one in which a process was killed before it had written the manifest.
bool is_fresh(const std::string& path) {
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(path, code)) {
    const bool empty_folder = entry.is_directory(code) && fs::is_empty(entry.path(), code);
    const std::string name = entry.path().filename().string();
    const bool passing = name.find(".part") != std::string::npos || name == ".lock";
    if (!passing && !empty_folder) return false;
  }
  return true;
}

bool has_lines(const std::string& path) {
  bool any = false;
  const TakeLine take = [&any](const LinePlace&, const json&) {
    any = true;
    return Result<void>();
  };
  return read_result_lines(path, {false, false}, take) && any;
}

/// A folder that `weft ablate` has made, whatever became of its manifest: it has finished cells, or
/// nothing but what `weft ablate` writes.
bool is_of_ablation(const std::string& path) {
  std::error_code code;
  if (!fs::is_directory(path + "/results", code)) return false;
  if (has_lines(path)) return true;
  static constexpr std::array kOurs{"results", "cells",        "manifest.json", "plan.json",
                                    "log.txt", "index.sqlite", "slurm",         ".lock"};
  for (const auto& entry : fs::directory_iterator(path, code)) {
    const std::string name = entry.path().filename().string();
    const bool passing = name.find(".part") != std::string::npos;
    if (!passing && std::find(kOurs.begin(), kOurs.end(), name) == kOurs.end()) return false;
  }
  return fs::is_directory(path + "/cells", code);
}

Error of_another_plan(const std::string& path, const std::string& of, const std::string& plan) {
  return {Errc::invalid_value,
          "holds the results of the plan " + quote(of) + ", and this plan is " + quote(plan) +
              "; choose another folder with --out, or give the plan its name back",
          path};
}

std::string written_anew(const std::string& file, const Error& error) {
  const std::string fault = error.code == Errc::not_found ? "is missing" : error.message;
  return file + ": " + fault + "; it is written anew, and finished cells stay";
}

Result<std::vector<std::string>> check_without_manifest(const std::string& path,
                                                        const std::string& plan,
                                                        const Error& fault) {
  const bool is_missing = fault.code == Errc::not_found;
  if (is_missing && is_fresh(path)) return std::vector<std::string>();
  if (!is_of_ablation(path)) {
    if (!is_missing) return fault;
    return Error{Errc::invalid_value,
                 "is neither empty nor a results folder; choose another with --out", path};
  }
  std::vector<std::string> rebuilt{written_anew(path + "/manifest.json", fault)};
  const std::string file = path + "/plan.json";
  const auto known = read_json_object(file);
  if (!known) rebuilt.push_back(written_anew(file, known.error()));
  const std::string of = known ? text_in(*known, "name") : plan;
  if (of != plan) return of_another_plan(path, of, plan);
  return rebuilt;
}

}  // namespace

Result<std::vector<std::string>> check_results_folder(const std::string& path,
                                                      const std::string& plan) {
  const std::string file = path + "/manifest.json";
  const auto manifest = read_json_object(file);
  if (!manifest) {
    const Errc code = manifest.error().code;
    if (code != Errc::not_found && code != Errc::invalid_data) return manifest.error();
    return check_without_manifest(path, plan, manifest.error());
  }
  const std::string schema = text_in(*manifest, "schema");
  if (schema != kFolderSchema) {
    return Error{Errc::invalid_value,
                 "has the schema " + quote(schema) + ", this program writes '" + kFolderSchema +
                     "'; choose another folder with --out",
                 file};
  }
  if (const auto same = compare_check(*manifest, file); !same) {
    return Error{Errc::invalid_value,
                 same.error().message + "; put it back, or choose another folder with --out", file};
  }
  const std::string of = manifest->contains("plan") ? text_in(*manifest, "plan") : plan;
  if (of != plan) return of_another_plan(path, of, plan);
  const std::string record = path + "/plan.json";
  const auto known = read_json_object(record);
  std::vector<std::string> rebuilt;
  if (!known && has_lines(path)) rebuilt.push_back(written_anew(record, known.error()));
  return rebuilt;
}

}  // namespace weft::lab
