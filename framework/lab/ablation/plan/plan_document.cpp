// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/plan_document.hpp"

#include <algorithm>
#include <filesystem>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/text_file.hpp>

#include "pipeline/configuration/extended_file.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

void erase(yaml::Node& map, std::string_view key) {
  std::erase_if(map.entries, [&](const yaml::Entry& entry) { return entry.key == key; });
}

class DocumentReader {
 public:
  PlanDocument read(const std::string& file, const PlanChanges& changes) {
    document_.root = read_file(file, {});
    for (const std::string& name : changes.without) leave_out(name);
    for (const std::string& setting : changes.settings) lay(setting);
    return std::move(document_);
  }

 private:
  int add_source(ConfigSource source) {
    document_.sources.push_back(std::move(source));
    return static_cast<int>(document_.sources.size()) - 1;
  }

  int add_setting(const std::string& text, const std::string& option) {
    std::error_code code;
    return add_source({text, fs::current_path(code).string(), true, option});
  }

  void problem(yaml::Position at, std::string message) {
    document_.problems.push_back({at, std::move(message)});
  }

  yaml::Node give_up(yaml::Position at, std::string message) {
    problem(at, std::move(message));
    document_.complete = false;
    return {};
  }

  yaml::Node read_file(const std::string& file, std::vector<std::string> chain) {
    std::error_code code;
    const int source = add_source({file, fs::absolute(file, code).parent_path().string()});
    const auto text = yaml::read_text(file);
    if (!text) {
      return give_up(yaml::Position::whole_file(source), unreadable_text(text.error()));
    }
    auto parsed = yaml::parse(*text, file);
    if (!parsed) {
      yaml::Position at = yaml::position_in(parsed.error().where, file);
      at.source = source;
      return give_up(at, parsed.error().message);
    }
    for (yaml::Problem& each : parsed->problems) {
      each.at.source = source;
      problem(each.at, std::move(each.message));
    }
    yaml::Node root = std::move(parsed->root);
    if (root.kind == yaml::Kind::null && !parsed->problems.empty()) document_.complete = false;
    yaml::set_source(root, source);
    use_current_plan_names(root, document_.former_names);
    chain.push_back(canonical_path(file));
    return extended(std::move(root), source, chain);
  }

  /// The root merged into the plan that it extends, if it does.
  yaml::Node extended(yaml::Node root, int source, const std::vector<std::string>& chain) {
    const yaml::Node* extends = root.find("extends");
    const yaml::Node* without = root.find("without");
    yaml::Node base;
    if (extends != nullptr) {
      base = read_base(*extends, source, chain);
      if (without != nullptr && document_.complete) {
        leave_out_of_plan(base, *without, document_.problems);
      }
    } else if (without != nullptr) {
      problem(without->at, "'without' needs 'extends', the plan whose axes and data it omits");
    }
    erase(root, "extends");
    erase(root, "without");
    erase(base, "name");
    return base.kind == yaml::Kind::map ? merged_plans(std::move(base), std::move(root)) : root;
  }

  yaml::Node read_base(const yaml::Node& extends, int source,
                       const std::vector<std::string>& chain) {
    const std::string folder = document_.sources[to_index(source)].folder;
    const auto paths = host::PathRules::of_process({}, {});
    const auto file = extended_file(extends, folder, chain, paths, "a plan");
    if (!file) return give_up(extends.at, file.error().message);
    yaml::Node base = read_file(*file, chain);
    if (!document_.complete || is_plan(base)) return base;
    return give_up(extends.at, "'extends': " + escaped(*file) + " is no plan");
  }

  void leave_out(const std::string& name) {
    const int source = add_setting(name, "--without");
    if (!document_.complete) return;
    yaml::Node names;
    names.kind = yaml::Kind::sequence;
    names.items.push_back(yaml::text_node(name));
    yaml::set_source(names, source);
    leave_out_of_plan(document_.root, names, document_.problems);
  }

  void lay(const std::string& setting) {
    const int source = add_setting(setting, "--set");
    if (!document_.complete) return;
    std::vector<yaml::Problem> problems;
    yaml::Node overlay = plan_overlay_of(setting, document_.root, problems);
    yaml::set_source(overlay, source);
    for (yaml::Problem& each : problems) {
      each.at.source = source;
      problem(each.at, std::move(each.message));
    }
    if (problems.empty()) document_.root = merged_plans(std::move(document_.root), overlay);
  }

  PlanDocument document_;
};

/// Where a key goes that is listed before all that the base has: before the first of these, or to
/// the end where there is none.
std::size_t first_place(const yaml::Node& base, const yaml::Node& over) {
  for (const yaml::Entry& entry : over.entries) {
    const yaml::Entry* own = base.find_entry(entry.key);
    if (own != nullptr) return to_index(own - base.entries.data());
  }
  return base.entries.size();
}

/// An axis that varies something else has other values.
bool replaces_axis(const yaml::Node& base, const yaml::Node& over) {
  const auto differs = [&](const char* key) {
    const yaml::Node* mine = over.find(key);
    const yaml::Node* other = base.find(key);
    return mine != nullptr && mine->kind == yaml::Kind::scalar &&
           (other == nullptr || !(*other == *mine));
  };
  return differs("set") || differs("stage");
}

/// Kinds of maps that are merged.
enum class Level : std::uint8_t { plan, axes, other };

yaml::Node merged(yaml::Node base, yaml::Node over, Level level) {
  if (yaml::is_null(over)) return base;
  if (base.kind != yaml::Kind::map || over.kind != yaml::Kind::map) return over;
  base.at = over.at;
  base.unclear = base.unclear || over.unclear;
  std::size_t behind = first_place(base, over);
  for (yaml::Entry& entry : over.entries) {
    const yaml::Entry* found = base.find_entry(entry.key);
    if (found == nullptr) {
      const auto before = base.entries.begin() + static_cast<std::ptrdiff_t>(behind++);
      base.entries.insert(before, std::move(entry));
      continue;
    }
    const auto place = to_index(found - base.entries.data());
    yaml::Entry& own = base.entries[place];
    own.at = entry.at;
    const bool axes = level == Level::plan && entry.key == "axes";
    const bool whole = level == Level::axes && replaces_axis(own.value, entry.value);
    own.value = whole ? std::move(entry.value)
                      : merged(std::move(own.value), std::move(entry.value),
                               axes ? Level::axes : Level::other);
    behind = place + 1;
  }
  return base;
}

}  // namespace

yaml::Node merged_plans(yaml::Node base, yaml::Node over) {
  return merged(std::move(base), std::move(over), Level::plan);
}

bool is_plan(const yaml::Node& root) {
  const auto has = [&](const char* key) { return root.find(key) != nullptr; };
  return has("pipeline") || has("axes") || has("data") || has("name");
}

bool is_plan(const std::string& file) {
  const auto text = yaml::read_text(file);
  const auto document = text ? yaml::parse(*text, file) : Result<yaml::Document>(text.error());
  return document && is_plan(document->root);
}

PlanDocument read_plan_document(const std::string& file, const PlanChanges& changes) {
  return DocumentReader().read(file, changes);
}

}  // namespace weft::lab
