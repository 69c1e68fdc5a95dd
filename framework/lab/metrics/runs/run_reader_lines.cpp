// SPDX-License-Identifier: Apache-2.0
// Reads the contents of a run folder other than the records of its frames.
#include <algorithm>
#include <filesystem>
#include <sstream>

#include "host/roles/role_rules.hpp"
#include "lab/metrics/runs/json_file.hpp"
#include "lab/metrics/runs/run_damage.hpp"
#include "lab/metrics/runs/run_reader.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;

std::optional<ShapeState> shape_state_of(const std::string& name) {
  for (const ShapeState state : {ShapeState::none, ShapeState::estimated, ShapeState::weak,
                                 ShapeState::predicted, ShapeState::lost}) {
    if (name == to_string(state)) return state;
  }
  return std::nullopt;
}

/// The line as a frame, or the name of the key that is missing or wrong.
std::variant<FrameLine, std::string> parse_line(const json& object) {
  const auto member = [&](const char* key) {
    return object.value(json::json_pointer(key), json());
  };
  if (!object.is_object()) return std::string("{...}");
  FrameLine line;
  const json frame = member("/frame"), state = member("/state"), failed = member("/failed");
  if (!frame.is_number_unsigned()) return std::string("frame");
  line.frame = frame.get<std::uint64_t>();
  const auto known = state.is_string() ? shape_state_of(state.get<std::string>()) : std::nullopt;
  if (!known) return std::string("state");
  line.state = *known;
  if (!failed.is_boolean()) return std::string("failed");
  line.failed = failed.get<bool>();
  const json records = member("/records");
  if (records.is_number_unsigned()) line.records = records.get<std::int64_t>();
  const json stem = member("/stem");
  if (stem.is_string()) line.stem = stem.get<std::string>();
  return line;
}

}  // namespace

void add_implements(const std::string& id, const std::string& word,
                    std::vector<std::string>& implements) {
  const std::string role = role_of(id);
  if (word.empty() || (role != "solvers" && role != "warps" && role != "filters")) return;
  const std::string text = id + ": " + word;
  if (std::find(implements.begin(), implements.end(), text) == implements.end()) {
    implements.push_back(text);
  }
}

Result<void> RunReader::read_lines() {
  const std::string file = folder_ + "/frames.jsonl";
  const auto content = read_text_file(file, kMostJsonBytes);
  if (!content) return Error{Errc::io, "cannot be read: " + content.error().message, file};
  std::istringstream stream(*content);
  std::string text;
  for (std::size_t number = 1; std::getline(stream, text); ++number) {
    const bool cut = stream.eof();  // a whole line ends with a line break
    const json object = json::parse(text, nullptr, false);
    cut_ = cut;
    if (cut && object.is_discarded()) {
      interrupted_ = true;
      break;
    }
    const std::string place = file + ":" + std::to_string(number);
    if (object.is_discarded()) return Error{Errc::syntax, "is no JSON object", place};
    auto line = parse_line(object);
    if (const auto* key = std::get_if<std::string>(&line)) {
      return Error{Errc::syntax, "'" + *key + "' is missing or has no legal value", place};
    }
    lines_.push_back(std::get<FrameLine>(std::move(line)));
  }
  std::sort(lines_.begin(), lines_.end(),
            [](const FrameLine& a, const FrameLine& b) { return a.frame < b.frame; });
  const auto twice =
      std::adjacent_find(lines_.begin(), lines_.end(),
                         [](const FrameLine& a, const FrameLine& b) { return a.frame == b.frame; });
  if (twice != lines_.end()) {
    return damaged_run(file, "has two lines of frame " + std::to_string(twice->frame));
  }
  return {};
}

/// No frame is missing, unless the run was one that drops some.
Result<void> RunReader::check_numbers() {
  std::uint64_t next = 0;
  for (const FrameLine& line : lines_) {
    if (line.frame != next && !may_drop_) {
      return damaged_run(folder_ + "/frames.jsonl", "has no line of frame " + std::to_string(next));
    }
    dropped_ += static_cast<std::int64_t>(line.frame - next);
    next = line.frame + 1;
  }
  return {};
}

Result<void> RunReader::read_manifest() {
  const std::string file = folder_ + "/manifest.json";
  const auto manifest = read_json_object(file);
  if (!manifest) return do_without_manifest(manifest.error());
  may_drop_ = manifest->value("realtime", json()) == "latest";
  is_sequence_ = manifest->value("sequence", json()) != false;
  const json source_frames = manifest->value("source_frames", json());
  if (source_frames.is_number_unsigned()) source_frames_ = source_frames.get<std::int64_t>();
  const json end = manifest->value("end", json());  // runs of older programs lack this key
  if (end == "end.json") {
    if (auto read = read_end(folder_ + "/end.json"); !read) return read;
  }
  const json components = manifest->value("components", json());
  if (!components.is_array()) return damaged_run(file, "has no list 'components'");
  has_solver_ = std::any_of(components.begin(), components.end(), [](const json& component) {
    const json id = component.is_object() ? component.value("id", json()) : json();
    return id.is_string() && rules_of(role_of(id.get<std::string>())).solves;
  });
  for (const json& component : components) {
    if (!component.is_object()) continue;
    const json id = component.value("id", json()), word = component.value("implements", json());
    if (id.is_string() && word.is_string()) {
      add_implements(id.get<std::string>(), word.get<std::string>(), implements_);
    }
  }
  for (const json& component : components) {
    if (!component.is_object() || component.value("uses_truth", json()) != json(true)) continue;
    const json id = component.value("id", json());
    truth_users_.push_back(id.is_string() ? id.get<std::string>() : "a component without id");
  }
  return {};
}

/// An empty or truncated manifest loses its own contents, not the frames.
Result<void> RunReader::do_without_manifest(const Error& fault) {
  const std::string file = folder_ + "/manifest.json";
  const bool is_missing = fault.code == Errc::not_found;
  if (!is_missing && fault.code != Errc::invalid_data) return damaged_run(file, fault.message);
  std::error_code code;
  // A folder made by another program need not have one.
  if (is_missing && !std::filesystem::exists(folder_ + "/pipeline.yaml", code)) return {};
  may_drop_ = true;
  warnings_.push_back(file + ": " + (is_missing ? "is missing" : fault.message) +
                      "; it is not known which components ran, and whether one read the truth");
  return read_end(folder_ + "/end.json");
}

/// Nothing may be missing of a run that came to its end.
Result<void> RunReader::read_end(const std::string& file) {
  const auto end = read_json_object(file);
  if (!end && (end.error().code == Errc::not_found || end.error().code == Errc::invalid_data)) {
    interrupted_ = killed_ = true;
    if (end.error().code == Errc::invalid_data) {
      warnings_.push_back(file + ": " + end.error().message +
                          "; it is not known whether the run came to its end");
    }
    return {};
  }
  if (!end) return damaged_run(file, end.error().message);
  const json frames = end->value("frames", json());
  if (!frames.is_number_unsigned()) return damaged_run(file, "does not state the number of frames");
  const std::string lines = folder_ + "/frames.jsonl";
  if (frames != lines_.size()) {
    return damaged_run(lines, "has " + std::to_string(lines_.size()) + " lines of " +
                                  std::to_string(frames.get<std::uint64_t>()) + " frames");
  }
  if (cut_) return damaged_run(lines, "has a last line that is cut off");
  interrupted_ = end->value("stopped", json()) == json(true);
  return {};
}

}  // namespace weft::lab
