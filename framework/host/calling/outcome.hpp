// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>

#include "host/calling/stopwatch.hpp"
#include "host/records/record.hpp"
#include "host/records/shared_text.hpp"

namespace weft::host {

/// The outcome of a component's call.
struct Outcome {
  weft_status status = WEFT_OK;
  Error error;                         ///< for degenerate its message is the reason
  NamedRecords outputs;                ///< by slot
  std::uint64_t downloaded_bytes = 0;  ///< fetched from device memory for it and those nested in it
  double worker_processor_ms = 0.0;    ///< [] ms that workers spent on it and those nested in it

  bool usable() const { return status == WEFT_OK || status == WEFT_DEGENERATE; }
  RecordPtr find(std::string_view slot) const;
};

/// The frame number of calls that belong to no frame.
inline constexpr std::uint64_t kOfflineFrame = ~std::uint64_t{0};

/// One call of a component, nested ones included in its time.
struct Timing {
  SharedText component;  ///< "filters", "filters/warp": stage name and nested path
  Spent took;
  std::chrono::steady_clock::time_point start{};
  std::string method;                   ///< as its role calls it: "fit", "evaluate"
  std::uint64_t frame = kOfflineFrame;  ///< [] index of the frame
  weft_status status = WEFT_OK;
  SharedText worker;                   ///< the stage in whose worker it ran; empty for this process
  std::uint64_t downloaded_bytes = 0;  ///< see Outcome
};
using Timings = PooledVector<Timing>;

}  // namespace weft::host
