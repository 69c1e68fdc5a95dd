// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "metrics/field.hpp"

namespace weft::evaluation {

/// A number that `metric:` may name, or that a frame has.
struct CatalogueEntry {
  std::string path;  ///< "all.error_solved.mean_mm", "filters.STAGE.tpr_percent"
  MetricField field;
};

/// The numbers of a run, by their paths; KIND and STAGE stand for names.
std::vector<CatalogueEntry> run_catalogue();
/// The numbers of a frame, by the names of their columns in the CSV file.
std::vector<CatalogueEntry> frame_catalogue();

/// The declaration of the number that a path names, with the name of a stage or kind or without it;
/// null where there is none.
const MetricField* field_of(const std::string& path);

/// "mm" of "mean_mm", "%" of "tpr_percent"; empty for counts.
std::string unit_of(const std::string& path);

/// Markdown tables of both catalogues: part of docs/metrics.md.
std::string metrics_page();

}  // namespace weft::evaluation
