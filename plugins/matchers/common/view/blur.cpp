// SPDX-License-Identifier: Apache-2.0
#include "common/view/blur.hpp"

#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::view {
namespace {

/// One half of a normal kernel, from its middle on; all of it has the sum 1.
std::vector<float> half_kernel(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(2.5 * sigma_px));
  std::vector<float> half;
  double sum = 0.0;
  for (int k = 0; k <= reach; ++k) {
    const double value = std::exp(-0.5 * k * k / (sigma_px * sigma_px));
    half.push_back(static_cast<float>(value));
    sum += k == 0 ? value : 2.0 * value;
  }
  for (float& value : half) value /= static_cast<float>(sum);
  return half;
}

/// Filters along x or, with the roles of rows and columns exchanged, along y. Beyond the border the
/// values are 0.
void filter(const std::vector<float>& half, int length, int lines, int step, int line_step,
            std::vector<float>& values) {
  const int reach = static_cast<int>(half.size()) - 1;
  std::vector<float> line(to_index(length + 2 * reach));
  for (int j = 0; j < lines; ++j) {
    ask_to_go_on();
    float* first = values.data() + std::ptrdiff_t{j} * line_step;
    for (int i = 0; i < length; ++i) line[to_index(reach + i)] = first[std::ptrdiff_t{i} * step];
    for (int i = 0; i < length; ++i) {
      const float* middle = line.data() + reach + i;
      float sum = half[0] * middle[0];
      for (int k = 1; k <= reach; ++k) sum += half[to_index(k)] * (middle[-k] + middle[k]);
      first[std::ptrdiff_t{i} * step] = sum;
    }
  }
}

/// Sums over pixels and over pairs of neighbours.
class Sharpness {
 public:
  void add(float here, float right, float below) {
    const double value = here;
    sum_ += value;
    squares_ += value * value;
    const double along = right - here, across = below - here;
    gradients_ += along * along + across * across;
    ++count_;
  }
  /// Energy of the gradients relative to the contrast; 0 without contrast.
  double value() const {
    if (count_ == 0) return 0.0;
    const double mean = sum_ / static_cast<double>(count_);
    const double variance = squares_ / static_cast<double>(count_) - mean * mean;
    return variance > 1e-3 ? gradients_ / static_cast<double>(count_) / variance : 0.0;
  }

 private:
  double sum_ = 0.0, squares_ = 0.0, gradients_ = 0.0;
  long count_ = 0;
};

/// Calls `use(x, y)` for the rendered pixels whose right and lower neighbours are rendered too.
template <class Use>
void for_each_drawn(const ViewLevel& level, const Use& use) {
  for (int y = 0; y + 1 < level.grey.height; ++y) {
    ask_to_go_on();
    const std::uint8_t *here = level.drawn_row(y), *below = level.drawn_row(y + 1);
    for (int x = 0; x + 1 < level.grey.width; ++x) {
      if (here[x] != 0 && here[x + 1] != 0 && below[x] != 0) use(x, y);
    }
  }
}

double sharpness_of(const ViewLevel& level) {
  Sharpness sharpness;
  for_each_drawn(level, [&](int x, int y) {
    const float* row = level.grey.row(y);
    sharpness.add(row[x], row[x + 1], level.grey.row(y + 1)[x]);
  });
  return sharpness.value();
}

/// That of the image where the view is rendered, displaced by whole pixels.
double sharpness_of(const ViewLevel& level, const Picture& image, int dx, int dy) {
  Sharpness sharpness;
  for_each_drawn(level, [&](int x, int y) {
    const int column = level.x0 + x + dx, line = level.y0 + y + dy;
    if (column < 0 || line < 0 || column + 1 >= image.width || line + 1 >= image.height) return;
    const float* row = image.row(line);
    sharpness.add(row[column], row[column + 1], image.row(line + 1)[column]);
  });
  return sharpness.value();
}

}  // namespace

void blur_drawn(double sigma_px, ViewLevel& level) {
  if (!(sigma_px > 0.0)) return;
  const int width = level.grey.width, height = level.grey.height;
  const std::vector<float> half = half_kernel(sigma_px);
  const std::size_t count = to_index(width) * to_index(height);
  std::vector<float> weights(count), values(count);
  for (std::size_t i = 0; i < count; ++i) {
    weights[i] = level.drawn[i] != 0 ? 1.0F : 0.0F;
    values[i] = weights[i] * level.grey.values[i];
  }
  for (std::vector<float>* each : {&weights, &values}) {
    filter(half, width, height, 1, width, *each);
    filter(half, height, width, width, 1, *each);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (level.drawn[i] != 0) level.grey.values[i] = values[i] / weights[i];
  }
}

double blur_of_image(const PredictedView& view, const Pyramid& image, int k,
                     const Eigen::Vector2d& shift_px, double most_px) {
  constexpr double kAboutAsSharp = 0.6, kFirst_px = 0.5, kStep = 1.25;
  const double scale = static_cast<double>(1 << k);
  const int dx = static_cast<int>(std::lround(shift_px.x() / scale));
  const int dy = static_cast<int>(std::lround(shift_px.y() / scale));
  const double wanted = sharpness_of(view.level(k), image.level(k), dx, dy);
  double before = sharpness_of(view.level(k));
  if (!(wanted > 0.0) || wanted > kAboutAsSharp * before) return 0.0;
  ViewLevel blurred = view.level(k);
  double sigma_px = 0.0;
  for (double next_px = kFirst_px; next_px * scale <= kStep * most_px; next_px *= kStep) {
    blur_drawn(std::sqrt(next_px * next_px - sigma_px * sigma_px), blurred);
    const double now = sharpness_of(blurred);
    if (now <= wanted) {
      const double share = std::log(before / wanted) / std::log(before / std::max(now, 1e-9));
      return std::min(most_px, scale * (sigma_px + share * (next_px - sigma_px)));
    }
    before = now;
    sigma_px = next_px;
  }
  return most_px;
}

}  // namespace weft::view
