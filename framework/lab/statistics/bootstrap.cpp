// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/bootstrap.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/core/statistics.hpp>

#include "lab/statistics/paired_test.hpp"

namespace weft::lab {
namespace {

constexpr int kResamples = 2000;

std::vector<double> resampled_means(std::span<const double> values, std::uint64_t seed) {
  Rng rng(seed);
  const auto count = static_cast<std::uint32_t>(values.size());
  std::vector<double> means(kResamples);
  for (double& mean : means) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) sum += values[rng.below(count)];
    mean = sum / count;
  }
  return means;
}

/// Skewness of the jackknifed mean over six (eq. 14.15). Omitting value i moves the mean by (mean -
/// x_i) / (n - 1), and the factor cancels.
double acceleration(std::span<const double> values, double centre) {
  double squares = 0.0, cubes = 0.0;
  for (const double value : values) {
    squares += std::pow(value - centre, 2);
    cubes += std::pow(value - centre, 3);
  }
  return squares > 0.0 ? cubes / (6.0 * std::pow(squares, 1.5)) : 0.0;
}

}  // namespace

Interval bootstrap_interval(std::span<const double> values, std::uint64_t seed) {
  if (static_cast<std::int64_t>(values.size()) < kLeastSequences) return {};
  const double centre = mean(values);
  const std::vector<double> means = resampled_means(values, seed);
  double below = 0.0;
  for (const double each : means) below += each < centre ? 1.0 : each == centre ? 0.5 : 0.0;
  const boost::math::normal normal;
  // Half a resample keeps the quantile finite.
  const double share = std::clamp(below, 0.5, kResamples - 0.5) / kResamples;
  const double bias = boost::math::quantile(normal, share);
  const double skew = acceleration(values, centre);
  const auto end = [&](double level) {
    const double z = bias + boost::math::quantile(normal, level);
    const double corrected = boost::math::cdf(normal, bias + z / (1.0 - skew * z));
    return percentile(means, 100.0 * corrected);
  };
  return {end(0.5 * kAlpha), end(1.0 - 0.5 * kAlpha)};
}

}  // namespace weft::lab
