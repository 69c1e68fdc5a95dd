// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// What a frame came to before its sinks: states, reasons, times and counts of all stages.
struct FrameReport {
  static constexpr const char* kType = "frame_report/1";
  std::string json;    ///< [n] one object, as its line in frames.jsonl but for what sinks add
  Others others = {};  ///< what else the record has

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.json, Field{"json", "*", "", "one JSON object, as in frames.jsonl, without sinks"});
  }
};

/// The stages of a run, with what each of their parameters may be and now is.
struct RunSettings {
  static constexpr const char* kType = "run_settings/1";
  std::string json;  ///< [n] one object, see docs/pipelines.md
  std::uint64_t revision =
      0;               ///< [] another one when a parameter has changed; filled in by the host
  Others others = {};  ///< what else the record has

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.json, Field{"json", "*", "", "one JSON object: stages, their parameters"});
  }
};

}  // namespace weft
