// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/plugins_why.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/text_file.hpp>

#include "cli/output/json_text.hpp"
#include "host/probing/probe.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// A place where a component stands, and what became of it.
struct Finding {
  std::string id;     ///< empty if the file does not state it
  std::string state;  ///< "used", "shadowed", "refused", "not searched"
  std::string library, version, origin;
  std::string cause, fix;  ///< for states other than used
  std::vector<std::string> notes;
};

struct Explanation {
  std::string subject;
  bool usable = false;
  std::string reason;  ///< where nothing was found
  std::vector<Finding> found;
};

constexpr const char* kNotSearched = "not searched";

/// Nested components that a pipeline gets unless it names others, and that it cannot get.
void note_missing_defaults(const host::Registry& registry, const host::ComponentManifest& component,
                           std::set<std::string>& seen, std::vector<std::string>& notes) {
  for (const host::ParameterSpec& parameter : component.parameters) {
    const std::string& id = parameter.default_value.scalar;
    if (parameter.type != WEFT_VALUE_COMPONENT || parameter.required || !seen.insert(id).second) {
      continue;
    }
    if (const host::Installed* nested = registry.find(id)) {
      note_missing_defaults(registry, nested->component, seen, notes);
    } else {
      notes.push_back(fmt::format("its parameter '{}' is {} by default: {}; give it another one",
                                  parameter.name, id, registry.explain_missing(id)));
    }
  }
}

Finding finding_of(const host::Registry& registry, const host::Installed& entry) {
  const host::ComponentManifest& component = entry.component;
  Finding finding{component.id, "used", entry.library->library, component.version, entry.origin, {},
                  {},           {}};
  if (entry.shadowed) {
    const host::Installed* winner = registry.find(component.id);
    finding.state = "shadowed";
    finding.cause =
        fmt::format("{} {} is found first, in {} ({})", component.id, winner->component.version,
                    winner->library->library, winner->origin);
    finding.fix = "search its folder first with --plugin-path, or remove the other one";
  } else if (const auto loaded = host::probe_component(entry.library->library, entry.component.id);
             !loaded) {
    finding.state = "refused";
    finding.cause = loaded.error().message;
    finding.fix = "correct that, then try again";
  } else {
    std::set<std::string> seen;
    note_missing_defaults(registry, component, seen, finding.notes);
  }
  if (entry.origin == kNotSearched && finding.state == "used") {
    finding.state = kNotSearched;
    finding.cause = "its folder is not searched";
    finding.fix = "add: --plugin-path " + fs::path(finding.library).parent_path().string();
  }
  return finding;
}

/// True if a refused file is this component or would have provided it. A library is named after its
/// first id, which identifies a library without a readable manifest.
bool concerns(const host::Refusal& refusal, const std::string& id) {
  if (!refusal.ids.empty()) {
    return std::find(refusal.ids.begin(), refusal.ids.end(), id) != refusal.ids.end();
  }
  std::string stem = id;
  std::replace(stem.begin(), stem.end(), '/', '_');
  return fs::path(refusal.file).filename() == stem + ".so";
}

Finding finding_of(const host::Refusal& refusal, const std::string& id) {
  return {id, "refused", refusal.file, {}, {}, refusal.cause, refusal.fix, {}};
}

Explanation explain_id(const std::string& id, const host::Registry& registry) {
  Explanation explanation{id, false, {}, {}};
  for (const host::Installed& entry : registry.installed()) {
    if (entry.component.id == id) explanation.found.push_back(finding_of(registry, entry));
  }
  for (const host::Refusal& refusal : registry.refusals()) {
    if (concerns(refusal, id)) explanation.found.push_back(finding_of(refusal, id));
  }
  if (explanation.found.empty()) explanation.reason = registry.explain_missing(id);
  return explanation;
}

/// The library that is meant by a library or by its manifest.
fs::path library_of(const std::string& file) {
  constexpr std::string_view kManifest = ".plugin.yaml";
  const std::string path = fs::absolute(file).lexically_normal().string();
  return path.ends_with(kManifest) ? path.substr(0, path.size() - kManifest.size()) + ".so" : path;
}

