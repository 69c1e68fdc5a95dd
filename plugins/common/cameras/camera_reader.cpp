// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_reader.hpp"

#include <algorithm>
#include <weft/core/suggest.hpp>

#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

using yaml_files::FileMistake;

struct Match {
  const Format* format;
  std::string prefix;  ///< "cam0/"
};

/// True if the values below a path have the structure that only one format has: numbers, not a map
/// of them, but OpenCV's {rows, cols, data}.
bool fits(const CameraValues& values, const Format& format, const std::string& prefix) {
  if (format.metashape && !values.is_xml()) return false;
  const Value* value = values.find(prefix, format.signature);
  if (value == nullptr) return false;
  const bool is_list = value->kind == Value::Kind::list &&
                       std::all_of(value->words.begin(), value->words.end(),
                                   [](const Word& word) { return word.is_scalar; });
  if (format.pinhole[1].empty() && value->kind != Value::Kind::map && !is_list) return false;
  return value->kind != Value::Kind::map || values.find(value->path + "/", "data|rows") != nullptr;
}

/// The formats that fit at the root, or else those below each map.
std::vector<Match> matches_in(const CameraValues& values) {
  std::vector<std::string> prefixes{""};
  for (const Value& value : values.all()) {
    if (value.kind == Value::Kind::map) prefixes.push_back(value.path + "/");
  }
  std::vector<Match> matches;
  for (const std::string& prefix : prefixes) {
    if (!matches.empty() && matches.front().prefix.empty()) break;
    const auto& formats = known_formats();
    const auto found = std::find_if(formats.begin(), formats.end(), [&](const Format& format) {
      return fits(values, format, prefix);
    });
    if (found != formats.end()) {
      matches.push_back({&*found, prefix});
    } else if (fits(values, own_format(), prefix)) {
      matches.push_back({&own_format(), prefix});
    }
  }
  return matches;
}

void check_own_keys(const CameraValues& values) {
  const std::vector<std::string> known{
      "fx",      "fy",         "cx",   "cy",          "width", "height", "distortion",
      "comment", "convention", "name", "calibration", "k1",    "k2",     "p1",
      "p2",      "k3",         "k4",   "k5",          "k6"};
  for (const Value& value : values.all()) {
    if (value.path.find('/') != std::string::npos) continue;
    if (std::find(known.begin(), known.end(), value.path) != known.end()) continue;
    const std::size_t colon = value.path.find(':');
    if (colon != std::string::npos) {
      throw FileMistake(value.key_place, "a blank is missing after the colon of '" +
                                             value.path.substr(0, colon + 1) + "'");
    }
    throw FileMistake(value.key_place,
                      "a camera file has no key '" + value.path + "'" +
                          did_you_mean(value.path, known,
                                       ": it has fx, fy, cx, cy (px), width, height and "
                                       "distortion, and notes may be under 'comment'"));
  }
}

[[noreturn]] void refuse(const CameraValues& values) {
  if (const auto title = unread_format(values)) {
    throw FileMistake(values.place(),
                      "this is " + *title + ", which is not read: " + keys_to_write());
  }
  std::string keys;
  int count = 0;
  for (const Value& value : values.all()) {
    if (value.path.find('/') != std::string::npos || ++count > 8) continue;
    keys += (keys.empty() ? "'" : ", '") + value.path.substr(0, 40) + "'";
  }
  throw FileMistake(values.place(),
                    "is no camera file of a known format (it has " +
                        (keys.empty() ? "no keys" : keys) + "): " + keys_to_write() +
                        "; files of OpenCV, ROS, Kalibr, COLMAP (cameras.txt), ORB-SLAM, "
                        "RealSense and Metashape are read, too");
}

}  // namespace

CameraFile read_camera(const CameraValues& values) {
  const std::vector<Match> matches = matches_in(values);
  const auto has = [&](const char* paths) { return values.find("", paths) != nullptr; };
  const bool is_own = matches.empty() ? has("fx|fy") || (has("cx") && has("cy"))
                                      : matches.front().format == &own_format();
  if (is_own && (matches.empty() || matches.front().prefix.empty())) {
    check_own_keys(values);
    return read_format(values, own_format(), "");
  }
  if (matches.empty()) refuse(values);
  const Match& first = matches.front();
  // Kalibr's cameras are numbered: the first is meant.
  const bool is_chain = first.format->signature == "intrinsics";
  if (matches.size() > 1 && !is_chain) {
    throw FileMistake(values.place(),
                      "describes several cameras (" +
                          first.prefix.substr(0, first.prefix.size() - 1) + ", " +
                          matches[1].prefix.substr(0, matches[1].prefix.size() - 1) +
                          "): give a file with the values of one");
  }
  return read_format(values, *first.format, first.prefix);
}

}  // namespace weft::cameras
