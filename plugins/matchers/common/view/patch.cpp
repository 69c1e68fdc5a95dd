// SPDX-License-Identifier: Apache-2.0
#include "common/view/patch.hpp"

#include <algorithm>
#include <cmath>

namespace weft::view {
namespace {

constexpr int kMostSteps = 12;
constexpr float kSmallStep_px = 0.02F;
constexpr float kLeastContrast = 2.0F;  // [grey level] standard deviation
constexpr float kLeastSlope2 = 4e-3F;   // [1/px^2] of the normalised patch
constexpr float kPixels = Patch::kSize;

float dot(const float* a, const float* b) {
  Lanes sum{};
  for (int i = 0; i < Patch::kSize; i += kLanes) sum += load_lanes(a + i) * load_lanes(b + i);
  return sum_of(sum);
}

/// values += factor * others
void add(float* __restrict values, float factor, const float* __restrict others) {
  for (int i = 0; i < Patch::kSize; ++i) values[i] += factor * others[i];
}

void take_mean(float* values) {
  Lanes sum{};
  for (int i = 0; i < Patch::kSize; i += kLanes) sum += load_lanes(values + i);
  const float mean = sum_of(sum) / kPixels;
  for (int i = 0; i < Patch::kSize; ++i) values[i] -= mean;
}

void scale(float* values, float factor) {
  for (int i = 0; i < Patch::kSize; ++i) values[i] *= factor;
}

/// Elements of a ramp along a patch, so that the sum of its squares over all pixels is 1.
constexpr std::array<float, Patch::kSide> make_ramp() {
  constexpr double kMiddle = 0.5 * (Patch::kSide - 1);
  // 1 / sqrt(kSide * sum (i - kMiddle)^2), and the sum is kSide (kSide^2 - 1) / 12.
  constexpr double kSquares = static_cast<double>(Patch::kSize) * (Patch::kSize - 1) / 12.0;
  double root = kSquares;  // Newton's iteration: std::sqrt is no constant expression
  for (int step = 0; step < 40; ++step) root = 0.5 * (root + kSquares / root);
  std::array<float, Patch::kSide> ramp{};
  for (int i = 0; i < Patch::kSide; ++i) {
    ramp[to_index(i)] = static_cast<float>((static_cast<double>(i) - kMiddle) / root);
  }
  return ramp;
}
alignas(16) constexpr std::array<float, Patch::kSide> kRamp = make_ramp();

/// Removes mean and slope, which depend on the light as much as on the texture.
void take_light(float* values) {
  take_mean(values);
  float along_x = 0.0F, along_y = 0.0F;
  for (int j = 0; j < Patch::kSide; ++j) {
    const float* row = values + to_index(j * Patch::kSide);
    float sum = 0.0F;
    for (int i = 0; i < Patch::kSide; ++i) {
      sum += row[i];
      along_x += kRamp[to_index(i)] * row[i];
    }
    along_y += kRamp[to_index(j)] * sum;
  }
  for (int j = 0; j < Patch::kSide; ++j) {
    float* row = values + to_index(j * Patch::kSide);
    const float down = along_y * kRamp[to_index(j)];
    for (int i = 0; i < Patch::kSide; ++i) row[i] -= down + along_x * kRamp[to_index(i)];
  }
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
  unsigned all_drawn = 1;
  for (int j = -1; j <= kSide; ++j) {
    const std::uint8_t* drawn = view.drawn_row(top + j) + left;
    for (int i = -1; i <= kSide; ++i) all_drawn &= drawn[i];
  }
  if (all_drawn == 0) return Fit::not_drawn;
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
  for (int j = 0; j < kSide; ++j) {
    const float* __restrict row = first + static_cast<std::ptrdiff_t>(j) * stride;
    const float* __restrict above = row - stride;
    const float* __restrict below = row + stride;
    const std::size_t at = to_index(j * kSide);
    for (int i = 0; i < kSide; ++i) {
      t_[at + to_index(i)] = row[i];
      slope_x_[at + to_index(i)] = 0.5F * (row[i + 1] - row[i - 1]);
      slope_y_[at + to_index(i)] = 0.5F * (below[i] - above[i]);
    }
  }
  take_light(t_.data());
  const float norm = std::sqrt(dot(t_.data(), t_.data()));
  if (!(norm > kLeastContrast * std::sqrt(kPixels))) return Fit::flat;
  scale(t_.data(), 1.0F / norm);
  for (auto* slope : {&slope_x_, &slope_y_}) {
    scale(slope->data(), 1.0F / norm);
    take_light(slope->data());
    add(slope->data(), -dot(slope->data(), t_.data()), t_.data());
  }
  const float xx = dot(slope_x_.data(), slope_x_.data());
  const float xy = dot(slope_x_.data(), slope_y_.data());
  const float yy = dot(slope_y_.data(), slope_y_.data());
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

Patch::Sums Patch::correlate(const Picture& image, int x, int y, float sub_x, float sub_y) const {
  const float a = (1.0F - sub_x) * (1.0F - sub_y), b = sub_x * (1.0F - sub_y),
              c = (1.0F - sub_x) * sub_y, d = sub_x * sub_y;
  constexpr int kAcross = kSide / kLanes;
  std::array<Lanes, kAcross> columns{};
  Lanes squares{}, along_t{}, along_x{}, along_y{}, ramp_y{};
  for (int j = 0; j < kSide; ++j) {
    Lanes row{};
    const float* above = image.row(y + j) + x;
    const float* below = above + image.width;
    const std::size_t at = to_index(j * kSide);
    for (int i = 0; i < kSide; i += kLanes) {
      const Lanes grey = a * load_lanes(above + i) + b * load_lanes(above + i + 1) +
                         c * load_lanes(below + i) + d * load_lanes(below + i + 1);
      const std::size_t k = at + to_index(i);
      row += grey;
      columns[to_index(i / kLanes)] += grey;
      squares += grey * grey;
      along_t += grey * load_lanes(t_.data() + k);
      along_x += grey * load_lanes(slope_x_.data() + k);
      along_y += grey * load_lanes(slope_y_.data() + k);
    }
    ramp_y += kRamp[to_index(j)] * row;
  }
  Lanes values{}, ramp_x{};
  for (int i = 0; i < kAcross; ++i) {
    values += columns[to_index(i)];
    ramp_x += load_lanes(kRamp.data() + i * kLanes) * columns[to_index(i)];
  }
  const float value = sum_of(values), right = sum_of(ramp_x), down = sum_of(ramp_y);
  const float light2 = value * value / kPixels + right * right + down * down;
  return {sum_of(squares) - light2, sum_of(along_t), sum_of(along_x), sum_of(along_y)};
}

bool Patch::is_inside(const Picture& image, float place_x, float place_y) const {
  return place_x >= 0.0F && place_y >= 0.0F && place_x + kSide < static_cast<float>(image.width) &&
         place_y + kSide < static_cast<float>(image.height);
}

float Patch::correlation_at(const Picture& image, float dx, float dy) const {
  const float place_x = static_cast<float>(x_) + dx, place_y = static_cast<float>(y_) + dy;
  if (!is_inside(image, place_x, place_y)) return 0.0F;
  const int x = static_cast<int>(place_x), y = static_cast<int>(place_y);
  const Sums sums =
      correlate(image, x, y, place_x - static_cast<float>(x), place_y - static_cast<float>(y));
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
    const Sums sums =
        correlate(image, x, y, place_x - static_cast<float>(x), place_y - static_cast<float>(y));
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
