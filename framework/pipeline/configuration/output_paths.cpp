// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/output_paths.hpp"

#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <optional>
#include <weft/core/quote.hpp>

#include "pipeline/configuration/declared_paths.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

bool is_pattern(const fs::path& path) {
  return path.native().find_first_of("*?[") != std::string::npos;
}

/// Where a path leads, all links followed; also a link to nothing, which a writer would follow.
fs::path real_path(fs::path path) {
  constexpr int kMostLinks = 40;
  std::error_code code;
  for (int i = 0; i < kMostLinks; ++i) {
    fs::path place = fs::weakly_canonical(path, code);
    if (code) break;
    if (!fs::is_symlink(fs::symlink_status(place, code))) return place;
    path = place.parent_path() / fs::read_symlink(place, code);
    if (code) break;
  }
  return path.lexically_normal();
}

/// True if one path is the other, or contains it. `pattern` may have wildcards.
bool overlap(const fs::path& pattern, const fs::path& path) {
  auto a = pattern.begin();
  auto b = path.begin();
  for (; a != pattern.end() && b != path.end(); ++a, ++b) {
    if (*a != *b && fnmatch(a->c_str(), b->c_str(), 0) != 0) return false;
  }
  return true;
}

/// True if `inner` is `outer` or is inside it.
bool is_within(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

bool is_one_file(const fs::path& a, const struct stat& b) {
  struct stat status {};
  return stat(a.c_str(), &status) == 0 && status.st_dev == b.st_dev && status.st_ino == b.st_ino;
}

/// The inputs of the pipeline.
struct Reading {
  fs::path path;     ///< or a pattern
  std::string what;  ///< such as "what 'camera' of sources/images reads" or "a file of this
                     ///< pipeline"
};

/// Calls `visit` with each entry of a folder until it returns true. A folder that cannot be listed
/// has none.
template <class Iterator, class Visit>
bool any_entry(Iterator entry, const Visit& visit) {
  std::error_code code;
  for (; entry != Iterator(); entry.increment(code)) {
    if (visit(entry->path())) return true;
  }
  return false;
}

/// Calls `visit` with each file that a path or pattern below `base` names, and with the contents of
/// folders, until it returns true.
template <class Visit>
bool any_file(const fs::path& pattern, const fs::path& base, const Visit& visit) {
  std::error_code code;
  if (!is_pattern(pattern) || fs::exists(base / pattern, code)) {
    const fs::path file = base / pattern;
    return visit(file) || any_entry(fs::recursive_directory_iterator(
                                        file, fs::directory_options::skip_permission_denied, code),
                                    visit);
  }
  fs::path folder = base, rest;
  auto part = pattern.begin();
  for (; !is_pattern(*part); ++part) folder /= *part;
  for (auto next = std::next(part); next != pattern.end(); ++next) rest /= *next;
  return any_entry(fs::directory_iterator(folder, code), [&](const fs::path& entry) {
    if (fnmatch(part->c_str(), entry.filename().c_str(), FNM_PERIOD) != 0) return false;
    return rest.empty() ? visit(entry) : any_file(rest, entry, visit);
  });
}

/// True if writing to `real`, a path without links, could change the inputs.
bool destroys(const fs::path& real, const fs::path& reading) {
  if (overlap(reading, real)) return true;
  if (!is_pattern(reading) && overlap(real_path(reading), real)) return true;
  struct stat there {};
  if (stat(real.c_str(), &there) != 0) return false;
  return any_file(reading, {}, [&](const fs::path& file) {
    return is_one_file(file, there) || is_within(real_path(file), real);
  });
}

std::vector<Reading> readings_of(const PipelineConfig& config, const host::Registry& registry) {
  std::vector<Reading> readings;
  for (const ConfigSource& source : config.sources) {
    if (!source.is_setting)
      readings.push_back({fs::absolute(source.name), "a file of this pipeline"});
  }
  for (const DeclaredPath& input : declared_paths(config, WEFT_VALUE_INPUT_PATH, "")) {
    readings.push_back({input.path, "what '" + input.parameter + "' of " + input.component +
                                        " reads, at " + place_in(config.sources, input.at)});
  }
  for (const host::Installed& installed : registry.installed()) {
    for (const std::string& file : {installed.library->library, installed.library->file}) {
      readings.push_back({fs::absolute(file), "the library of " + installed.component.id});
    }
  }
  for (Reading& reading : readings) reading.path = reading.path.lexically_normal();
  return readings;
}

/// The name in a run folder that the host itself writes and in which this path stands, or none.
std::string taken_by_run(const fs::path& inside) {
  static constexpr std::array kTaken{
      "frames",     "frames.jsonl", "manifest.json", "pipeline.yaml", "template.npz",
      "trace.json", "dumps",        "end.json",      "metrics.json",  "registration.npz"};
  const auto found = std::find(kTaken.begin(), kTaken.end(), inside.begin()->string());
  return found != kTaken.end() ? *found : "";
}

/// Output there is gone at once: into a pipe, a terminal, to where the program's own output goes.
bool keeps_nothing(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  return path == "/dev/stdout" || fs::is_fifo(status) || fs::is_character_file(status);
}

/// Existing contents that would be lost, in words; empty for nothing, an empty folder, and devices
/// that keep nothing.
std::string what_is_there(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(path, code);
  if (!fs::exists(status) || keeps_nothing(path)) return {};
  if (fs::is_symlink(status)) return "a link";
  if (!fs::is_directory(status)) return "a file";
  return fs::is_empty(path, code) && !code ? "" : "a folder that is not empty";
}

class Outputs {
 public:
  Outputs(const PipelineConfig& config, const host::Registry& registry,
          const std::string& run_folder)
      : config_(config), registry_(registry), run_folder_(real_path(fs::absolute(run_folder))) {}

  /// The problem of one output on its own; empty if there is none.
  std::string complaint(const DeclaredPath& output) {
    const fs::path real = real_path(output.path);
    if (is_within(real, run_folder_)) {
      const std::string taken = taken_by_run(real.lexically_relative(run_folder_));
      if (taken.empty()) return {};
      return "the run folder has its own " + taken + "; choose another name";
    }
    const std::string path = escaped(output.path.string());
    if (is_within(run_folder_, real)) return path + " holds the run folder; choose another path";
    if (const Reading* reading = reading_at(real)) {
      return path + " would overwrite " + reading->what + "; choose another path";
    }
    const std::string there = what_is_there(output.path);
    if (there.empty() || output.overwrite) return {};
    return path + " is " + there +
           "; choose a path where nothing is, such as a relative one, which is below the run "
           "folder, or write 'overwrite: true' beside 'use'";
  }

  /// Why two outputs cannot be; empty where they can.
  std::string clash(const DeclaredPath& later, const DeclaredPath& earlier) const {
    const fs::path a = real_path(later.path), b = real_path(earlier.path);
    std::error_code code;
    if (fs::is_character_file(a, code)) return {};  // /dev/null
    struct stat there {};
    const bool same = a == b || (stat(b.c_str(), &there) == 0 && is_one_file(a, there));
    const bool in_file = (is_within(a, b) && b.has_extension() && b != run_folder_) ||
                         (is_within(b, a) && a.has_extension() && a != run_folder_);
    if (!same && !in_file) return {};
    return escaped(later.path.string()) + (same ? " is" : " collides with") + " the '" +
           earlier.parameter + "' of " + earlier.component + " at " +
           place_in(config_.sources, earlier.at) + "; choose another path";
  }

 private:
  const Reading* reading_at(const fs::path& real) {
    if (!readings_) readings_ = readings_of(config_, registry_);
    const auto found = std::find_if(readings_->begin(), readings_->end(),
                                    [&](const Reading& each) { return destroys(real, each.path); });
    return found != readings_->end() ? &*found : nullptr;
  }

  const PipelineConfig& config_;
  const host::Registry& registry_;
  fs::path run_folder_;
  std::optional<std::vector<Reading>> readings_;
};

}  // namespace

