// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Report on a frame before its sinks: states, reasons, times and counts of all stages.
struct FrameReport {
  static constexpr const char* kType = "frame_report/1";
  std::string json;  ///< [n] one JSON object, the line of frames.jsonl without the entries of sinks
  Others others = {};  ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.json, Field{"json", "*", "", "one JSON object, as in frames.jsonl, without sinks"});
  }
};

/// The stages of a run with the legal and the current values of their parameters.
struct RunSettings {
  static constexpr const char* kType = "run_settings/1";
  std::string json;            ///< [n] one JSON object, see docs/pipelines.md
  std::uint64_t revision = 0;  ///< [] changes with every parameter change; set by the host
  Others others = {};          ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.json, Field{"json", "*", "", "one JSON object: stages, their parameters"});
  }
};

}  // namespace weft
