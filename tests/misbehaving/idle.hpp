// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/filter.hpp>

/// The component of the libraries with a broken table: a filter that keeps nothing.
class Idle final : public weft::Filter {
 public:
  explicit Idle(weft::Params&) {}

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    return weft::InlierMask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
  }
};
