// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

/// Order statistics of numbers. All functions return NaN for an empty input and for an input that
/// contains NaN.
namespace weft {

/// Standard deviation of a normal distribution divided by its median absolute deviation.
inline constexpr double kSigmaPerMad = 1.4826;

namespace detail {
inline bool unordered(std::span<const double> values) {
  return values.empty() ||
         std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); });
}
}  // namespace detail

/// Arithmetic mean, summed in the given order.
inline double mean(std::span<const double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Standard deviation of the population from a sample, with n - 1; NaN for a single value.
inline double standard_deviation(std::span<const double> values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const double centre = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// Median; the mean of the two middle values for an even count. Reorders `values`.
inline double median_in_place(std::span<double> values) {
  if (detail::unordered(values)) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

/// Median of a copy.
inline double median(std::span<const double> values) {
  std::vector<double> copy(values.begin(), values.end());
  return median_in_place(copy);
}

/// Percentile with linear interpolation between the order statistics (rank p/100 * (n-1)).
/// `percent` outside [0, 100] is clamped.
inline double percentile(std::span<const double> values, double percent) {
  if (detail::unordered(values) || std::isnan(percent)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<double> copy(values.begin(), values.end());
  const double rank =
      std::clamp(percent, 0.0, 100.0) / 100.0 * static_cast<double>(copy.size() - 1);
  const auto below = copy.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(copy.begin(), below, copy.end());
  const double fraction = rank - std::floor(rank);
  if (fraction == 0.0) return *below;
  const double above = *std::min_element(below + 1, copy.end());
  return above == *below ? above : (1.0 - fraction) * *below + fraction * above;
}

/// Median of |x - median|, without the factor `kSigmaPerMad`.
inline double median_absolute_deviation(std::span<const double> values) {
  std::vector<double> deviations(values.begin(), values.end());
  const double centre = median_in_place(deviations);
  for (double& value : deviations) value = std::abs(value - centre);
  return median_in_place(deviations);
}

}  // namespace weft
