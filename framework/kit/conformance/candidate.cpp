// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/candidate.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <weft/core/text_file.hpp>

namespace weft::conformance {
namespace {

namespace fs = std::filesystem;
using Registry = std::shared_ptr<const host::Registry>;

constexpr std::string_view kManifest = ".plugin.yaml", kLibrary = ".so", kArguments = ".check";
constexpr std::uint64_t kMostArgumentBytes = 1 << 20;

std::string without(const std::string& text, std::string_view ending) {
  return text.ends_with(ending) ? text.substr(0, text.size() - ending.size()) : text;
}

/// One line of the file is one argument.
Result<std::vector<std::string>> arguments_beside(const std::string& library) {
  const std::string file = without(library, kLibrary) + std::string(kArguments);
  std::error_code code;
  if (!fs::exists(file, code)) return std::vector<std::string>{};
  const auto text = read_text_file(file, kMostArgumentBytes);
  if (!text) return text.error();
  std::vector<std::string> lines;
  std::istringstream stream(*text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

/// Arguments behind an id apply to that component, others to the first component of the library.
Result<void> apply_arguments(const std::vector<std::string>& arguments,
                             const std::vector<std::string>& ids,
                             std::vector<Candidate>& candidates) {
  std::string about = ids.front();
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const bool has_more = i + 1 < arguments.size();
    const bool deviates = argument == "deviates" && has_more;
    const bool skipped = argument == "skipped" && has_more;
    const bool geometry = argument == "geometry";
    if (!argument.starts_with("{") && !deviates && !skipped && !geometry) {
      if (std::find(ids.begin(), ids.end(), argument) == ids.end()) {
        return Error{Errc::invalid_value,
                     "'" + argument +
                         "' is no argument of CONTRACT: give \"{name: value}\", "
                         "deviates \"CHECK\", skipped \"WHY\", geometry or the id of a component "
                         "of the library",
                     ids.front()};
      }
      about = argument;
      continue;
    }
    if (deviates || skipped) ++i;
    for (Candidate& candidate : candidates) {
      if (candidate.id != about) continue;
      if (deviates) candidate.deviations.push_back(arguments[i]);
      if (skipped) candidate.skipped = arguments[i];
      if (geometry) candidate.geometry = true;
      if (argument.starts_with("{")) candidate.params = argument;
    }
  }
  return {};
}

Candidate refused(const Registry& registry, const host::Refusal& refusal) {
  Candidate candidate;
  candidate.id = refusal.file;
  candidate.registry = registry;
  candidate.refusal = refusal.cause + "; " + refusal.fix;
  return candidate;
}

/// The requested components of a library, by `is_asked(installed)`.
template <class IsAsked>
Result<void> add_installed(const Registry& registry, const IsAsked& is_asked,
                           std::vector<Candidate>& all) {
  std::vector<std::string> libraries;
  for (const host::Installed& entry : registry->installed()) {
    if (entry.shadowed || !is_asked(entry)) continue;
    const std::string& library = entry.library->library;
    const bool known = std::find(libraries.begin(), libraries.end(), library) != libraries.end();
    if (!known) libraries.push_back(library);
  }
  for (const std::string& library : libraries) {
    std::vector<Candidate> of_library;
    std::vector<std::string> ids;
    for (const host::Installed& entry : registry->installed()) {
      if (entry.library->library != library) continue;
      ids.push_back(entry.component.id);
      if (entry.shadowed || !is_asked(entry)) continue;
      Candidate candidate;
      candidate.id = entry.component.id;
      candidate.registry = registry;
      of_library.push_back(std::move(candidate));
    }
    const auto arguments = arguments_beside(library);
    if (!arguments) return arguments.error();
    if (auto done = apply_arguments(*arguments, ids, of_library); !done) return done;
    std::move(of_library.begin(), of_library.end(), std::back_inserter(all));
  }
  return {};
}

Result<void> add_file(const std::string& file, const Asked& asked, std::vector<Candidate>& all) {
  std::error_code code;
  if (auto found = check_input(file, InputKind::any); !found) {
    return Error{Errc::io, found.error().message, file};
  }
  const fs::path given = fs::absolute(without(file, kManifest) +
                                      (file.ends_with(kManifest) ? std::string(kLibrary) : ""));
  const fs::path folder = fs::weakly_canonical(given.parent_path(), code);
  const std::string library = (folder / given.filename()).string();
  std::vector<std::string> folders = {folder.string()};
  folders.insert(folders.end(), asked.plugin_folders.begin(), asked.plugin_folders.end());
  const auto registry =
      std::make_shared<const host::Registry>(host::Registry::scan(host::search_path(folders)));
  const std::size_t before = all.size();
  const auto is_of_file = [&](const host::Installed& entry) {
    return entry.library->library == library;
  };
  if (auto done = add_installed(registry, is_of_file, all); !done) return done;
  for (const host::Refusal& refusal : registry->refusals()) {
    const bool is_meant = refusal.file == library || refusal.file == fs::absolute(file).string();
    if (is_meant) all.push_back(refused(registry, refusal));
  }
  if (all.size() > before) return {};
  return Error{Errc::io, "is no plugin: give a library (.so) or its manifest (.plugin.yaml)", file};
}

}  // namespace

Result<testing::Subject> Candidate::find(const std::string& output_folder,
                                         const yaml::Node* changed) const {
  auto subject = changed != nullptr ? testing::Subject::find(*registry, id, *changed, output_folder)
                                    : testing::Subject::find(*registry, id, params, output_folder);
  if (subject) subject->seed = seed;
  return subject;
}

Result<std::vector<Candidate>> candidates(const Asked& asked) {
  std::vector<Candidate> all;
  const auto registry = std::make_shared<const host::Registry>(
      host::Registry::scan(host::search_path(asked.plugin_folders)));
  if (asked.all) {
    const auto every = [](const host::Installed&) { return true; };
    if (auto done = add_installed(registry, every, all); !done) return done.error();
    for (const host::Refusal& refusal : registry->refusals()) {
      all.push_back(refused(registry, refusal));
    }
  }
  for (const std::string& subject : asked.subjects) {
    const bool is_file = subject.ends_with(kLibrary) || subject.ends_with(kManifest);
    if (is_file) {
      if (auto done = add_file(subject, asked, all); !done) return done.error();
      continue;
    }
    if (registry->find(subject) == nullptr) {
      return Error{Errc::not_found, registry->explain_missing(subject), {}};
    }
    const auto is_it = [&](const host::Installed& entry) { return entry.component.id == subject; };
    if (auto done = add_installed(registry, is_it, all); !done) return done.error();
  }
  for (Candidate& candidate : all) candidate.seed = asked.seed;
  if (asked.params.empty()) return all;
  if (all.size() != 1) {
    return Error{Errc::invalid_value,
                 "--params is about one component, and " + std::to_string(all.size()) +
                     " are checked; name it by its id",
                 {}};
  }
  all.front().params = asked.params;
  return all;
}

}  // namespace weft::conformance
