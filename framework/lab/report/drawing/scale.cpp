// SPDX-License-Identifier: Apache-2.0
#include "lab/report/drawing/scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weft::lab {
namespace {

constexpr double kManyTimesMedian = 20.0;
constexpr double kMargin = 0.04;

/// 1, 2 or 5 times a power of ten: the smallest that is no smaller.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1.0 - 1e-9)) return step * power;
  }
  return 10.0 * power;
}

}  // namespace

Domain domain_of(std::vector<double> values, bool from_zero) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double low = values.front(), high = values.back();
  if (from_zero && low > 0.0 && high > kManyTimesMedian * values[values.size() / 2]) {
    return {low / 1.1, high * 1.1, true};
  }
  const double length = from_zero ? std::max(high, 0.0) - std::min(low, 0.0) : high - low;
  const double margin = kMargin * (length > 0.0 ? length : std::max(std::abs(high), 1.0));
  const double from = from_zero && low >= 0.0 ? 0.0 : low - margin;
  return {from, from_zero && high <= 0.0 ? margin : high + margin, false};
}

Scale::Scale(const Domain& domain, double from_px, double to_px)
    : domain_(domain), from_px_(from_px), to_px_(to_px) {}

double Scale::at(double value) const {
  const auto place = [&](double one) {
    return domain_.log ? std::log(std::max(one, 1e-300)) : one;
  };
  const double low = place(domain_.low), high = place(domain_.high);
  const double share = (place(value) - low) / (high - low);
  return from_px_ + std::clamp(share, 0.0, 1.0) * (to_px_ - from_px_);
}

std::vector<double> Scale::ticks() const {
  std::vector<double> ticks;
  if (!domain_.log) {
    const double step = round_up((domain_.high - domain_.low) / 4.5);
    const double first = std::ceil(domain_.low / step - 1e-9);
    const auto steps = static_cast<int>(std::floor(domain_.high / step - first));
    for (int i = 0; i <= steps; ++i) ticks.push_back((first + i) * step + 0.0);
    return ticks;
  }
  const double decades = std::log10(domain_.high / domain_.low);
  const double lowest = std::floor(std::log10(domain_.low));
  const auto powers = static_cast<int>(std::floor(std::log10(domain_.high) - lowest));
  for (int i = 0; i <= powers; ++i) {
    const double power = std::pow(10.0, lowest + i);
    for (const double step : {1.0, 2.0, 5.0}) {
      if (decades > 2.0 && step > 1.0) continue;
      if (step * power >= domain_.low && step * power <= domain_.high) {
        ticks.push_back(step * power);
      }
    }
  }
  return ticks;
}

std::string tick_text(double value) { return fmt::format("{:.4g}", value); }

}  // namespace weft::lab
