// SPDX-License-Identifier: Apache-2.0
#include "common/view/patch.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace weft::view {
namespace {

constexpr int kMostSteps = 12;
constexpr float kSmallStep_px = 0.02F;
constexpr float kLeastContrast = 2.0F;  // [grey level] standard deviation
constexpr float kLeastSlope2 = 4e-3F;   // [1/px^2] of the normalised patch
constexpr float kPixels = Patch::kSize;
constexpr int kPairs = Patch::kSide / 2;

/// Turned by compilers into what the processor has. Without FMA, which rounds otherwise, all
/// processors give the same.
typedef float Eight __attribute__((vector_size(8 * sizeof(float))));
typedef float EightInMemory
    __attribute__((vector_size(8 * sizeof(float)), aligned(alignof(float)), may_alias));

/// Two rows of a patch, in the order of its arrays: the first eight pixels of the one, those of the
/// other, and the last four of both.
typedef Eight TwoRows[3];
static_assert(Patch::kSide == 12);

#define WEFT_INLINE [[gnu::always_inline]] inline

WEFT_INLINE const EightInMemory& eight(const float* from) {
  return *reinterpret_cast<const EightInMemory*>(from);
}
WEFT_INLINE EightInMemory& eight(float* at) { return *reinterpret_cast<EightInMemory*>(at); }

WEFT_INLINE void join(Lanes low, Lanes high, Eight& both) {
  both = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

WEFT_INLINE void load_rows(const float* first, std::ptrdiff_t stride, TwoRows& rows) {
  rows[0] = eight(first);
  rows[1] = eight(first + stride);
  join(load_lanes(first + 8), load_lanes(first + stride + 8), rows[2]);
}

/// The sum of each: all begin with (0 + 4) + (2 + 6).
WEFT_INLINE Lanes sums_of(const Eight& a, const Eight& b, const Eight& c, const Eight& d) {
  const auto halves = [](const Eight& all) __attribute__((always_inline)) {
    return __builtin_shufflevector(all, all, 0, 1, 2, 3) +
           __builtin_shufflevector(all, all, 4, 5, 6, 7);
  };
  const auto quarters = [](Lanes one, Lanes other) __attribute__((always_inline)) {
    return __builtin_shufflevector(one, other, 0, 4, 1, 5) +
           __builtin_shufflevector(one, other, 2, 6, 3, 7);
  };
  const Lanes ab = quarters(halves(a), halves(b)), cd = quarters(halves(c), halves(d));
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// Ramps along a patch, so that the sum of the squares over all pixels is 1, in its order.
struct Ramps {
  alignas(32) std::array<float, 24> across{};  ///< two rows
  alignas(32) std::array<float, Patch::kSize> down{};
};
constexpr Ramps make_ramps() {
  constexpr double kMiddle = 0.5 * (Patch::kSide - 1);
  // 1 / sqrt(kSide * sum (i - kMiddle)^2), and the sum is kSide (kSide^2 - 1) / 12.
  constexpr double kSquares = static_cast<double>(Patch::kSize) * (Patch::kSize - 1) / 12.0;
  double root = kSquares;  // Newton's iteration: std::sqrt is no constant expression
  for (int step = 0; step < 40; ++step) root = 0.5 * (root + kSquares / root);
  const auto ramp = [root](int i) {
    return static_cast<float>((static_cast<double>(i) - kMiddle) / root);
  };
  Ramps ramps;
  for (int i = 0; i < 24; ++i) {
    ramps.across[to_index(i)] = ramp(i < 16 ? i % 8 : 8 + i % 4);
    for (int pair = 0; pair < kPairs; ++pair) {
      const int row = 2 * pair + (i < 16 ? i / 8 : (i - 16) / 4);
      ramps.down[to_index(24 * pair + i)] = ramp(row);
    }
  }
  return ramps;
}
constexpr Ramps kRamps = make_ramps();

/// Products of grey levels with the images of plain light: 1 and the ramps.
struct Light {
  Eight left{}, right{}, down{};  ///< sums of the columns to the left and right; along the ramp

  WEFT_INLINE void add(const TwoRows& rows, int pair) {
    left += rows[0] + rows[1];
    right += rows[2];
    const float* ramp = kRamps.down.data() + 24 * pair;
    down += (rows[0] * eight(ramp) + rows[1] * eight(ramp + 8)) + rows[2] * eight(ramp + 16);
  }
  /// [1, along the ramp across, along the ramp down, `other`]
  WEFT_INLINE Lanes sums(const Eight& other) const {
    const float* ramp = kRamps.across.data();
    return sums_of(left + right, left * eight(ramp) + right * eight(ramp + 16), down, other);
  }
};

/// The light with these sums, at two rows of a patch.
WEFT_INLINE void light_at(Lanes sums, int pair, TwoRows& light) {
  const float mean = sums[0] / kPixels;
  const float* down = kRamps.down.data() + 24 * pair;
  for (int k = 0; k < 3; ++k) {
    light[k] =
        (mean + sums[1] * eight(kRamps.across.data() + 8 * k)) + sums[2] * eight(down + 8 * k);
  }
}

struct Slopes {
  float xx, xy, yy;  ///< their products; nothing where the patch has no contrast
};

/// t: without light, with norm 1. Slopes: of t, orthogonal to light and to t.
WEFT_INLINE bool any_take(const float* first, std::ptrdiff_t stride, float* t, float* slope_x,
                          float* slope_y, Slopes& slopes) {
  Light light;
  for (int pair = 0; pair < kPairs; ++pair) {
    TwoRows rows;
    load_rows(first + 2 * pair * stride, stride, rows);
    light.add(rows, pair);
  }
  const Lanes light_t = light.sums(Eight{});
  Eight squares{};
  for (int pair = 0; pair < kPairs; ++pair) {
    TwoRows rows, shade;
    load_rows(first + 2 * pair * stride, stride, rows);
    light_at(light_t, pair, shade);
    for (int k = 0; k < 3; ++k) {
      const Eight value = rows[k] - shade[k];
      squares += value * value;
      eight(t + 24 * pair + 8 * k) = value;
    }
  }
  const float norm = std::sqrt(sums_of(squares, squares, squares, squares)[0]);
  if (!(norm > kLeastContrast * std::sqrt(kPixels))) return false;
  const float gain = 1.0F / norm;
  Light light_x, light_y;
  Eight along_x{}, along_y{};
  for (int pair = 0; pair < kPairs; ++pair) {
    const float* row = first + 2 * pair * stride;
    TwoRows before, after, x, y;
    load_rows(row - 1, stride, before);
    load_rows(row + 1, stride, after);
    for (int k = 0; k < 3; ++k) x[k] = 0.5F * gain * (after[k] - before[k]);
    load_rows(row - stride, stride, before);
    load_rows(row + stride, stride, after);
    for (int k = 0; k < 3; ++k) y[k] = 0.5F * gain * (after[k] - before[k]);
    light_x.add(x, pair);
    light_y.add(y, pair);
    for (int k = 0; k < 3; ++k) {
      const int at = 24 * pair + 8 * k;
      const Eight value = gain * eight(t + at);
      along_x += x[k] * value;
      along_y += y[k] * value;
      eight(t + at) = value;
      eight(slope_x + at) = x[k];
      eight(slope_y + at) = y[k];
    }
  }
  const Lanes sums_x = light_x.sums(along_x), sums_y = light_y.sums(along_y);
  Eight xx{}, xy{}, yy{};
  for (int pair = 0; pair < kPairs; ++pair) {
    TwoRows shade_x, shade_y;
    light_at(sums_x, pair, shade_x);
    light_at(sums_y, pair, shade_y);
    for (int k = 0; k < 3; ++k) {
      const int at = 24 * pair + 8 * k;
      const Eight value = eight(t + at);
      const Eight x = (eight(slope_x + at) - shade_x[k]) - sums_x[3] * value;
      const Eight y = (eight(slope_y + at) - shade_y[k]) - sums_y[3] * value;
      xx += x * x;
      xy += x * y;
      yy += y * y;
      eight(slope_x + at) = x;
      eight(slope_y + at) = y;
    }
  }
  const Lanes sums = sums_of(xx, xy, yy, yy);
  slopes = {sums[0], sums[1], sums[2]};
  return true;
}

struct Sums {
  float spread2;  ///< spread of the grey levels without light
  float along_t, along_x, along_y;
};

/// Products of the patch with the grey levels at `first` + (sub_x,sub_y).
WEFT_INLINE void any_correlate(const float* first, std::ptrdiff_t stride, float sub_x, float sub_y,
                               const float* t, const float* slope_x, const float* slope_y,
                               Sums& sums) {
  Light light;
  Eight squares{}, along_t{}, along_x{}, along_y{};
  // Each row between its columns, then between the rows.
  Eight left = eight(first) + sub_x * (eight(first + 1) - eight(first));
  Lanes right = load_lanes(first + 8) + sub_x * (load_lanes(first + 9) - load_lanes(first + 8));
  for (int pair = 0; pair < kPairs; ++pair) {
    const float* middle = first + (2 * pair + 1) * stride;
    const float* below = middle + stride;
    const Eight left_1 = eight(middle) + sub_x * (eight(middle + 1) - eight(middle));
    const Eight left_2 = eight(below) + sub_x * (eight(below + 1) - eight(below));
    const Lanes right_1 =
        load_lanes(middle + 8) + sub_x * (load_lanes(middle + 9) - load_lanes(middle + 8));
    const Lanes right_2 =
        load_lanes(below + 8) + sub_x * (load_lanes(below + 9) - load_lanes(below + 8));
    Eight upper, lower;
    join(right, right_1, upper);
    join(right_1, right_2, lower);
    const TwoRows grey = {left + sub_y * (left_1 - left), left_1 + sub_y * (left_2 - left_1),
                          upper + sub_y * (lower - upper)};
    left = left_2;
    right = right_2;
    light.add(grey, pair);
    for (int k = 0; k < 3; ++k) {
      const int at = 24 * pair + 8 * k;
      squares += grey[k] * grey[k];
      along_t += grey[k] * eight(t + at);
      along_x += grey[k] * eight(slope_x + at);
      along_y += grey[k] * eight(slope_y + at);
    }
  }
  const Lanes plain = light.sums(squares), along = sums_of(along_t, along_x, along_y, along_y);
  const float light2 = plain[0] * plain[0] / kPixels + plain[1] * plain[1] + plain[2] * plain[2];
  sums = {plain[3] - light2, along[0], along[1], along[2]};
}

using Take = bool(const float*, std::ptrdiff_t, float*, float*, float*, Slopes&);
using Correlate = void(const float*, std::ptrdiff_t, float, float, const float*, const float*,
                       const float*, Sums&);
struct Kernels {
  Take* take;
  Correlate* correlate;
};

bool take_plain(const float* first, std::ptrdiff_t stride, float* t, float* slope_x, float* slope_y,
                Slopes& slopes) {
  return any_take(first, stride, t, slope_x, slope_y, slopes);
}
void correlate_plain(const float* first, std::ptrdiff_t stride, float sub_x, float sub_y,
                     const float* t, const float* slope_x, const float* slope_y, Sums& sums) {
  any_correlate(first, stride, sub_x, sub_y, t, slope_x, slope_y, sums);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] bool take_avx2(const float* first, std::ptrdiff_t stride, float* t,
                                       float* slope_x, float* slope_y, Slopes& slopes) {
  return any_take(first, stride, t, slope_x, slope_y, slopes);
}
[[gnu::target("avx2")]] void correlate_avx2(const float* first, std::ptrdiff_t stride, float sub_x,
                                            float sub_y, const float* t, const float* slope_x,
                                            const float* slope_y, Sums& sums) {
  any_correlate(first, stride, sub_x, sub_y, t, slope_x, slope_y, sums);
}
const Kernels kKernels = __builtin_cpu_supports("avx2") ? Kernels{take_avx2, correlate_avx2}
                                                        : Kernels{take_plain, correlate_plain};
#else
const Kernels kKernels{take_plain, correlate_plain};
#endif
#undef WEFT_INLINE

/// True if all of `kBordered` bytes of a row are 1.
bool are_drawn(const std::uint8_t* row) {
  static_assert(Patch::kBordered <= 16);
  std::uint64_t begin = 0, end = 0;
  std::memcpy(&begin, row, 8);
  std::memcpy(&end, row + Patch::kBordered - 8, 8);
  return (begin & end) == 0x0101010101010101U;
}

}  // namespace

Patch::Fit Patch::take(const ViewLevel& view, int x, int y) {
  x_ = x;
  y_ = y;
  const int left = x - view.x0, top = y - view.y0;
  if (left < 1 || top < 1 || left + kSide + 1 > view.grey.width ||
      top + kSide + 1 > view.grey.height) {
    return Fit::not_drawn;
  }
  for (int j = -1; j <= kSide; ++j) {
    if (!are_drawn(view.drawn_row(top + j) + left - 1)) return Fit::not_drawn;
  }
  return take_rows(view.grey.row(top) + left, view.grey.width);
}

Patch::Fit Patch::take(const Picture& image, int x, int y) {
  x_ = x;
  y_ = y;
  if (x < 1 || y < 1 || x + kSide + 1 > image.width || y + kSide + 1 > image.height) {
    return Fit::not_drawn;
  }
  return take_rows(image.row(y) + x, image.width);
}

Patch::Fit Patch::take(const Samples& samples, int x, int y) {
  static_assert(kBordered <= Samples::kColumns && kBordered <= Samples::kRows);
  x_ = x;
  y_ = y;
  return take_rows(samples.values.data() + Samples::kColumns + 1, Samples::kColumns);
}

Patch::Fit Patch::take_rows(const float* first, int stride) {
  Slopes slopes{};
  if (!kKernels.take(first, stride, t_.data(), slope_x_.data(), slope_y_.data(), slopes)) {
    return Fit::flat;
  }
  const auto [xx, xy, yy] = slopes;
  const float determinant = xx * yy - xy * xy;
  const float half_trace = 0.5F * (xx + yy);
  const float root = std::sqrt(std::max(half_trace * half_trace - determinant, 0.0F));
  least_slope2_ = half_trace - root;
  if (!(least_slope2_ > kLeastSlope2)) return Fit::flat;
  inverse_xx_ = yy / determinant;
  inverse_xy_ = -xy / determinant;
  inverse_yy_ = xx / determinant;
  return Fit::usable;
}

bool Patch::is_inside(const Picture& image, float place_x, float place_y) const {
  return place_x >= 0.0F && place_y >= 0.0F && place_x + kSide < static_cast<float>(image.width) &&
         place_y + kSide < static_cast<float>(image.height);
}

float Patch::correlation_at(const Picture& image, float dx, float dy) const {
  const float place_x = static_cast<float>(x_) + dx, place_y = static_cast<float>(y_) + dy;
  if (!is_inside(image, place_x, place_y)) return 0.0F;
  const int x = static_cast<int>(place_x), y = static_cast<int>(place_y);
  Sums sums{};
  kKernels.correlate(image.row(y) + x, image.width, place_x - static_cast<float>(x),
                     place_y - static_cast<float>(y), t_.data(), slope_x_.data(), slope_y_.data(),
                     sums);
  return sums.spread2 > kPixels ? sums.along_t / std::sqrt(sums.spread2) : 0.0F;
}

Alignment Patch::find_in(const Picture& image, float dx, float dy, float reach_px) const {
  Alignment found{Alignment::End::wandered, dx, dy, 0.0F};
  for (int step = 0; step < kMostSteps; ++step) {
    const float place_x = static_cast<float>(x_) + found.dx;
    const float place_y = static_cast<float>(y_) + found.dy;
    if (!is_inside(image, place_x, place_y)) {
      found.end = Alignment::End::left_image;
      return found;
    }
    const int x = static_cast<int>(place_x), y = static_cast<int>(place_y);
    Sums sums{};
    kKernels.correlate(image.row(y) + x, image.width, place_x - static_cast<float>(x),
                       place_y - static_cast<float>(y), t_.data(), slope_x_.data(), slope_y_.data(),
                       sums);
    const float spread2 = sums.spread2;
    if (!(spread2 > kPixels)) {  // one grey level
      found.end = Alignment::End::no_contrast;
      return found;
    }
    const float norm = std::sqrt(spread2);
    found.correlation = sums.along_t / norm;
    // Far from a fit the contrast under the patch is unreliable; t explains `along_t` of it.
    const float gain = 1.0F / std::max(sums.along_t, 0.5F * norm);
    const float right_x = sums.along_x * gain, right_y = sums.along_y * gain;
    const float step_x = inverse_xx_ * right_x + inverse_xy_ * right_y;
    const float step_y = inverse_xy_ * right_x + inverse_yy_ * right_y;
    found.dx -= step_x;
    found.dy -= step_y;
    if (std::abs(found.dx - dx) > reach_px || std::abs(found.dy - dy) > reach_px) return found;
    if (std::abs(step_x) < kSmallStep_px && std::abs(step_y) < kSmallStep_px) {
      found.end = Alignment::End::converged;
      return found;
    }
  }
  return found;
}

Eigen::Matrix2d Patch::covariance_px2(float correlation) const {
  // |i - t|^2 = 2 (1 - correlation), spread over all pixels.
  const double noise2 = 2.0 * std::max(1.0 - static_cast<double>(correlation), 0.0) / kPixels;
  Eigen::Matrix2d inverse;
  inverse << inverse_xx_, inverse_xy_, inverse_xy_, inverse_yy_;
  return noise2 * inverse;
}

float Patch::deviation_px(float correlation) const {
  const float noise2 = 2.0F * std::max(1.0F - correlation, 0.0F) / kPixels;
  return std::sqrt(noise2 / least_slope2_);
}

}  // namespace weft::view
