// SPDX-License-Identifier: Apache-2.0
#include "lab/statistics/sentence_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace weft::lab {
namespace {

std::string interval_text(Interval interval, const std::string& unit) {
  return fmt::format("95 % interval {} to {}", three_digits(interval.low),
                     with_unit(interval.high, difference_unit(unit)));
}

}  // namespace

std::string three_digits(double value) { return fmt::format("{:.3g}", value + 0.0); }

std::string difference_unit(const std::string& unit) { return unit == "%" ? "points" : unit; }

std::string with_unit(double value, const std::string& unit) {
  return three_digits(value) + (unit.empty() ? "" : " " + unit);
}

std::string begun(const std::string& where, std::string word) {
  if (where.empty()) return word;
  word.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(word.front())));
  return where + ", " + word;
}

std::string begun_by_name(const std::string& where, const std::string& name) {
  return where.empty() ? name : where + ", " + name;
}

std::string p_text(double p, double p_holm, std::int64_t tests) {
  if (std::isnan(p_holm) || tests < 2) return "p = " + three_digits(p);
  return fmt::format("p = {} after Holm's correction for {} tests", three_digits(p_holm), tests);
}

Gain gain_of(const PairComparison& pair) {
  const auto& [low, high] = pair.interval;
  if (!(pair.test.mean < 0.0)) return {pair.test.mean, pair.interval};
  return {-pair.test.mean, {-high, -low}};
}

std::string two_means(double one, const char* joint, double other, const std::string& unit) {
  constexpr double kMostDecimals = 6.0;
  const double difference = std::abs(one - other);
  const std::string ending = unit.empty() ? "" : " " + unit;
  if (!(difference > 0.0)) {
    return fmt::format("{} {} {}{}", three_digits(one), joint, three_digits(other), ending);
  }
  const double decimals = std::clamp(1.0 - std::floor(std::log10(difference)), 0.0, kMostDecimals);
  return fmt::format("{:.{}f} {} {:.{}f}{}", one, static_cast<int>(decimals), joint, other,
                     static_cast<int>(decimals), ending);
}

std::string sequences_text(std::int64_t n) {
  return fmt::format("{} sequence{}", n, n == 1 ? "" : "s");
}

std::string evidence_of(const PairComparison& pair, const std::string& unit, std::int64_t tests) {
  const Interval interval = gain_of(pair).interval;
  const std::string n = ", " + sequences_text(pair.test.n);
  const std::string p = p_text(pair.test.p, pair.p_holm, tests);
  if (std::isnan(interval.low)) return p + n;
  const std::string text = interval_text(interval, unit);
  if (tests < 2) return text + ", " + p + n;
  if (!std::isnan(pair.p_holm)) return text + " and " + p + n;
  return fmt::format("{} after Holm's correction for {} tests, {}{}", text, tests, p, n);
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace weft::lab
