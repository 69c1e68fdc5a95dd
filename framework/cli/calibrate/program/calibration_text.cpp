// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>

#include "cli/calibrate/program/program.hpp"

namespace weft::cli {
namespace {

constexpr std::size_t kMostNames = 10;

}  // namespace

std::string calibration_text(const calibration::Calibration& calibration) {
  constexpr std::array kLens{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  const calibration::Solution& solution = calibration.solution;
  std::string text;
  for (const std::string& name : calibration.odd) {
    text += fmt::format("excluded, as it does not fit the others: {}\n", escaped(name));
  }
  text += fmt::format("{} views used, error {:.3f} px, condition {:.1g}\n",
                      calibration.views.size(), solution.rms_px, solution.condition);
  const std::pair<const char*, double> pinhole[] = {
      {"fx", solution.fx}, {"fy", solution.fy}, {"cx", solution.cx}, {"cy", solution.cy}};
  Eigen::Index i = 0;
  for (const auto& [name, value] : pinhole) {
    text += fmt::format("  {} {:10.2f} px +- {:.2g}\n", name, value, solution.deviation[i++]);
  }
  for (std::size_t k = 0; k < solution.distortion.size(); ++k) {
    text += fmt::format("  {} {:10.5f}    +- {:.2g}\n", kLens[k], solution.distortion[k],
                        solution.deviation[i++]);
  }
  text += "error of each view, px:\n";
  for (std::size_t v = 0; v < calibration.views.size(); ++v) {
    text += fmt::format("  {:.3f}  {}\n", solution.errors[v].rms_px,
                        escaped(calibration.views[v].name));
  }
  return text;
}

std::string coverage_text(const calibration::Coverage& coverage) {
  std::string text = fmt::format("corners in the image ({:.0f} % of its parts):\n{}",
                                 100.0 * coverage.share(), coverage.grid());
  for (const std::string& what : coverage.missing()) text += "missing: " + what + "\n";
  return text;
}

std::string without_text(const std::vector<calibration::NoView>& without) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostNames, without.size()); ++i) {
    text += fmt::format("not {}: {}\n", escaped(without[i].name), without[i].reason);
  }
  if (without.size() > kMostNames) {
    text += fmt::format("and {} more\n", without.size() - kMostNames);
  }
  return text;
}

}  // namespace weft::cli
