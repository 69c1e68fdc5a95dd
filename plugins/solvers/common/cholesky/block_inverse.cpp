// SPDX-License-Identifier: Apache-2.0
// Uses the factor for solutions and for the blocks of the inverse.
#include <algorithm>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/cholesky/block_cholesky.hpp"

namespace weft::solvers {

void BlockCholesky::solve(Points3& values) {
  for (std::size_t v = 0; v < place_.size(); ++v) {
    std::copy_n(values.data() + 3 * v, 3, values_.data() + place_[v]);
  }
  for (const Front& front : fronts_) forward(front);
  for (std::size_t f = fronts_.size(); f-- > 0;) backward(fronts_[f]);
  for (std::size_t v = 0; v < place_.size(); ++v) {
    std::copy_n(values_.data() + place_[v], 3, values.data() + 3 * v);
  }
}

void BlockCholesky::forward(const Front& front) {
  const Panel factor = panel(front);
  double* const own = values_.data() + front.first;
  double* const below = gathered_.data();
  std::fill_n(below, front.border, 0.0);
  for (std::size_t j = 0; j < front.own; ++j) {
    const double* const column = &factor(0, j);
    own[j] /= column[j];
    for (std::size_t r = j + 1; r < front.own; ++r) own[r] -= own[j] * column[r];
    for (std::size_t r = 0; r < front.border; ++r) below[r] += own[j] * column[front.own + r];
  }
  for (std::size_t k = 0; k < front.vertices_below(); ++k) {
    double* const to = values_.data() + border_rows_[front.places + k];
    for (std::size_t j = 0; j < 3; ++j) to[j] -= below[3 * k + j];
  }
}

void BlockCholesky::backward(const Front& front) {
  const Panel factor = panel(front);
  double* const own = values_.data() + front.first;
  double* const below = gathered_.data();
  for (std::size_t k = 0; k < front.vertices_below(); ++k) {
    std::copy_n(values_.data() + border_rows_[front.places + k], 3, below + 3 * k);
  }
  for (std::size_t j = front.own; j-- > 0;) {
    const double* const column = &factor(0, j);
    double sum = own[j];
    for (std::size_t r = j + 1; r < front.own; ++r) sum -= column[r] * own[r];
    for (std::size_t r = 0; r < front.border; ++r) sum -= column[front.own + r] * below[r];
    own[j] = sum / column[j];
  }
}

void BlockCholesky::inverse_blocks(std::vector<Eigen::Matrix3d>& blocks) {
  for (std::size_t f = fronts_.size(); f-- > 0;) {
    const Front& front = fronts_[f];
    worked(static_cast<std::int64_t>(front.own * front.rows() * front.rows() / 16));
    const Panel own = invert(front);
    for (std::size_t k = 0; k < front.own; k += 3) {
      Eigen::Matrix3d& block = blocks[to_index(vertex_[(front.first + k) / 3])];
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t r = 0; r < 3; ++r) {
          block(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
              -own(k + std::max(r, c), k + std::min(r, c));
        }
      }
    }
  }
}

/// Gathers the part of the parent's inverse that is the border of a front.
void BlockCholesky::gather_border(const Front& front, const Panel& border) const {
  if (front.border == 0) return;
  const Front& above = fronts_[to_index(front.parent)];
  const double* const from = inverses_.data() + above.inverse;
  const std::size_t stride = stride_for(above.rows());
  const std::uint32_t* const rows = in_parent_.data() + front.places;
  for (std::size_t c = 0; c < front.border; ++c) {
    const double* const column = from + (rows[c / 3] + c % 3) * stride;
    for (std::size_t k = 0; k < front.vertices_below(); ++k) {
      for (std::size_t j = 0; j < 3; ++j) border(3 * k + j, c) = column[rows[k] + j];
    }
  }
}

/// T^T, by columns from the last: T^T L1 = L2.
void BlockCholesky::divide_border(const Front& front, const Panel& divided) {
  const Panel factor = panel(front);
  for (std::size_t j = front.own; j-- > 0;) {
    std::copy_n(&factor(front.own, j), front.border, &divided(0, j));
    for (std::size_t p = j + 1; p < front.own; ++p) {
      subtract_multiple(&divided(0, j), &divided(0, p), front.border, factor(p, j));
    }
    scale(&divided(0, j), front.border, 1.0 / factor(j, j));
  }
}

/// L1^-T, by columns: L1^-T L1^T = I.
void BlockCholesky::invert_own(const Front& front, const Panel& inverse) {
  const Panel factor = panel(front);
  for (std::size_t j = 0; j < front.own; ++j) {
    std::fill_n(&inverse(0, j), front.own, 0.0);
    inverse(j, j) = 1.0;
    for (std::size_t p = 0; p < j; ++p) {
      subtract_multiple(&inverse(0, j), &inverse(0, p), p + 1, factor(j, p));
    }
    scale(&inverse(0, j), j + 1, 1.0 / factor(j, j));
  }
}

/// With L1 the own rows of the panel, L2 those below, T = (L2 L1^-1)^T and Z the inverse:
///   Z(own, border) = -T Z(border, border),   Z(own, own) = L1^-T L1^-1 - Z(own, border) T^T.
/// Leaves all of Z for the children, and returns -Z(own, own).
Panel BlockCholesky::invert(const Front& front) {
  const std::size_t own = front.own, border = front.border;
  const Panel whole{inverses_.data() + front.inverse, stride_for(front.rows())};
  const Panel divided{scratch_[0].data(), stride_for(border)};
  const Panel result{scratch_[0].data(), stride_for(own)};
  const Panel t{scratch_[1].data(), stride_for(own)}, across{scratch_[2].data(), stride_for(own)};
  const Panel own_inverse{scratch_[3].data(), stride_for(own)};
  gather_border(front, whole.from(own, own));
  divide_border(front, divided);
  for (std::size_t c = 0; c < border; ++c) {
    for (std::size_t r = 0; r < own; ++r) t(r, c) = divided(c, r);
  }
  std::fill_n(across.data, panel_size(own, border), 0.0);
  for (std::size_t c = 0; c < border; c += kTileColumns) {
    subtract_product(across.from(0, c), t, whole.from(own + c, own), own, border);
  }
  std::for_each_n(t.data, panel_size(own, border), [](double& each) { each = -each; });
  invert_own(front, own_inverse);
  std::fill_n(result.data, panel_size(own, own), 0.0);
  for (std::size_t c = 0; c < own; c += kTileColumns) {
    subtract_product(result.from(0, c), own_inverse.from(0, c), own_inverse.from(c, c), own,
                     own - c);
    subtract_product(result.from(0, c), across, t.from(c, 0), own, border);
  }
  if (front.last_child < 0) return result;
  for (std::size_t c = 0; c < own; ++c) {
    for (std::size_t r = 0; r < own; ++r) whole(r, c) = -result(r, c);
  }
  for (std::size_t c = 0; c < border; ++c) {
    for (std::size_t r = 0; r < own; ++r) whole(r, own + c) = whole(own + c, r) = across(r, c);
  }
  return result;
}

}  // namespace weft::solvers
