// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/quote.hpp>
#include <weft/core/result.hpp>

namespace weft {

/// What a component finds wrong with its parameters before anything runs. A component that can
/// tell has
///
///   void check(weft::Mistakes& mistakes) const;
///
/// which is called after the constructor, before any other method, also when nothing will be run.
/// It reads headers and small files and expands patterns; it never renders, simulates, fits, opens
/// a camera or computes on a device, and never blocks. Nested components are asked by themselves.
/// What it refuses, the methods that run must refuse in the same words: let both call one function.
class Mistakes {
 public:
  /// How a message begins that is a warning.
  static constexpr const char* kWarning = "warning: ";

  using Report = void (*)(void* context, const char* parameter, const char* message);

  Mistakes(void* context, Report report) : context_(context), report_(report) {}

  /// A mistake in the value of `parameter`: what is wrong and what to change.
  void add(const char* parameter, const std::string& message) {
    report_(context_, parameter, without_nul(message).c_str());
  }

  /// Something legal, but doubtful: it is printed as a warning, and the pipeline can be run.
  /// Nothing where `message` is empty.
  void doubt(const char* parameter, const std::string& message) {
    if (!message.empty()) add(parameter, kWarning + message);
  }

  /// Adds the error of a result as a mistake in the value of `parameter`; true if there is none.
  template <class T>
  bool expect(const char* parameter, const Result<T>& result) {
    if (result) return true;
    const Error& error = result.error();
    add(parameter, error.where.empty() ? error.message : error.where + ": " + error.message);
    return false;
  }

 private:
  void* context_;
  Report report_;
};

}  // namespace weft
