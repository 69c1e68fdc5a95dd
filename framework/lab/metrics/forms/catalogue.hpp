// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/metrics/field.hpp"

namespace weft::lab {

/// A number that `metric:` may name, or that a frame has.
struct CatalogueEntry {
  std::string path;  ///< "all.error_solved.mean_mm", "filters.STAGE.tpr_percent"
  MetricField field;
};

/// The numbers of a run, by their paths; KIND, PART and STAGE stand for names.
std::vector<CatalogueEntry> run_catalogue();
/// The numbers of a frame, by the names of their columns in the CSV file.
std::vector<CatalogueEntry> frame_catalogue();

/// The declaration of the number that a path names, with the name of a stage, kind or part or
/// without it; null where there is none.
const MetricField* field_of(const std::string& path);

/// The same with its path, and the name of the stage or kind, if the path has one: "aem" of
/// "filters.aem.tpr_percent".
struct FoundEntry {
  const CatalogueEntry* entry = nullptr;  ///< null where there is none
  std::string label;
};

FoundEntry entry_of(const std::string& path);

/// The readable name of the number at a path, without its unit: "mean 3D error", "matches kept,
/// aem"; the path itself if there is no such number.
std::string metric_name(const std::string& path);
/// "mean 3D error, mm".
std::string metric_heading(const std::string& path);
/// The ends of paths that have such a name in the list, for a test of the list.
std::vector<std::string> named_endings();

/// "mm" of "mean_mm", "%" of "tpr_percent"; empty for counts.
std::string unit_of(const std::string& path);

/// Markdown tables of both catalogues: part of docs/metrics.md.
std::string metrics_page();

}  // namespace weft::lab
