// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace weft::lab {

/// The values that an axis has to show.
struct Domain {
  double low = 0.0, high = 1.0;
  bool log = false;  ///< both ends are positive then
};

/// From zero, if `from_zero`, or from the smallest value to the largest one, with a margin.
/// Logarithmic from zero if the largest value is more than 20 times the median, and all are
/// positive. Values that are not finite are ignored.
Domain domain_of(std::vector<double> values, bool from_zero);

/// A linear or logarithmic axis in pixels.
class Scale {
 public:
  Scale(const Domain& domain, double from_px, double to_px);

  double at(double value) const;
  /// Round numbers inside the domain, about four of them.
  std::vector<double> ticks() const;

 private:
  Domain domain_;
  double from_px_, to_px_;
};

/// A number at a tick: "0.05", "1e-04".
std::string tick_text(double value);

}  // namespace weft::lab
