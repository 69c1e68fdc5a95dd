// SPDX-License-Identifier: Apache-2.0
#include "cli/results/forecast_text.hpp"

#include <fmt/core.h>

#include <cmath>

#include "cli/output/duration_text.hpp"
#include "lab/ablation/forecast.hpp"

namespace weft::cli {
namespace {

std::string size_text(double bytes) {
  constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < std::size(kUnits)) bytes /= 1000.0, ++unit;
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

/// "  solver: a (6 of 6), b (3 of 6)".
void print_axis(const std::string& name, const std::vector<lab::ValueProgress>& values) {
  std::string line;
  for (const lab::ValueProgress& value : values) {
    line += fmt::format("{} {} ({} of {})", line.empty() ? "" : ",", value.name, value.finished,
                        value.cells);
  }
  fmt::print("  {}:{}\n", name, line);
}

}  // namespace

void print_forecast(const lab::AblationState& state, const std::string& folder, const Pace& pace) {
  const double bytes = lab::bytes_in(folder);
  lab::Forecast forecast = lab::forecast(state, bytes, pace.processes);
  if (pace.cell_seconds && forecast.finished > 0) {
    forecast.seconds_left =
        *pace.cell_seconds * static_cast<double>(forecast.missing) / pace.processes;
  }
  for (const auto& [axis, values] : forecast.axes) print_axis(axis, values);
  if (forecast.missing > 0) {
    const std::string left =
        std::isnan(forecast.seconds_left)
            ? "not known before the first cells are done here"
            : fmt::format("about {} left with {} (mean of {} finished)",
                          duration_text(forecast.seconds_left), pace.by, forecast.finished);
    fmt::print("time: {}\n", left);
  }
  const bool more = forecast.missing > 0 && !std::isnan(forecast.bytes_left);
  fmt::print("disk: {} in {}{}\n", size_text(bytes), folder,
             more ? fmt::format(", about {} more", size_text(forecast.bytes_left)) : "");
}

}  // namespace weft::cli
