// SPDX-License-Identifier: Apache-2.0
#include "foxglove/channels.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <weft/core/base64.hpp>
#include <weft/core/version.hpp>

#include "json_text.hpp"
#include "messages.hpp"

namespace weft::live::foxglove {
namespace {

using nlohmann::ordered_json;

constexpr std::uint64_t kNsPerS = 1'000'000'000;

std::string stamp(std::uint64_t time_ns) {
  std::string text = "\"timestamp\":{\"sec\":";
  add_number(text, time_ns / kNsPerS);
  text += ",\"nsec\":";
  add_number(text, time_ns % kNsPerS);
  return text + "}";
}

std::string image_message(ShownFrame& frame, const LiveSetup&) {
  const std::string& jpeg = frame.jpeg();
  if (jpeg.empty()) return {};
  return "{" + stamp(frame.copy().taken_ns) + R"(,"frame_id":"camera","data":")" + base64(jpeg) +
         R"(","format":"jpeg"})";
}

/// Blue where the shape was measured, yellow where that is weak, grey where it is an older one.
const char* color_of(ShapeState state) {
  if (state == ShapeState::estimated) return R"({"r":0.2,"g":0.5,"b":0.9,"a":0.9})";
  if (state == ShapeState::weak) return R"({"r":0.9,"g":0.7,"b":0.2,"a":0.9})";
  return R"({"r":0.6,"g":0.6,"b":0.6,"a":0.5})";
}

void add_triangles(std::string& text, const FrameCopy& frame, const LiveSetup& setup) {
  text += R"({"pose":{"position":{"x":0,"y":0,"z":0},"orientation":{"x":0,"y":0,"z":0,"w":1}},)";
  text += R"("points":[)";
  for (std::size_t i = 0; i + 2 < frame.vertices_m.size(); i += 3) {
    text += i > 0 ? ",{\"x\":" : "{\"x\":";
    add_number(text, frame.vertices_m[i]);
    text += ",\"y\":";
    add_number(text, frame.vertices_m[i + 1]);
    text += ",\"z\":";
    add_number(text, frame.vertices_m[i + 2]);
    text += "}";
  }
  text += "],\"color\":" + std::string(color_of(frame.state)) + ",\"colors\":[],\"indices\":[";
  for (std::size_t i = 0; i < setup.faces.size(); ++i) {
    if (i > 0) text += ',';
    add_number(text, setup.faces[i]);
  }
  text += "]}";
}

std::string mesh_message(ShownFrame& shown, const LiveSetup& setup) {
  const FrameCopy& frame = shown.copy();
  if (frame.vertices_m.empty()) {
    return R"({"deletions":[{)" + stamp(frame.taken_ns) + R"(,"type":1,"id":""}],"entities":[]})";
  }
  std::string text = R"({"deletions":[],"entities":[{)" + stamp(frame.taken_ns) +
                     R"(,"frame_id":"camera","id":"mesh","lifetime":{"sec":0,"nsec":0},)" +
                     R"("frame_locked":true,"metadata":[{"key":"state","value":")" +
                     to_string(frame.state) +
                     R"("}],"arrows":[],"cubes":[],"spheres":[],"cylinders":[],"lines":[],)" +
                     R"("texts":[],"models":[],"triangles":[)";
  add_triangles(text, frame, setup);
  return text + "]}]}";
}

/// The camera of the sent image, which may be smaller than the original.
std::string camera_message(ShownFrame& frame, const LiveSetup& setup) {
  const Camera& camera = setup.camera;
  const std::int64_t sent_px = setup.style.width_px;
  const bool is_smaller = sent_px > 0 && sent_px < camera.width_px;
  const std::int64_t width_px = is_smaller ? sent_px : camera.width_px;
  const std::int64_t height_px =
      is_smaller ? std::max<std::int64_t>(1, camera.height_px * sent_px / camera.width_px)
                 : camera.height_px;
  const double x = static_cast<double>(width_px) / static_cast<double>(camera.width_px);
  const double y = static_cast<double>(height_px) / static_cast<double>(camera.height_px);
  const double fx = x * camera.fx, cx = x * (camera.cx + 0.5) - 0.5;
  const double fy = y * camera.fy, cy = y * (camera.cy + 0.5) - 0.5;
  std::string text = "{" + stamp(frame.copy().taken_ns) + R"(,"frame_id":"camera","width":)" +
                     std::to_string(width_px) + ",\"height\":" + std::to_string(height_px);
  text += R"(,"distortion_model":"","D":[],)";
  const ordered_json matrices{{"K", {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}},
                              {"R", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                              {"P", {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0}}};
  return text + matrices.dump().substr(1);
}

/// The world looks as a viewer of 3D scenes has it: x forward, y to the left, z up.
std::string transforms_message(ShownFrame& frame, const LiveSetup&) {
  return R"({"transforms":[{)" + stamp(frame.copy().taken_ns) +
         R"(,"parent_frame_id":"world","child_frame_id":"camera",)" +
         R"("translation":{"x":0,"y":0,"z":0},)" +
         R"("rotation":{"x":-0.5,"y":0.5,"z":-0.5,"w":0.5}}]})";
}

std::string report_message(ShownFrame& frame, const LiveSetup&) { return frame.copy().report; }

}  // namespace

const std::array<Channel, 5>& channels() {
  static const std::array<Channel, 5> kChannels{{
      {"/weft/image", "foxglove.CompressedImage", &image_message},
      {"/weft/mesh", "foxglove.SceneUpdate", &mesh_message},
      {"/weft/camera", "foxglove.CameraCalibration", &camera_message},
      {"/tf", "foxglove.FrameTransforms", &transforms_message},
      {"/weft/report", "weft.FrameReport", &report_message},
  }};
  return kChannels;
}

std::string server_info() {
  return ordered_json{{"op", "serverInfo"},
                      {"name", std::string("Weft ") + kVersion},
                      {"capabilities", ordered_json::array()}}
      .dump();
}

std::string advertisement() {
  ordered_json list = ordered_json::array();
  for (const Channel& channel : channels()) {
    list.push_back({{"id", list.size() + 1},
                    {"topic", std::string(channel.topic)},
                    {"encoding", "json"},
                    {"schemaName", std::string(channel.schema)},
                    {"schema", schema_of(channel.schema)},
                    {"schemaEncoding", "jsonschema"}});
  }
  return ordered_json{{"op", "advertise"}, {"channels", std::move(list)}}.dump();
}

std::string status(int level, const std::string& message) {
  return ordered_json{{"op", "status"}, {"level", level}, {"message", message}}.dump(
      -1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string data_head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string bytes(1, '\x01');
  bytes.append(reinterpret_cast<const char*>(&subscription), sizeof subscription);
  bytes.append(reinterpret_cast<const char*>(&time_ns), sizeof time_ns);
  return bytes;
}

}  // namespace weft::live::foxglove
