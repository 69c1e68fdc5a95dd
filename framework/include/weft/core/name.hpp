// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace weft {

/// The name of an array, stored in place, with the maximum length of the contract.
class Name {
 public:
  static constexpr std::size_t kLongest = 100;

  Name() { text_.front() = '\0'; }
  /// Joins one or two parts. Throws std::length_error if the result exceeds kLongest characters.
  template <class Text>
  requires std::convertible_to<const Text&, std::string_view> Name(const Text& text)
      : Name(std::string_view(text), std::string_view()) {}
  Name(std::string_view begin, std::string_view end) {
    if (begin.size() + end.size() > kLongest) {
      throw std::length_error("the name '" + std::string(begin) + std::string(end) +
                              "' has more than 100 characters");
    }
    if (!begin.empty()) std::memcpy(text_.data(), begin.data(), begin.size());
    if (!end.empty()) std::memcpy(text_.data() + begin.size(), end.data(), end.size());
    length_ = static_cast<unsigned char>(begin.size() + end.size());
    text_[length_] = '\0';
  }

  const char* c_str() const { return text_.data(); }
  operator std::string_view() const { return {text_.data(), length_}; }
  operator std::string() const { return {text_.data(), length_}; }

  template <class Text>
  requires std::convertible_to<const Text&, std::string_view>
  friend bool operator==(const Name& name, const Text& other) {
    return std::string_view(name) == std::string_view(other);
  }

 private:
  std::array<char, kLongest + 1> text_;
  unsigned char length_ = 0;
};

}  // namespace weft
