// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace weft::host {

/// A text that is made once and shared by its copies, such as the name of a stage.
class SharedText {
 public:
  SharedText() = default;
  SharedText(std::string text)
      : text_(text.empty() ? nullptr : std::make_shared<const std::string>(std::move(text))) {}
  SharedText(const char* text) : SharedText(std::string(text)) {}

  const std::string& str() const {
    static const std::string kEmpty;
    return text_ != nullptr ? *text_ : kEmpty;
  }
  operator const std::string&() const { return str(); }
  bool empty() const { return text_ == nullptr; }
  bool starts_with(std::string_view begin) const { return str().starts_with(begin); }

  friend bool operator==(const SharedText& a, const SharedText& b) { return a.str() == b.str(); }
  template <class Text>
  requires std::convertible_to<const Text&, std::string_view>
  friend bool operator==(const SharedText& a, const Text& b) {
    return a.str() == std::string_view(b);
  }
  friend std::string operator+(const SharedText& a, const std::string& b) { return a.str() + b; }
  friend std::string operator+(const std::string& a, const SharedText& b) { return a + b.str(); }

 private:
  std::shared_ptr<const std::string> text_;  ///< null for an empty one
};

}  // namespace weft::host
