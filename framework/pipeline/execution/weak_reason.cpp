// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/weak_reason.hpp"

#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/field_reader.hpp>
#include <weft/geometry/shape_evidence.hpp>

namespace weft {
namespace {

/// A number among the diagnostics of a shape; NaN if it is absent.
double diagnostic(const weft_record& shape, const char* name) {
  const weft_array* array = find_array(shape, name);
  if (array == nullptr || array->dtype != WEFT_F64 || array->ndim != 0) return std::nan("");
  return *static_cast<const double*>(array->data);
}

/// The count that shape_evidence() requires: of matches if the solver read some, else of
/// sightlines.
int needed_by(const Node& solver, const FrameResult& result) {
  int needed = 0;
  for (const InputLink& link : solver.inputs) {
    if (result.values[to_index(link.value)] == nullptr) continue;
    if (link.slot == "correspondences") return kNeededMatches;
    if (link.slot == "sightlines") needed = kNeededSightlines;
  }
  return needed;
}

}  // namespace

std::string weak_reason(const Graph& graph, const FrameResult& result, int value) {
  const host::RecordPtr& shape = result.values[to_index(value)];
  const int stage = graph.values[to_index(value)].stage;
  if (shape == nullptr || stage < 0) return {};
  const weft_record record = shape->view("");
  const double agreeing = diagnostic(record, "diag.agreeing_matches");
  const double kept = diagnostic(record, "diag.kept_matches");
  const double coverage = diagnostic(record, "diag.agreeing_coverage");
  ShapeEvidence evidence;
  if (std::isfinite(agreeing) && std::isfinite(kept) && std::isfinite(coverage)) {
    evidence = {static_cast<int>(kept), static_cast<int>(agreeing), coverage,
                needed_by(graph.stages[to_index(stage)], result)};
  }
  return why_weak(evidence, diagnostic(record, "confidence"));
}

}  // namespace weft
