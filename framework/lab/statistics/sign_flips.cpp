// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/sign_flips.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/rng.hpp>

namespace weft::lab {
namespace {

constexpr double kTie = 1e-12;  // relative to the sum of magnitudes

/// All 2^n sums of differences - shift with either sign, ascending.
std::vector<double> sorted_sums(std::span<const double> differences, double shift) {
  std::vector<double> sums(std::size_t{1} << differences.size()), before(sums.size() / 2 + 1);
  std::size_t count = 1;
  for (const double difference : differences) {
    const double magnitude = std::abs(difference - shift);
    std::copy_n(sums.begin(), count, before.begin());
    // Merges the sums before, less the magnitude, with the same, plus the magnitude. The lower
    // ones run out first.
    std::size_t lower = 0, upper = 0;
    while (lower < count) {
      const double less = before[lower] - magnitude, more = before[upper] + magnitude;
      const bool first = less <= more;
      sums[lower + upper] = first ? less : more;
      lower += first;
      upper += !first;
    }
    for (; upper < count; ++upper) sums[count + upper] = before[upper] + magnitude;
    count *= 2;
  }
  return sums;
}

}  // namespace

SignFlips::SignFlips(std::span<const double> differences, std::uint64_t seed)
    : differences_(differences.begin(), differences.end()) {
  const bool zero = std::all_of(differences.begin(), differences.end(),
                                [](double difference) { return difference == 0.0; });
  if (exact() || zero) return;
  Rng rng(seed);
  sample_.reserve(kSample);
  for (int k = 0; k < kSample; ++k) {
    SampledSum sum{0.0, 0.0};
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < differences_.size(); ++i) {
      if (i % 32 == 0) bits = rng.next_u32();
      const auto sign = static_cast<double>(static_cast<int>(2U * (bits >> (i % 32) & 1U)) - 1);
      sum.differences += sign * differences_[i];
      sum.signs += sign;
    }
    sample_.push_back(sum);
  }
}

double SignFlips::resolution(std::size_t n) {
  return n <= kMostExact ? std::exp2(1.0 - static_cast<double>(n)) : 1.0 / (1.0 + kSample);
}

double SignFlips::p(double shift) const {
  double sum = 0.0, magnitudes = 0.0;
  for (const double difference : differences_) {
    sum += difference - shift;
    magnitudes += std::abs(difference - shift);
  }
  const double least = std::abs(sum) - kTie * magnitudes;
  if (!(least > 0.0)) return 1.0;
  return exact() ? exact_p(shift, least) : sampled_p(shift, least);
}

// The sums of either half are few; for ascending sums of the one, those of the other that suffice
// begin ever further down (Horowitz and Sahni 1974).
double SignFlips::exact_p(double shift, double least) const {
  const std::span<const double> all(differences_);
  const auto first = sorted_sums(all.first(all.size() / 2), shift);
  const auto second = sorted_sums(all.subspan(all.size() / 2), shift);
  std::size_t begin = second.size();
  double count = 0.0;
  for (const double sum : first) {
    while (begin > 0 && sum + second[begin - 1] >= least) --begin;
    count += static_cast<double>(second.size() - begin);
  }
  return 2.0 * count / (static_cast<double>(first.size()) * static_cast<double>(second.size()));
}

double SignFlips::sampled_p(double shift, double least) const {
  const auto extreme =
      std::count_if(sample_.begin(), sample_.end(), [shift, least](const SampledSum& sum) {
        return std::abs(sum.differences - shift * sum.signs) >= least;
      });
  return (1.0 + static_cast<double>(extreme)) / (1.0 + kSample);
}

}  // namespace weft::lab
