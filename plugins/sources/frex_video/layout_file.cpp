// SPDX-License-Identifier: Apache-2.0
#include "layout_file.hpp"

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string_view>
#include <utility>

#include "common/yaml/yaml_file.hpp"

namespace weft::frex_video {
namespace {

constexpr double kLargest_mm = 1e5;
constexpr double kSameCentre_mm = 0.01;

class Reader {
 public:
  MarkerSheet read(const YAML::Node& root) const {
    check_keys(root, {"marker_sheet", "dictionary", "width_mm", "height_mm", "markers"});
    if (at(root, "marker_sheet").as<std::string>("") != "1") {
      fail(root["marker_sheet"], "only 'marker_sheet: 1' can be read");
    }
    MarkerSheet sheet;
    sheet.dictionary = at(root, "dictionary").as<std::string>("");
    if (sheet.dictionary != "5x5_250" && sheet.dictionary != "4x4_250") {
      fail(root["dictionary"], "'dictionary' must be 5x5_250 or 4x4_250");
    }
    sheet.width_mm = number(at(root, "width_mm"), "width_mm");
    sheet.height_mm = number(at(root, "height_mm"), "height_mm");
    if (!(sheet.width_mm > 0.0 && sheet.height_mm > 0.0)) {
      fail(root, "'width_mm' and 'height_mm' must be larger than 0");
    }
    std::set<int> ids;
    const YAML::Node markers = at(root, "markers");
    if (!markers.IsSequence()) fail(markers, "'markers' must be a list");
    for (const auto& node : markers) {
      sheet.markers.push_back(marker(node, sheet));
      if (!ids.insert(sheet.markers.back().id).second) {
        fail(node, "the id " + std::to_string(sheet.markers.back().id) + " is given twice");
      }
    }
    return sheet;
  }

 private:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& message) const {
    yaml_files::fail_at(node, message);
  }

  /// yaml-cpp keeps both values of a key that is given twice and answers with the first.
  void check_keys(const YAML::Node& map, std::initializer_list<std::string_view> known) const {
    if (!map.IsMap()) fail(map, "must hold keys; write the layout with `weft data make frex`");
    std::set<std::string> found;
    for (const auto& entry : map) {
      const std::string key = entry.first.as<std::string>("");
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        fail(entry.first, "the key '" + key + "' is unknown");
      }
      if (!found.insert(key).second) fail(entry.first, "'" + key + "' is given twice: remove one");
    }
  }

  YAML::Node at(const YAML::Node& map, const std::string& key) const {
    const YAML::Node node = map[key];
    if (!node.IsDefined() || node.IsNull()) fail(map, "has no '" + key + "'");
    return node;
  }

  double number(const YAML::Node& node, const std::string& name) const {
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    double value = 0.0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = code == std::errc{} && end == text.data() + text.size();
    if (!whole || !(std::abs(value) <= kLargest_mm)) {
      fail(node, "'" + name + "' must be a number of at most 100000");
    }
    return value;
  }

  Eigen::Vector2d point(const YAML::Node& node, const std::string& name) const {
    if (!node.IsSequence() || node.size() != 2) fail(node, "'" + name + "' must be [x, y]");
    return {number(node[0], name), number(node[1], name)};
  }

  SheetMarker marker(const YAML::Node& node, const MarkerSheet& sheet) const {
    check_keys(node, {"id", "centre_mm", "corners_mm"});
    SheetMarker marker{0, Points2(4, 2)};
    const double id = number(at(node, "id"), "id");
    if (id != std::floor(id) || id < 0.0) fail(node["id"], "'id' must be a whole number from 0");
    marker.id = static_cast<int>(id);
    const YAML::Node corners = at(node, "corners_mm");
    if (!corners.IsSequence() || corners.size() != 4) {
      fail(corners, "'corners_mm' must be four pairs [x, y]");
    }
    for (int k = 0; k < 4; ++k) marker.corners_mm.row(k) = point(corners[k], "corners_mm");
    check_place(corners, marker.corners_mm, sheet);
    if ((point(at(node, "centre_mm"), "centre_mm") - marker.centre_mm()).norm() > kSameCentre_mm) {
      fail(node["centre_mm"], "'centre_mm' is not the centre of 'corners_mm'");
    }
    return marker;
  }

  void check_place(const YAML::Node& node, const Points2& corners, const MarkerSheet& sheet) const {
    if (corners.minCoeff() < 0.0 || corners.col(0).maxCoeff() > sheet.width_mm ||
        corners.col(1).maxCoeff() > sheet.height_mm) {
      fail(node, "a corner is outside the page");
    }
    for (int k = 0; k < 4; ++k) {
      const Eigen::RowVector2d a = corners.row((k + 1) % 4) - corners.row(k);
      const Eigen::RowVector2d b = corners.row((k + 2) % 4) - corners.row((k + 1) % 4);
      if (!(a.x() * b.y() - a.y() * b.x() > 0.0)) {
        fail(node, "'corners_mm' must go round clockwise (x right, y down)");
      }
    }
  }
};

}  // namespace

Result<MarkerSheet> read_layout_file(const std::string& path) {
  const auto text = yaml_files::read_yaml_text(path, "layout");
  if (!text) return text.error();
  return yaml_files::read_yaml(path, *text,
                               [&](const YAML::Node& root) { return Reader().read(root); });
}

}  // namespace weft::frex_video
