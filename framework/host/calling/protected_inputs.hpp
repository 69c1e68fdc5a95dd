// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstddef>
#include <span>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

/// Read-only copies of the inputs of one call, followed by memory that cannot be read. A component
/// that writes into its inputs, reads beyond them or keeps them causes a fault at that access.
class ProtectedInputs {
 public:
  ProtectedInputs() = default;
  ~ProtectedInputs();
  ProtectedInputs(const ProtectedInputs&) = delete;
  ProtectedInputs& operator=(const ProtectedInputs&) = delete;

  /// Records of the same content, which live as long as this; what lies in device memory stays
  /// where it is. Fails with no_memory.
  Result<std::span<const weft_record>> copy(std::span<const weft_record> inputs);

 private:
  Result<void> protect(const weft_record& record, weft_array& array);

  struct Pages {
    std::byte* start;
    std::size_t bytes;  ///< [bytes] length
  };
  std::vector<Pages> pages_;
  std::vector<std::vector<weft_array>> arrays_;
  std::vector<weft_record> records_;
};

/// Where an address lies in protected inputs.
struct ProtectedPlace {
  const char* input;  ///< "correspondences/kept"; null where it does not
  bool beyond;        ///< in what cannot be read, behind its end
};

/// For handlers of signals: of the inputs that are protected now.
ProtectedPlace protected_place(const void* address);

}  // namespace weft::host
