// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/paired_test.hpp"

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>

#include "lab/statistics/sign_flips.hpp"

namespace weft::lab {
namespace {

constexpr int kHalvings = 26;
constexpr double kRounding = 1e-12;  // relative: what equal differences may spread

/// Computes in double: the same everywhere, and enough.
using Plain = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

/// The shift at which the test begins to reject on the way from the mean to an extreme, from the
/// rejected side.
double end_of_interval(const SignFlips& flips, double mean, double extreme, double level) {
  double inside = mean, outside = extreme;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (flips.p(middle) > level ? inside : outside) = middle;
  }
  return outside;
}

Interval interval_of(const SignFlips& flips, std::span<const double> differences, double level) {
  if (std::ssize(differences) < kLeastSequences) return {};
  if (!(SignFlips::resolution(differences.size()) <= level)) return {};
  const double middle = mean(differences);
  const auto [least, most] = std::minmax_element(differences.begin(), differences.end());
  return {end_of_interval(flips, middle, *least, level),
          end_of_interval(flips, middle, *most, level)};
}

/// The largest level up to `alpha` that the p of n differences of distinct size can take.
double attained_level(std::int64_t n, double alpha) {
  const double step = SignFlips::resolution(to_index(n));
  return std::floor(alpha / step) * step;
}

}  // namespace

PairedTest test_differences(std::span<const double> differences, std::uint64_t seed) {
  PairedTest test;
  test.n = static_cast<std::int64_t>(differences.size());
  if (differences.empty()) return test;
  test.mean = mean(differences);
  test.standard_deviation = standard_deviation(differences);
  const bool spread = test.standard_deviation > kRounding * std::abs(test.mean);
  if (spread) test.standardised = test.mean / test.standard_deviation;
  const SignFlips flips(differences, seed);
  test.exact = flips.exact();
  test.p = flips.p(0.0);
  test.ties = std::count(differences.begin(), differences.end(), 0.0);
  test.least_p = std::max(least_p_of(test.n - test.ties), SignFlips::resolution(to_index(test.n)));
  test.interval = interval_of(flips, differences, kAlpha);
  return test;
}

Interval interval_at(std::span<const double> differences, double level, std::uint64_t seed) {
  return interval_of(SignFlips(differences, seed), differences, level);
}

double least_p_of(std::int64_t n) {
  return n < 1 ? 1.0
               : std::max(std::exp2(1.0 - static_cast<double>(n)),
                          SignFlips::resolution(to_index(n)));
}

double smallest_effect(double standard_deviation, std::int64_t n, double alpha, double power) {
  const double level = n < 2 ? 0.0 : attained_level(n, alpha);
  if (!(level > 0.0) || !std::isfinite(standard_deviation)) return kUnknown;
  const auto freedom = static_cast<double>(n - 1);
  const double critical = boost::math::quantile(
      boost::math::students_t_distribution<double, Plain>(freedom), 1.0 - 0.5 * level);
  const auto power_at = [&](double noncentrality) {
    const boost::math::non_central_t_distribution<double, Plain> t(freedom, noncentrality);
    return boost::math::cdf(boost::math::complement(t, critical)) + boost::math::cdf(t, -critical);
  };
  double low = 0.0, high = 1.0;
  while (power_at(high) < power) high *= 2.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (power_at(middle) < power ? low : high) = middle;
  }
  return high * standard_deviation / std::sqrt(static_cast<double>(n));
}

}  // namespace weft::lab
