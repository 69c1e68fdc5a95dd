// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace weft::solvers {

/// A product computes kTileColumns columns at once, and rows in multiples of kTileRows.
inline constexpr std::size_t kTileColumns = 4, kTileRows = 8;

inline constexpr std::size_t rounded_up(std::size_t count, std::size_t bundle) {
  return (count + bundle - 1) / bundle * bundle;
}

/// A matrix stored by columns: element (r, c) at data[r + c * stride].
struct Panel {
  double* data = nullptr;
  std::size_t stride = 0;

  double& operator()(std::size_t row, std::size_t column) const {
    return data[row + column * stride];
  }
  Panel from(std::size_t row, std::size_t column) const {
    return {data + row + column * stride, stride};
  }
};

/// C -= A B^T, C [rows, 4], A [rows, depth], B [4, depth]. Rows are rounded up to 8: there must be
/// memory for them, also in A.
void subtract_product(const Panel& c, const Panel& a, const Panel& b, std::size_t rows,
                      std::size_t depth);

/// column *= factor, and column -= factor other. The count is rounded up to 4.
void scale(double* column, std::size_t count, double factor);
void subtract_multiple(double* column, const double* other, std::size_t count, double factor);

/// Replaces the lower half of the first `columns` columns of a panel [rows, columns] by those of
/// its Cholesky factor. Returns false where a pivot is not positive. The panel must have memory for
/// the columns rounded up to 4, and for 7 more rows, which are 0 in the columns.
bool factorise_columns(const Panel& panel, std::size_t rows, std::size_t columns);

}  // namespace weft::solvers
