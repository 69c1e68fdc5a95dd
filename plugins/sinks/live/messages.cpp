// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>
#include <weft/core/base64.hpp>
#include <weft/core/index.hpp>
#include <weft/core/version.hpp>

#include "json_text.hpp"

namespace weft::live {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little);
constexpr std::uint32_t kMagic = 0x314C4657;  // "WFL1"

/// JPEG of more would be large in hello, and textures of more are unknown to some browsers.
constexpr int kMostTexture_px = 2048;
constexpr int kTextureQuality = 85;

/// Rows of the array, without what stands between them, as numbers of another type.
template <class To, class From>
std::vector<To> packed(const Array<From>& array) {
  std::vector<To> numbers;
  numbers.reserve(to_index(array.size()));
  for (std::int64_t i = 0; i < array.rows(); ++i) {
    const From* row = array.row(i);
    std::transform(row, row + array.row_elements(), std::back_inserter(numbers),
                   [](From number) { return static_cast<To>(number); });
  }
  return numbers;
}

template <class Number>
void add_base64(std::string& text, const std::vector<Number>& numbers) {
  text += '"' +
          base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)}) +
          '"';
}

/// [V,2] of 0 to 1 from the texture's upper left corner, which is half a pixel before its first
/// pixel's centre.
std::vector<float> texture_places(const Template& templ) {
  const double width_px = static_cast<double>(templ.texture.dim(1));
  const double height_px = static_cast<double>(templ.texture.dim(0));
  std::vector<float> places;
  places.reserve(to_index(templ.flat_px.size()));
  for (std::int64_t i = 0; i < templ.flat_px.rows(); ++i) {
    places.push_back(static_cast<float>((templ.flat_px(i, 0) + 0.5) / width_px));
    places.push_back(static_cast<float>((templ.flat_px(i, 1) + 0.5) / height_px));
  }
  return places;
}

std::string texture_of(const Template& templ) {
  const std::int64_t longer_px = std::max(templ.texture.dim(0), templ.texture.dim(1));
  PictureStyle style{kTextureQuality, 0};
  if (longer_px > kMostTexture_px) {
    style.width_px = std::max(
        1, static_cast<int>(templ.texture.dim(1) * std::int64_t{kMostTexture_px} / longer_px));
  }
  return jpeg_of(templ.texture, style);
}

/// A member whose value is a JSON object, or null.
void add_object(std::string& text, const char* name, const std::string& object) {
  text += std::string("\"") + name + "\":" + (object.empty() ? "null" : object);
}