void refuse_unsafe_outputs(const PipelineConfig& config, const host::Registry& registry,
                           const std::string& run_folder, std::vector<yaml::Problem>& problems) {
  const std::vector<DeclaredPath> declared =
      declared_paths(config, WEFT_VALUE_OUTPUT_PATH, run_folder);
  if (declared.empty()) return;
  const auto refuse = [&](const DeclaredPath& output, const std::string& complaint) {
    if (complaint.empty()) return;
    problems.push_back({output.at, "'" + output.parameter + "': " + complaint});
  };
  if (run_folder.empty()) {
    for (const DeclaredPath& output : declared) {
      refuse(output, "there is no run folder for what it writes; leave it out");
    }
    return;
  }
  Outputs outputs(config, registry, run_folder);
  for (std::size_t i = 0; i < declared.size(); ++i) {
    std::string complaint = outputs.complaint(declared[i]);
    for (std::size_t k = 0; k < i && complaint.empty(); ++k) {
      complaint = outputs.clash(declared[i], declared[k]);
    }
    refuse(declared[i], complaint);
  }
}

Result<void> refuse_existing_outputs(const host::ComponentSpec& component,
                                     const std::string& output_folder) {
  for (const auto& output : declared_paths(component, WEFT_VALUE_OUTPUT_PATH, output_folder)) {
    const std::string there = what_is_there(output.path);
    if (there.empty()) continue;
    return Error{Errc::invalid_value,
                 "'" + output.parameter + "': " + escaped(output.path.string()) + " is " + there +
                     "; choose a path where nothing is",
                 output.component};
  }
  return {};
}

}  // namespace weft
