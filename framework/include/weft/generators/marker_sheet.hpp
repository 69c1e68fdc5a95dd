// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/core/rng.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// A square fiducial marker; x right and y down from the top left corner of the paper.
struct SheetMarker {
  int id = 0;            ///< [] index in the dictionary
  Points2 corners_mm{};  ///< [4,2] mm, clockwise in the image, from the marker's top left corner

  Eigen::Vector2d centre_mm() const { return corners_mm.colwise().mean(); }
};

/// A flat paper with fiducial markers.
struct MarkerSheet {
  double width_mm = 0.0;               ///< [] mm, width of the paper
  double height_mm = 0.0;              ///< [] mm, height of the paper
  std::string dictionary;              ///< "5x5_250" or "4x4_250", of OpenCV's ArUco module
  std::vector<SheetMarker> markers{};  ///< [.] markers in the order of their indices
};

/// Layout of markers; the defaults describe an A4 paper.
struct MarkerSheetSpec {
  static constexpr int kCaption_mm =
      8;  ///< height of the lowest strip, reserved for a line of text

  int width_mm = 297;                  ///< width of the paper
  int height_mm = 210;                 ///< height of the paper
  int count = 100;                     ///< [] number of markers
  int marker_mm = 14;                  ///< side of a marker
  int gap_mm = 3;                      ///< minimum white gap between two markers, in x or in y
  int margin_mm = 5;                   ///< minimum white margin along the edges
  std::int64_t seed = 1;               ///< [] seed of the positions
  std::string dictionary = "5x5_250";  ///< as in MarkerSheet
};

namespace detail {

/// Makes one attempt: each marker takes the free candidate farthest from the other markers.
inline std::vector<std::pair<int, int>> place_markers(const MarkerSheetSpec& spec, Rng& rng) {
  constexpr int kMostFailures = 2000, kCandidates = 5;
  const int across = spec.width_mm - 2 * spec.margin_mm - spec.marker_mm + 1;
  const int bottom_mm = std::max(spec.margin_mm, MarkerSheetSpec::kCaption_mm);
  const int down = spec.height_mm - spec.margin_mm - bottom_mm - spec.marker_mm + 1;
  std::vector<std::pair<int, int>> places;
  if (across < 1 || down < 1) return places;
  const auto distance_mm = [&](int x, int y) {
    int least = std::numeric_limits<int>::max();
    for (const auto& [a, b] : places) {
      least = std::min(least, std::max(std::abs(x - a), std::abs(y - b)));
    }
    return least;
  };
  for (int failures = 0; static_cast<int>(places.size()) < spec.count && failures < kMostFailures;
       ++failures) {
    int farthest = spec.marker_mm + spec.gap_mm - 1;
    std::optional<std::pair<int, int>> best;
    for (int candidate = 0; candidate < kCandidates; ++candidate) {
      const int x = spec.margin_mm + static_cast<int>(rng.below(static_cast<unsigned>(across)));
      const int y = spec.margin_mm + static_cast<int>(rng.below(static_cast<unsigned>(down)));
      if (const int distance = distance_mm(x, y); distance > farthest) {
        farthest = distance;
        best = {x, y};
      }
    }
    if (!best) continue;
    places.push_back(*best);
    failures = -1;
  }
  return places;
}

}  // namespace detail

/// Places markers 0 to count - 1 at random positions in whole millimetres, upright, by
/// best-candidate sampling. The same spec gives the same layout on every platform. Fails if the
/// markers do not fit.
inline Result<MarkerSheet> lay_out_markers(const MarkerSheetSpec& spec) {
  constexpr int kAttempts = 20;
  Rng rng(static_cast<std::uint64_t>(spec.seed));
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto places = detail::place_markers(spec, rng);
    if (static_cast<int>(places.size()) < spec.count) continue;
    MarkerSheet sheet{static_cast<double>(spec.width_mm), static_cast<double>(spec.height_mm),
                      spec.dictionary};
    for (const auto& [x, y] : places) {
      SheetMarker marker{static_cast<int>(sheet.markers.size()), Points2(4, 2)};
      marker.corners_mm << x, y, x + spec.marker_mm, y, x + spec.marker_mm, y + spec.marker_mm, x,
          y + spec.marker_mm;
      sheet.markers.push_back(std::move(marker));
    }
    return sheet;
  }
  return Error{Errc::invalid_value,
               std::to_string(spec.count) + " markers of " + std::to_string(spec.marker_mm) +
                   " mm with gaps of " + std::to_string(spec.gap_mm) +
                   " mm do not fit on a page of " + std::to_string(spec.width_mm) + " x " +
                   std::to_string(spec.height_mm) + " mm: take fewer, smaller or closer ones"};
}

/// Encodes the layout as YAML for sources. Numbers are integers or have up to 3 decimals.
inline std::string to_yaml(const MarkerSheet& sheet) {
  const auto number = [](double value) {
    std::string text = std::to_string(std::round(value * 1000.0) / 1000.0);
    text.erase(text.find('.') + 4);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  const auto pair = [&](const auto& p) { return "[" + number(p.x()) + ", " + number(p.y()) + "]"; };
  std::string text =
      "# Printed markers: mm, x right and y down from the top left corner of the page; corners\n"
      "# are clockwise from the marker's own top left one.\n"
      "marker_sheet: 1\ndictionary: " +
      sheet.dictionary + "\nwidth_mm: " + number(sheet.width_mm) +
      "\nheight_mm: " + number(sheet.height_mm) + "\nmarkers:\n";
  for (const SheetMarker& marker : sheet.markers) {
    text += "  - {id: " + std::to_string(marker.id) + ", centre_mm: " + pair(marker.centre_mm()) +
            ", corners_mm: [";
    for (int k = 0; k < 4; ++k) {
      text += (k > 0 ? ", " : "") + pair(Eigen::Vector2d(marker.corners_mm.row(k)));
    }
    text += "]}\n";
  }
  return text;
}

}  // namespace weft