Explanation explain_file(const std::string& file, const std::vector<std::string>& plugin_path) {
  std::error_code code;
  const fs::path given = library_of(file);
  const fs::path folder = fs::weakly_canonical(given.parent_path(), code);
  const std::string library = (folder / given.filename()).string();
  // Searched last, under a separate name: components that the search finds before it take
  // precedence.
  std::vector<host::SearchFolder> folders = host::search_path(plugin_path);
  folders.push_back({folder.string(), kNotSearched});
  const host::Registry registry = host::Registry::scan(folders);
  Explanation explanation{library, false, {}, {}};
  for (const host::Installed& entry : registry.installed()) {
    if (entry.library->library == library) explanation.found.push_back(finding_of(registry, entry));
  }
  for (const host::Refusal& refusal : registry.refusals()) {
    if (refusal.file != library) continue;
    std::vector<std::string> ids = refusal.ids;
    if (ids.empty()) ids.emplace_back();
    for (const std::string& id : ids) explanation.found.push_back(finding_of(refusal, id));
  }
  if (explanation.found.empty()) {
    explanation.reason =
        library + " is no plugin: give a library (.so) or its manifest (.plugin.yaml)";
  }
  return explanation;
}

ordered_json explanation_json(const Explanation& explanation) {
  ordered_json found = ordered_json::array();
  for (const Finding& finding : explanation.found) {
    found.push_back({{"id", finding.id},
                     {"state", finding.state},
                     {"library", finding.library},
                     {"version", finding.version},
                     {"origin", finding.origin},
                     {"cause", finding.cause},
                     {"fix", finding.fix},
                     {"notes", finding.notes}});
  }
  return {{"subject", explanation.subject},
          {"usable", explanation.usable},
          {"reason", explanation.reason},
          {"found", std::move(found)}};
}

void print_text(const Explanation& explanation) {
  fmt::print("{} {}\n", explanation.subject, explanation.usable ? "can be used" : "cannot be used");
  if (!explanation.reason.empty()) fmt::print("  {}\n", explanation.reason);
  for (const Finding& finding : explanation.found) {
    fmt::print("  {}: {}{}", finding.state, finding.id, finding.id.empty() ? "" : " ");
    fmt::print("{}{}{}", finding.version, finding.version.empty() ? "" : " in ", finding.library);
    fmt::print("{}\n", finding.origin.empty() || finding.origin == kNotSearched
                           ? ""
                           : " (" + finding.origin + ")");
    if (!finding.cause.empty()) {
      fmt::print("      {}\n      {}\n", finding.cause, finding.fix);
    }
    for (const std::string& note : finding.notes) fmt::print("      but {}\n", note);
  }
}

}  // namespace

void explain_plugin(const std::string& id_or_file, bool json, Context& context) {
  std::error_code code;
  const bool is_file = id_or_file.ends_with(".so") || id_or_file.ends_with(".plugin.yaml") ||
                       fs::is_regular_file(id_or_file, code);
  if (is_file) {
    if (auto found = check_input(id_or_file, InputKind::any); !found) {
      print_error(found.error());
      context.exit_code = kInputOutput;
      return;
    }
  }
  Explanation explanation = is_file ? explain_file(id_or_file, context.plugin_path)
                                    : explain_id(id_or_file, context.registry());
  // All components of a file must be used, but only one place of a component.
  const auto is_used = [](const Finding& finding) { return finding.state == "used"; };
  const auto& found = explanation.found;
  explanation.usable =
      !found.empty() && (is_file ? std::all_of(found.begin(), found.end(), is_used)
                                 : std::any_of(found.begin(), found.end(), is_used));
  if (json) {
    print_json(explanation_json(explanation));
  } else {
    print_text(explanation);
  }
  context.exit_code = explanation.usable ? kDone : kBadConfiguration;
}

}  // namespace weft::cli
