// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/workers/recipe.hpp"

/// The messages between host and worker. Arrays stay in shared memory: messages contain offsets.
namespace weft::host {

/// An array in shared memory.
struct PlacedArray {
  std::string name;
  std::int32_t dtype = 0, ndim = 0;  ///< weft_dtype; number of axes
  std::array<std::int64_t, WEFT_MAX_DIMENSIONS> shape{},
      stride{};              ///< [ndim] elements; [ndim] bytes
  std::uint64_t offset = 0;  ///< [bytes]

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.name), visit(self.dtype), visit(self.ndim), visit(self.offset);
    for (auto& length : self.shape) visit(length);
    for (auto& step : self.stride) visit(step);
  }
};

/// A record whose arrays are in shared memory.
struct PlacedRecord {
  std::string slot, type;
  std::uint64_t revision = 0, producer = 0;  ///< as in weft_record
  std::int64_t frame = WEFT_NO_FRAME;        ///< index, or WEFT_NO_FRAME
  std::vector<PlacedArray> arrays;           ///< [.] all arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.slot), visit(self.type), visit(self.revision), visit(self.producer);
    visit(self.frame), visit(self.arrays);
  }
};

enum class MessageKind : std::uint32_t { hello = 1, create, prepare, process, log, reply };

/// The first message: the caller, the offset of the cancel flag in the host's memory, and the
/// number of threads for a call.
struct HelloMessage {
  std::string version;
  std::uint64_t run_seed = 0, inputs_reserve_bytes = 0, outputs_reserve_bytes = 0;
  std::uint64_t cancel_offset = 0;  ///< [bytes] of the cancel flag in shared memory
  std::int32_t threads = 1;         ///< [] maximum number of threads per call

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.version), visit(self.run_seed), visit(self.inputs_reserve_bytes);
    visit(self.outputs_reserve_bytes), visit(self.cancel_offset), visit(self.threads);
  }
};

/// A component that the worker shall have, under the handle that it has in the host.
struct CreateMessage {
  std::uint64_t handle = 0;  ///< handle of the component in the host
  std::string stage, path;
  Recipe recipe;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.handle), visit(self.stage), visit(self.path), visit(self.recipe);
  }
};

/// A call of prepare, or of a method.
struct CallMessage {
  std::uint64_t handle = 0, frame = 0, draw = 0;  ///< as in weft_invocation
  std::int32_t method = 0;                        ///< [] number of the method in its role
  std::vector<PlacedRecord> inputs;               ///< [.] input records
  std::vector<std::uint64_t> returned;   ///< offsets of output arrays that the host has done with
  std::int64_t deadline_ns = INT64_MAX;  ///< [ns] of the steady clock: see ExecutionContext::call

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.handle), visit(self.frame), visit(self.draw), visit(self.method);
    visit(self.inputs);
    visit(self.returned), visit(self.deadline_ns);
  }
};

struct LogMessage {
  std::string component, text;
  std::int32_t level = 0;   ///< 0 debug, 1 info, 2 warning
  std::uint64_t frame = 0;  ///< [] index of the frame

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.component), visit(self.text), visit(self.level), visit(self.frame);
  }
};

struct PlacedTiming {
  std::string component, method;
  std::int64_t start_ns = 0;            ///< [ns] of the steady clock, which is the machine's
  double ms = 0.0, processor_ms = 0.0;  ///< see Spent
  std::int32_t status = WEFT_OK;        ///< weft_status
  std::uint64_t downloaded_bytes = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.component), visit(self.method), visit(self.start_ns), visit(self.ms);
    visit(self.processor_ms), visit(self.status), visit(self.downloaded_bytes);
  }
};

/// The answer to any of them but log.
struct ReplyMessage {
  std::int32_t status = WEFT_OK, code = 0;  ///< weft_status; weft_code
  std::string message, where, subject;
  std::vector<PlacedRecord> outputs;  ///< [.] output records
  std::vector<PlacedTiming> timings;  ///< times of the components nested in the called one
  std::uint64_t downloaded_bytes = 0;
  double processor_ms = 0.0;  ///< [] ms that this process spent on the call

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.status), visit(self.code), visit(self.message), visit(self.where),
        visit(self.subject);
    visit(self.outputs), visit(self.timings), visit(self.downloaded_bytes);
    visit(self.processor_ms);
  }
};

}  // namespace weft::host
