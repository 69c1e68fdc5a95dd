// SPDX-License-Identifier: Apache-2.0
#include "host/calling/judge_shape.hpp"

#include <optional>
#include <weft/geometry/shape_evidence.hpp>

namespace weft::host {
namespace {

template <class RecordType>
std::optional<RecordType> input(std::span<const weft_record> inputs, std::string_view slot) {
  for (const weft_record& record : inputs) {
    if (record.slot != slot) continue;
    auto typed = read_arrays<RecordType>(record);
    if (typed) return *std::move(typed);
  }
  return std::nullopt;
}

void set_number(Record& record, const char* name, double value) {
  void* const target = record.allocate(name, WEFT_F64, 0, nullptr);
  if (target != nullptr) *static_cast<double*>(target) = value;
}

}  // namespace

void judge_shape(Record& shape, std::span<const weft_record> inputs, EvidenceMemory& memory) {
  const auto solved = arrays_of<Shape>(shape);
  const auto templ = input<Template>(inputs, "template");
  const auto camera = input<Camera>(inputs, "camera");
  if (!solved || !templ || !camera) return;
  if (solved->vertices_m.rows() != templ->vertices_m.rows()) return;  // check_lengths() refuses it
  const ShapeEvidence evidence = shape_evidence(*templ, *camera, solved->vertices_m,
                                                input<Correspondences>(inputs, "correspondences"),
                                                input<Sightlines>(inputs, "sightlines"), &memory);
  if (solved->shape_state() == ShapeState::estimated) {
    const ShapeState state = state_of(evidence, solved->confidence);
    *static_cast<std::int32_t*>(find_array(shape.view(""), "state")->data) =
        static_cast<std::int32_t>(state);
  }
  set_number(shape, "diag.agreeing_matches", evidence.agreeing);
  set_number(shape, "diag.kept_matches", evidence.kept);
  set_number(shape, "diag.agreeing_coverage", evidence.coverage);
}

}  // namespace weft::host
