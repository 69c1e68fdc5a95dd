// SPDX-License-Identifier: Apache-2.0
#pragma once

// Eigen interface of arrays: array.matrix<N>() and make_array<T>(expression), declared in
// array.hpp. This is the only header of weft/data that includes Eigen.

#include <Eigen/Core>
#include <cstdint>
#include <type_traits>
#include <weft/data/array.hpp>

namespace weft::detail {

template <class T>
requires std::is_arithmetic_v<T>
struct Matrices<T> {
  static constexpr bool kIncluded = true;

  /// Matrix type [rows, Columns] with const or mutable elements.
  template <int Columns, class Element>
  static auto view(Element* data, std::int64_t rows, std::int64_t row_stride) {
    using RowMajor =
        Eigen::Matrix<T, Eigen::Dynamic, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
    using Viewed = std::conditional_t<std::is_const_v<Element>, const RowMajor, RowMajor>;
    return Eigen::Map<Viewed, 0, Eigen::OuterStride<>>(data, rows, Columns,
                                                       Eigen::OuterStride<>(row_stride));
  }

  template <class Derived>
  static Array<T> array(const Eigen::MatrixBase<Derived>& values) {
    Array<T> result = Derived::ColsAtCompileTime == 1 ? Array<T>({values.rows()})
                                                      : Array<T>({values.rows(), values.cols()});
    using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(result.data(), values.rows(), values.cols()) = values.template cast<T>();
    return result;
  }
};

}  // namespace weft::detail
