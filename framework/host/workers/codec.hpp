// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace weft::host {

namespace detail {

/// Appends the fields of a message to bytes: numbers as they are, lengths before contents.
class Packer {
 public:
  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    } else if constexpr (std::is_same_v<T, std::string>) {
      (*this)(std::uint64_t{value.size()});
      bytes_ += value;
    } else if constexpr (requires { T::fields(value, *this); }) {
      T::fields(value, *this);
    } else {
      (*this)(std::uint64_t{value.size()});
      for (const auto& item : value) (*this)(item);
    }
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Fills the fields of a message from bytes; after the first that is not there it changes nothing.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  void operator()(T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      if (const char* bytes = take(sizeof(T))) std::memcpy(&value, bytes, sizeof(T));
    } else if constexpr (std::is_same_v<T, std::string>) {
      const std::uint64_t length = count();
      if (const char* bytes = take(length)) value.assign(bytes, length);
    } else if constexpr (requires { T::fields(value, *this); }) {
      T::fields(value, *this);
    } else {
      const std::uint64_t length = count();
      for (std::uint64_t i = 0; i < length && !failed_; ++i) (*this)(value.emplace_back());
    }
  }
  bool complete() const { return !failed_ && rest_.empty(); }

 private:
  std::uint64_t count() {
    std::uint64_t length = 0;
    (*this)(length);
    // Each item takes a byte at least, so an absurd count ends here and not in the memory.
    if (length > rest_.size()) failed_ = true;
    return failed_ ? 0 : length;
  }
  const char* take(std::uint64_t length) {
    if (length > rest_.size()) failed_ = true;
    if (failed_) return nullptr;
    const char* bytes = rest_.data();
    rest_.remove_prefix(length);
    return bytes;
  }

  std::string_view rest_;
  bool failed_ = false;
};

}  // namespace detail

template <class Message>
std::string pack(const Message& message) {
  detail::Packer packer;
  packer(message);
  return packer.take();
}

/// Nothing when the bytes are no such message.
template <class Message>
std::optional<Message> unpack(std::string_view bytes) {
  detail::Unpacker unpacker(bytes);
  std::optional<Message> message(std::in_place);
  unpacker(*message);
  return unpacker.complete() ? std::move(message) : std::nullopt;
}

}  // namespace weft::host
