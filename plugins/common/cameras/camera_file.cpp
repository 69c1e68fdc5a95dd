// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/camera_file.hpp"

#include <algorithm>
#include <utility>

#include "common/cameras/camera_formats.hpp"
#include "common/cameras/camera_reader.hpp"
#include "common/cameras/camera_values.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

Error at_the_beginning(const std::string& path, const std::string& message) {
  return {Errc::invalid_data, path + ":1:1: " + message, {}};
}

/// The first document of what `rostopic echo` and `ros2 topic echo` print: they end each message
/// with "---". Other texts are left as they are.
std::string first_message(std::string text) {
  const auto has_line = [&](const std::string& start) {
    return text.starts_with(start) || text.find("\n" + start) != text.npos;
  };
  std::size_t start = 0;  // first byte of the first line that has content
  while (start < text.size() && std::string("%#-\r\n").find(text[start]) != std::string::npos) {
    start = std::min(text.find('\n', start), text.size() - 1) + 1;
  }
  const std::size_t end = text.find("\n---", start);
  if (end == text.npos) return text;
  const std::size_t rest = text.find_first_not_of(" \t\r\n", end + 4);
  const bool is_message = has_line("distortion_model:") && (has_line("K:") || has_line("k:"));
  if (rest == text.npos || is_message) text.resize(end + 1);
  return text;
}

CameraFile read_root(const YAML::Node& root) {
  if (!root.IsMap()) {
    yaml_files::fail_at(root, "must hold keys: fx, fy, cx, cy, width and height, or those of " +
                                  std::string("OpenCV, ROS, Kalibr, ORB-SLAM or RealSense"));
  }
  return read_camera(CameraValues::of_yaml(root));
}

Result<CameraFile> read_text(const std::string& path, std::string text) {
  if (const auto title = unread_text(text)) {
    return at_the_beginning(path, "this is " + *title + ", which is not read: " + keys_to_write());
  }
  const std::size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first != text.npos && text[first] == '<') {
    return yaml_files::reading(path, text, [&] { return read_camera(CameraValues::of_xml(text)); });
  }
  if (const CameraValues colmap = CameraValues::of_colmap(text); !colmap.empty()) {
    return yaml_files::reading(path, text, [&] { return read_colmap(colmap); });
  }
  text = first_message(std::move(text));
  // OpenCV's first line is no directive of YAML; a comment in its place keeps the line numbers.
  if (first != text.npos && text.substr(first).starts_with("%YAML:")) text[first] = '#';
  auto read = yaml_files::read_yaml(path, text, read_root);
  if (read) return read;
  if (const auto slip = yaml_files::slip_in(path, text, read.error())) return *slip;
  return read;
}

}  // namespace

Result<CameraFile> read_camera_file(const std::string& path) {
  auto text = yaml_files::read_yaml_text(path, "camera");
  if (!text) return text.error();
  return read_text(path, *std::move(text));
}

}  // namespace weft::cameras
