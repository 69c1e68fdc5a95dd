// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/overview/wiring_chart.hpp"

namespace weft {

// A chart in each format. A filled mark is an output or a required input, an open one an input
// that is used if it is present. Names need no escapes: they have letters, digits, _ . / and #.

std::string chart_text(const WiringChart& chart);  ///< for a terminal, in UTF-8
std::string chart_svg(const WiringChart& chart);   ///< a whole SVG file, for light and dark pages
std::string chart_mermaid(const WiringChart& chart);
std::string chart_dot(const WiringChart& chart);  ///< for Graphviz

}  // namespace weft
