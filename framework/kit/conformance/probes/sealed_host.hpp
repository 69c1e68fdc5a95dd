// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "kit/conformance/probes/passages.hpp"

namespace weft::conformance {

/// Copies the structs of each call into memory that can only be read, and that cannot be used once
/// the call has returned. A component that writes into them or keeps them causes a fault at that
/// access.
class SealedHost final : public testing::Passage {
 public:
  SealedHost();
  ~SealedHost() override;
  std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;
  std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                       std::span<const weft_record> inputs, weft_error* error) override;

 private:
  class Pages;
  class Sealed;
  template <class Call>
  std::int32_t sealed(const weft_call& call, std::span<const weft_record> inputs, Call&& then);

  std::vector<std::unique_ptr<Pages>> left_;  ///< pages of calls that have returned
};

/// Where an address lies in memory of a SealedHost.
struct SealedPlace {
  const char* what = nullptr;  ///< "its weft_call"; null where it lies elsewhere
  bool is_left = false;        ///< true if the call has returned
};

/// For handlers of signals.
SealedPlace sealed_place(const void* address);

}  // namespace weft::conformance
