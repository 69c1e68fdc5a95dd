// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/frame_result.hpp"

#include <algorithm>
#include <variant>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/field_reader.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/sightlines.hpp>

namespace weft {

using host::Outcome;
using host::Record;
using host::RecordPtr;

namespace {

void add_count(const Record& record, const char* array, const char* name, StageReport& report) {
  const weft_record view = record.view("");
  if (const weft_array* values = find_array(view, array)) {
    report.numbers.emplace_back(name, static_cast<double>(values->shape[0]));
  }
}

}  // namespace

const char* to_string(StageStatus status) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "skipped"};
  return kNames[static_cast<int>(status)];
}

RecordPtr FrameInput::find(std::string_view wanted) const {
  for (const auto& [slot, record] : records) {
    if (slot == wanted) return record;
  }
  return nullptr;
}

bool FrameResult::failed() const {
  return std::any_of(stages.begin(), stages.end(),
                     [](const StageReport& report) { return report.status == StageStatus::error; });
}

/// That of a scalar of any type.
double number_in(const weft_array& scalar) {
  return std::visit([](const auto& array) { return static_cast<double>(*array.data()); },
                    detail::borrow_any(scalar));
}

void add_numbers(const Record& record, StageReport& report) {
  const weft_record view = record.view("");
  if (record.type() == Keypoints::kType) add_count(record, "xy_px", "keypoints", report);
  if (record.type() == Sightlines::kType) add_count(record, "vertex", "sightlines", report);
  if (record.type() == Correspondences::kType) {
    add_count(record, "kept", "matches", report);
    const auto matches = host::arrays_of<Correspondences>(record);
    const auto kept = matches->kept.matrix<1>().template cast<double>().sum();
    report.numbers.emplace_back("kept", kept);
  }
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const weft_array& array = view.arrays[i];
    const std::string_view name = array.name;
    if (name.starts_with("diag.") && array.ndim == 0) {
      report.numbers.emplace_back(name, number_in(array));
    }
  }
}

StageReport report_of(const host::SharedText& stage, const Outcome& outcome, host::Spent here,
                      const std::shared_ptr<host::MemoryPool>& pool) {
  constexpr std::size_t kUsualNumbers = 16;
  StageReport report{stage, StageStatus::ok, {}, here, NamedNumbers(pool), false};
  report.numbers.reserve(kUsualNumbers);
  report.took.processor_ms += outcome.worker_processor_ms;
  report.worker_processor_ms = outcome.worker_processor_ms;
  if (outcome.downloaded_bytes > 0) {
    report.numbers.emplace_back("downloaded_bytes", static_cast<double>(outcome.downloaded_bytes));
  }
  if (outcome.status == WEFT_OK) return report;
  report.status = outcome.status == WEFT_DEGENERATE  ? StageStatus::degenerate
                  : outcome.status == WEFT_NO_RESULT ? StageStatus::no_result
                                                     : StageStatus::error;
  const bool is_elsewhere = report.status == StageStatus::error && !outcome.error.where.empty();
  report.reason =
      is_elsewhere ? outcome.error.where + ": " + outcome.error.message : outcome.error.message;
  report.code = outcome.error.code;
  return report;
}

host::SharedText gather(const Node& node, const FrameResult& result, CallInputs& inputs) {
  for (const InputLink& link : node.inputs) {
    const auto index = to_index(link.value);
    if (const RecordPtr& record = result.values[index]) {
      inputs.push_back(record->view(link.slot.c_str()));
    } else if (link.required) {
      return result.causes[index];
    }
  }
  return {};
}

}  // namespace weft