void put(std::string& bytes, std::uint32_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

struct Part {
  const char* name;
  const char* type;
  const void* data;
  std::size_t bytes;
};

template <class Number>
Part part_of(const char* name, const char* type, const std::vector<Number>& numbers) {
  return {name, type, numbers.data(), numbers.size() * sizeof(Number)};
}

/// Those that are not empty.
std::vector<Part> parts_of(const FrameCopy& frame, const std::string& jpeg) {
  std::vector<Part> parts = {{"image", "jpeg", jpeg.data(), jpeg.size()},
                             part_of("vertices_m", "f32", frame.vertices_m),
                             part_of("visible", "u8", frame.visible),
                             part_of("match_px", "f32", frame.matches.px),
                             part_of("match_uv", "f32", frame.matches.uv),
                             part_of("match_kept", "u8", frame.matches.kept),
                             part_of("match_score", "f32", frame.matches.score),
                             part_of("truth_m", "f32", frame.truth_m),
                             part_of("other_m", "f32", frame.other_m)};
  parts.erase(
      std::remove_if(parts.begin(), parts.end(), [](const Part& part) { return part.bytes == 0; }),
      parts.end());
  return parts;
}

void put_part(std::string& bytes, const Part& part) {
  bytes.append(static_cast<const char*>(part.data), part.bytes);
  bytes.append((4 - part.bytes % 4) % 4, '\0');
}

/// True if it could end a line of a log, or hide the rest of a text in C.
bool has_control_character(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

}  // namespace

std::string scene_members(const Template& templ, const Camera& camera) {
  std::string text = std::string("\"weft\":\"") + kVersion + "\",\"camera\":{\"fx\":";
  add_number(text, camera.fx);
  text += ",\"fy\":";
  add_number(text, camera.fy);
  text += ",\"cx\":";
  add_number(text, camera.cx);
  text += ",\"cy\":";
  add_number(text, camera.cy);
  text += ",\"width_px\":";
  add_number(text, camera.width_px);
  text += ",\"height_px\":";
  add_number(text, camera.height_px);
  text += "},\"template\":{\"vertices_m\":";
  add_base64(text, packed<float>(templ.vertices_m));
  text += ",\"faces\":";
  add_base64(text, packed<std::int32_t>(templ.faces));
  text += ",\"uv\":";
  add_base64(text, texture_places(templ));
  text += ",\"texture\":";
  const std::string texture = texture_of(templ);
  text += texture.empty() ? "null}" : "\"data:image/jpeg;base64," + base64(texture) + "\"}";
  return text;
}

std::string hello_message(const std::string& scene, const std::string& settings,
                          const std::string& started_with) {
  std::string text = "{\"type\":\"hello\"," + scene + ",";
  add_object(text, "settings", settings);
  if (started_with != settings) {
    text += ",";
    add_object(text, "started_with", started_with);
  }
  return text + "}";
}

std::string settings_message(const std::string& settings) {
  std::string text = "{\"type\":\"settings\",";
  add_object(text, "settings", settings);
  return text + "}";
}

std::string answer_message(std::uint64_t number, std::uint64_t frame, const std::string& refusal) {
  std::string text = "{\"type\":\"answer\",\"number\":";
  add_number(text, number);
  text += ",\"frame\":";
  add_number(text, frame);
  text += ",\"refusal\":";
  return text + json(refusal).dump(-1, ' ', false, json::error_handler_t::replace) + "}";
}

std::string pause_message(bool is_paused, std::uint64_t frame, bool has_left) {
  std::string text = "{\"type\":\"pause\",\"paused\":";
  text += is_paused ? "true" : "false";
  text += ",\"frame\":";
  add_number(text, frame);
  if (has_left) text += ",\"left\":true";
  return text + "}";
}

std::string still_message(bool is_still) {
  return std::string("{\"type\":\"still\",\"still\":") + (is_still ? "true}" : "false}");
}

std::string calibration_message(const std::string& state) {
  std::string text = "{\"type\":\"calibration\",";
  add_object(text, "calibration", state);
  return text + "}";
}

std::string frame_message(const FrameCopy& frame, const std::string& jpeg) {
  const std::vector<Part> parts = parts_of(frame, jpeg);
  std::string text = "{\"frame\":";
  add_number(text, frame.frame);
  text += ",\"time_s\":";
  add_number(text, frame.time_s);
  text += ",\"taken_s\":";
  add_number(text, static_cast<double>(frame.taken_ns) / 1e9);
  text += ",\"written\":";
  add_number(text, frame.written);
  text += ",\"matches\":";
  add_number(text, frame.matches.count);
  text += ",";
  add_object(text, "report", frame.report);
  text += ",\"parts\":[";
  std::size_t size = 0;
  for (const Part& part : parts) {
    text += std::string(&part == parts.data() ? "" : ",") + "{\"name\":\"" + part.name +
            "\",\"type\":\"" + part.type + "\",\"bytes\":";
    add_number(text, part.bytes);
    text += "}";
    size += part.bytes + 4;
  }
  text += "]}";
  text.append((4 - text.size() % 4) % 4, ' ');  // the next bytes are at multiples of 4

  std::string bytes;
  bytes.reserve(text.size() + size + 8);
  put(bytes, kMagic);
  put(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
  for (const Part& part : parts) put_part(bytes, part);
  return bytes;
}

Result<Said> parse_said(std::string_view message) {
  const auto refuse = [](const char* why) { return Error{Errc::syntax, why}; };
  const json said = json::parse(message, nullptr, false);
  if (!said.is_object()) return refuse("a message that is no JSON object");
  const auto type = said.find("type");
  if (type == said.end() || !type->is_string()) return refuse("a message without a type");
  if (*type == "ready") return Said{};
  if (*type != "change_request")
    return refuse("a message of another type than ready and change_request");
  const auto number = said.find("number"), text = said.find("text");
  if (number == said.end() || !number->is_number_unsigned()) {
    return refuse("a change request without a number from 0 on");
  }
  if (text == said.end() || !text->is_string()) return refuse("a change request without a text");
  Said request{true, number->get<std::uint64_t>(), text->get<std::string>()};
  if (has_control_character(request.text))
    return refuse("a change request with a control character");
  return request;
}

}  // namespace weft::live
