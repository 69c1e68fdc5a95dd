// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/quote.hpp>
#include <weft/core/result.hpp>

namespace weft {

/// Collects the errors of a component's parameters before a run. A component can implement
///
///   void check(weft::Mistakes& mistakes) const;
///
/// The host calls it after the constructor and before any other method, even if no run follows. It
/// may read headers and small files and expand patterns. It must not render, simulate, fit, open a
/// camera, use a device or block. The host checks nested components separately. The methods that
/// run must report the same errors with the same words; share one function for both.
class Mistakes {
 public:
  /// Prefix of messages that are warnings.
  static constexpr const char* kWarning = "warning: ";

  using Report = void (*)(void* context, const char* parameter, const char* message);

  Mistakes(void* context, Report report) : context_(context), report_(report) {}

  /// Adds an error in the value of `parameter`: the message gives the problem and the correction.
  void add(const char* parameter, const std::string& message) {
    report_(context_, parameter, without_nul(message).c_str());
  }

  /// Adds a warning about a legal but doubtful value. The run can proceed. An empty `message` adds
  /// nothing.
  void doubt(const char* parameter, const std::string& message) {
    if (!message.empty()) add(parameter, kWarning + message);
  }

  /// Adds the error of a result as an error in the value of `parameter`. Returns true if the result
  /// has none.
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
