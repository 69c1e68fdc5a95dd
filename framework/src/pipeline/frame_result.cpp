// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/pipeline/frame_result.hpp>

namespace weft {

using host::Outcome;
using host::RecordPtr;

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

StageReport report_of(const std::string& stage, const Outcome& outcome, double ms) {
  StageReport report{stage, StageStatus::ok, {}, ms, {}, false};
  if (outcome.status == WEFT_OK) return report;
  report.status = outcome.status == WEFT_DEGENERATE  ? StageStatus::degenerate
                  : outcome.status == WEFT_NO_RESULT ? StageStatus::no_result
                                                     : StageStatus::error;
  report.reason = outcome.error.message;
  if (report.status == StageStatus::error && !outcome.error.where.empty()) {
    report.reason = outcome.error.where + ": " + report.reason;
  }
  return report;
}

std::string gather(const Node& node, const FrameResult& result, std::vector<weft_record>& inputs) {
  for (const InputLink& link : node.inputs) {
    const auto index = static_cast<std::size_t>(link.value);
    if (const RecordPtr& record = result.values[index]) {
      inputs.push_back(record->view(link.slot.c_str()));
    } else if (link.required) {
      return result.causes[index];
    }
  }
  return {};
}

}  // namespace weft
