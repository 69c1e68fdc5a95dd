// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/camera_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace weft::calibration {
namespace {

/// Our files have 0, 5 or 8 numbers: k3 is 0 if it was not estimated.
std::string list(std::vector<double> numbers) {
  if (numbers.size() == 4) numbers.push_back(0.0);
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

/// A JSON string, which YAML reads too.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string rounded_list(const std::vector<double>& numbers) {
  return fmt::format("[{:.2g}]", fmt::join(numbers, ", "));
}

}  // namespace

std::string camera_text(const Calibration& calibration) {
  const Solution& solution = calibration.solution;
  const Eigen::VectorXd& deviation = solution.deviation;
  std::string text = "# Made by `weft calibrate`; +- is one standard deviation.\n";
  const std::pair<const char*, double> values[] = {
      {"fx", solution.fx}, {"fy", solution.fy}, {"cx", solution.cx}, {"cy", solution.cy}};
  for (int i = 0; i < 4; ++i) {
    text += fmt::format("{}: {:.4f}  # px, +- {:.2g}\n", values[i].first, values[i].second,
                        deviation[i]);
  }
  text +=
      fmt::format("width: {}\nheight: {}\n", calibration.size.width_px, calibration.size.height_px);
  if (solution.distortion.empty()) {
    text += "distortion: null\n";
  } else {
    text +=
        fmt::format("distortion: {{model: brown, coefficients: {}}}\n", list(solution.distortion));
  }
  const std::vector<double> of_lens(deviation.data() + 4, deviation.data() + deviation.size());
  text += fmt::format(
      "calibration:\n  rms_px: {:.4f}\n  condition: {:.2g}\n  standard_deviations: {{fx: {:.2g}, "
      "fy: {:.2g}, cx: {:.2g}, cy: {:.2g}, coefficients: {}}}\n  images:\n",
      solution.rms_px, solution.condition, deviation[0], deviation[1], deviation[2], deviation[3],
      rounded_list(of_lens));
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    text += fmt::format("    - {{name: {}, corners: {}, rms_px: {:.4f}}}\n",
                        quoted(calibration.views[i].name), calibration.views[i].image_px.rows(),
                        solution.errors[i].rms_px);
  }
  return text;
}

}  // namespace weft::calibration
