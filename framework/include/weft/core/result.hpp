// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace weft {

/// Category of an error. The message of an Error describes the correction.
enum class Errc : std::int32_t {
  no_result = 1,   ///< the data do not determine an answer; recorded for the frame, not a failure
  invalid_value,   ///< an argument or parameter is outside its legal range
  invalid_data,    ///< NaN, wrong shape or inconsistent content of a record or file
  not_found,       ///< a file, plugin, stage or key that does not exist
  io,              ///< a read or write failed
  syntax,          ///< a text cannot be parsed
  incompatible,    ///< wrong ABI, missing symbol, missing processor feature
  unsupported,     ///< the request is legal, but the component does not support it
  plugin_failure,  ///< a plugin threw an exception or violated its contract
  cancelled,       ///< the host cancelled the call
  no_memory,       ///< memory was insufficient; the request itself may be valid
  end,             ///< a source has no more frames
};

/// An error: its category, a message with the correction, and a place (file:line:column, plugin or
/// stage).
struct Error {
  Errc code = Errc::plugin_failure;
  std::string message;
  std::string where = {};
  std::string subject = {};  ///< the parameter, input or array that the error concerns, if any
};

/// Marks a value as usable but degenerate. The stage's status becomes `degenerate`.
template <class T>
struct Degenerate {
  T value;
  std::string reason;
};

/// A value, which may be marked as degenerate with a reason, or an Error.
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

  /// The reason of a degenerate value; empty for other values.
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
  Result(Error error) : error_(std::move(error)) {}

  explicit operator bool() const { return !error_.has_value(); }
  /// The error; one without a message after success.
  const Error& error() const {
    static const Error kNone;
    return error_ ? *error_ : kNone;
  }

 private:
  std::optional<Error> error_;  // success builds no texts, as each call has dozens of these
};

/// Returns the answer "no result for this frame" with its reason.
inline Error no_result(std::string reason) { return {Errc::no_result, std::move(reason), {}}; }

/// Returns the answer of a source after its last frame, with the reason.
inline Error no_more_frames(std::string reason) { return {Errc::end, std::move(reason), {}}; }

/// Attributes an error to a parameter, an input or an array. For a parameter, the message shows its
/// place in the pipeline.
inline Error about(std::string subject, Error error) {
  error.subject = std::move(subject);
  return error;
}

/// Marks a value as usable but degenerate.
template <class T>
Degenerate<T> degenerate(T value, std::string reason) {
  return {std::move(value), std::move(reason)};
}

}  // namespace weft
