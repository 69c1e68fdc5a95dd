// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace weft {

/// A list of plain values that stores the first kInPlace values without an allocation.
template <class T, std::size_t kInPlace>
class InlineVector {
 public:
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_default_constructible_v<T>);

  InlineVector() = default;
  InlineVector(const InlineVector&) = delete;
  InlineVector& operator=(const InlineVector&) = delete;

  void push_back(const T& value) {
    if (size_ < kInPlace) {
      in_place_[size_] = value;
    } else {
      if (size_ == kInPlace) longer_.assign(in_place_.begin(), in_place_.end());
      longer_.push_back(value);
    }
    ++size_;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* data() const { return size_ > kInPlace ? longer_.data() : in_place_.data(); }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  const T& operator[](std::size_t i) const { return data()[i]; }

 private:
  std::size_t size_ = 0;
  std::array<T, kInPlace> in_place_;
  std::vector<T> longer_;  ///< all values, once there are more than kInPlace
};

}  // namespace weft
