// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace weft {

/// Why something did not work. The message of an Error says what to change.
enum class Errc : std::int32_t {
  no_result = 1,   ///< the data do not determine an answer; recorded for the frame, not a failure
  invalid_value,   ///< an argument or parameter outside its legal range
  invalid_data,    ///< NaN, wrong shape or inconsistent content of a record or file
  not_found,       ///< a file, plugin, stage or key that does not exist
  io,              ///< reading or writing failed
  syntax,          ///< a text that cannot be parsed
  incompatible,    ///< wrong ABI, missing symbol, missing processor feature
  unsupported,     ///< legal, but this component cannot do it
  plugin_failure,  ///< a plugin threw or broke its contract
  cancelled,       ///< the host asked to stop
  no_memory,       ///< memory was short; says nothing about what was asked for
  end,             ///< a source has no more frames
};

/// A cause, a sentence that says what to change, and a place (file:line:column, plugin or stage).
struct Error {
  Errc code = Errc::plugin_failure;
  std::string message;
  std::string where = {};
  std::string subject = {};  ///< the parameter, input or array that it is about, where it is one
};

/// Marks a value as usable but flagged: the stage's status becomes `degenerate`.
template <class T>
struct Degenerate {
  T value;
  std::string reason;
};

/// Either a value (perhaps flagged as degenerate, with the reason) or an Error.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Degenerate<T> flagged)
      : content_(std::move(flagged.value)), degenerate_reason_(std::move(flagged.reason)) {}
  Result(Error error) : content_(std::move(error)) {}

  explicit operator bool() const { return std::holds_alternative<T>(content_); }
  T& operator*() & { return std::get<T>(content_); }
  const T& operator*() const& { return std::get<T>(content_); }
  T&& operator*() && { return std::get<T>(std::move(content_)); }
  T* operator->() { return &std::get<T>(content_); }
  const T* operator->() const { return &std::get<T>(content_); }
  const Error& error() const { return std::get<Error>(content_); }

  /// Empty when the value is not flagged.
  const std::string& degenerate_reason() const { return degenerate_reason_; }

 private:
  std::variant<T, Error> content_;
  std::string degenerate_reason_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), failed_(true) {}

  explicit operator bool() const { return !failed_; }
  const Error& error() const { return error_; }

 private:
  Error error_;
  bool failed_ = false;
};

/// The answer "no result for this frame, because ...".
inline Error no_result(std::string reason) { return {Errc::no_result, std::move(reason), {}}; }

/// A source's answer "there are no more frames, because ...".
inline Error no_more_frames(std::string reason) { return {Errc::end, std::move(reason), {}}; }

/// The same error, said of a parameter, an input or an array: where it is a parameter, its place in
/// the pipeline is shown.
inline Error about(std::string subject, Error error) {
  error.subject = std::move(subject);
  return error;
}

/// Flags a value as usable but degenerate.
template <class T>
Degenerate<T> degenerate(T value, std::string reason) {
  return {std::move(value), std::move(reason)};
}

}  // namespace weft
