// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/unwritten.hpp>
#include <weft/data/layout.hpp>

namespace weft {

namespace detail {

/// Eigen interface of arrays. weft/data/matrix.hpp defines it for all element types, so that most
/// users of an array do not include Eigen.
template <class T>
struct Matrices {
  static constexpr bool kIncluded = false;
};

}  // namespace detail

/// The members of an input's weft_array that have a meaning for hosts and newer components only.
/// They are passed on with the array.
struct ArrayOrigin {
  void* owner = nullptr;
  std::int32_t reserved_word = 0;
  std::array<std::uint64_t, 2> reserved{};
};

#define WEFT_NEEDS_MATRIX(what) what " works with Eigen matrices: #include <weft/data/matrix.hpp>"

/// A dense n-dimensional array. It owns 64-byte aligned memory, shared by its copies, or borrows
/// memory that outlives it, like all inputs of a plugin. A default-constructed array is absent. An
/// array on a device has a shape but no elements on the host, see weft/sdk/device.hpp.
template <class T>
class Array {
 public:
  using Shape = std::array<std::int64_t, WEFT_MAX_DIMENSIONS>;

  Array() = default;

  /// Allocates an array in C order. The elements are not initialised, see mark_unwritten(). Throws
  /// std::length_error for a negative length or more than six axes.
  explicit Array(std::initializer_list<std::int64_t> shape)
      : ndim_(static_cast<int>(shape.size())) {
    const bool negative = std::any_of(shape.begin(), shape.end(), [](auto n) { return n < 0; });
    if (negative || shape.size() > shape_.size()) {
      throw std::length_error("an array has a negative length or more than six axes");
    }
    std::copy(shape.begin(), shape.end(), shape_.begin());
    row_stride_ = row_elements();
    const auto bytes = to_index(dim(0) * row_elements()) * sizeof(T);
    // One block holds the elements, a trailing line and the reference count.
    struct alignas(64) Line {
      std::array<std::byte, 64> bytes;
    };
    const std::size_t count = (bytes + 127) / sizeof(Line);
#ifdef __cpp_lib_smart_ptr_for_overwrite
    auto lines = std::make_shared_for_overwrite<Line[]>(count);
#else  // libc++ before 16
    std::shared_ptr<Line[]> lines(new Line[count]);
#endif
    data_ = reinterpret_cast<T*>(lines.get());
    owner_ = std::move(lines);
    mark_unwritten(data_, bytes);
  }

  /// Allocates an array with all elements set to one value.
  Array(std::initializer_list<std::int64_t> shape, T value) : Array(shape) {
    std::fill_n(data_, size(), value);
  }

  /// Borrows memory that outlives the array. `row_stride` is the number of elements between rows of
  /// axis 0.
  static Array borrow(const T* data, int ndim, const Shape& shape, std::int64_t row_stride,
                      const ArrayOrigin& origin = {}) {
    Array view;
    view.origin_ = origin;
    view.data_ = const_cast<T*>(data);
    view.ndim_ = ndim;
    view.shape_ = shape;
    view.row_stride_ = row_stride;
    return view;
  }

  /// Makes an array whose contents a library keeps on a device under `handle`. `owner` keeps the
  /// contents alive.
  static Array on_device(std::uint64_t handle, int ndim, const Shape& shape,
                         const std::shared_ptr<void>& owner, const ArrayOrigin& origin = {}) {
    Array remote;
    remote.handle_ = handle;
    remote.origin_ = origin;
    remote.owner_ = owner;
    remote.ndim_ = ndim;
    remote.shape_ = shape;
    remote.row_stride_ = remote.row_elements();
    return remote;
  }

  bool present() const { return data_ != nullptr || is_on_device(); }
  bool is_on_device() const { return handle_ != 0; }
  std::uint64_t handle() const { return handle_; }
  const ArrayOrigin& origin() const { return origin_; }
  int ndim() const { return ndim_; }
  const Shape& shape() const { return shape_; }
  std::int64_t dim(int axis) const { return axis < ndim_ ? shape_[to_index(axis)] : 1; }
  /// Length of axis 0; 0 when absent.
  std::int64_t rows() const { return present() ? dim(0) : 0; }
  /// Number of elements.
  std::int64_t size() const { return present() || ndim_ > 0 ? dim(0) * row_elements() : 0; }
  /// Number of elements per entry of axis 0.
  std::int64_t row_elements() const { return dim(1) * dim(2) * dim(3) * dim(4) * dim(5); }
  std::int64_t row_stride() const { return row_stride_; }
  bool contiguous() const { return row_stride_ == row_elements(); }

  const T* data() const { return data_; }
  T* data() { return data_; }
  const T* row(std::int64_t i) const { return data_ + i * row_stride_; }
  T* row(std::int64_t i) { return data_ + i * row_stride_; }
  const T& operator()(std::int64_t i, std::int64_t j = 0) const { return row(i)[j]; }
  T& operator()(std::int64_t i, std::int64_t j = 0) { return row(i)[j]; }

  /// Returns the array as a row-major Eigen matrix [rows, Columns] with further axes flattened.
  /// Requires weft/data/matrix.hpp.
  template <int Columns>
  auto matrix() const {
    static_assert(detail::Matrices<T>::kIncluded, WEFT_NEEDS_MATRIX("array.matrix<N>()"));
    return detail::Matrices<T>::template view<Columns, const T>(data_, rows(), row_stride_);
  }
  template <int Columns>
  auto matrix() {
    static_assert(detail::Matrices<T>::kIncluded, WEFT_NEEDS_MATRIX("array.matrix<N>()"));
    return detail::Matrices<T>::template view<Columns, T>(data_, rows(), row_stride_);
  }

 private:
  std::shared_ptr<void> owner_;
  T* data_ = nullptr;
  int ndim_ = 0;
  Shape shape_{};
  std::int64_t row_stride_ = 0;
  std::uint64_t handle_ = 0;
  ArrayOrigin origin_{};
};

/// Makes an owned array without axes, for scalars that may be absent.
inline Array<double> make_scalar(double value) { return Array<double>({}, value); }

/// Makes an owned array from an Eigen expression, in C order: [rows, columns], or [rows] for one
/// column. Requires weft/data/matrix.hpp.
template <class T, class Expression>
Array<T> make_array(const Expression& values) {
  static_assert(detail::Matrices<T>::kIncluded, WEFT_NEEDS_MATRIX("make_array()"));
  return detail::Matrices<T>::array(values);
}

#undef WEFT_NEEDS_MATRIX

}  // namespace weft
