// SPDX-License-Identifier: Apache-2.0
#include "lab/report/drawing/colours.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace weft::lab {

std::string rgb_of(ColourName name) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 13> kColours = {
      {{"paper", "fdfdfb"},
       {"ink", "1d1f21"},
       {"muted", "5d6166"},
       {"rule", "e3e3dd"},
       {"rule-strong", "a9aaa6"},
       {"series-1", "0b6bb3"},
       {"series-2", "d1560a"},
       {"series-3", "13855f"},
       {"series-4", "a84f8c"},
       {"series-5", "a97800"},
       {"series-6", "2e93b8"},
       {"series-7", "6a4fb0"},
       {"series-8", "5a5f66"}}};
  for (const auto& [known, rgb] : kColours) {
    if (known == name) return rgb;
  }
  return rgb_of("ink");
}

ColourName series_colour(std::size_t n) {
  static constexpr std::array<ColourName, 8> kSeries = {"series-1", "series-2", "series-3",
                                                        "series-4", "series-5", "series-6",
                                                        "series-7", "series-8"};
  return kSeries[n % kSeries.size()];
}

}  // namespace weft::lab
