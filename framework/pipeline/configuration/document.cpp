// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/document.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>
#include <weft/core/text_file.hpp>

#include "host/loading/secrets.hpp"
#include "pipeline/configuration/document_merge.hpp"
#include "pipeline/configuration/extended_file.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

/// Positions in one of a patch's texts become those in the document's, which begin at `first`.
void shift_sources(yaml::Node& node, int first) {
  node.at.source += first;
  for (yaml::Node& item : node.items) shift_sources(item, first);
  for (yaml::Entry& entry : node.entries) {
    entry.at.source += first;
    shift_sources(entry.value, first);
  }
}

void erase(yaml::Node& map, std::string_view key) {
  std::erase_if(map.entries, [&](const yaml::Entry& entry) { return entry.key == key; });
}

constexpr std::string_view kWithout = "without=";
constexpr std::size_t kMostShown = 200;  // [characters] of a setting

/// The places of all values that hold no others.
void add_leaves(const yaml::Node& node, std::vector<yaml::Position>& leaves) {
  if (node.items.empty() && node.entries.empty()) leaves.push_back(node.at);
  for (const yaml::Node& item : node.items) add_leaves(item, leaves);
  for (const yaml::Entry& entry : node.entries) add_leaves(entry.value, leaves);
}

std::vector<yaml::Position> leaves_of(const yaml::Node& node) {
  std::vector<yaml::Position> leaves;
  if (node.kind != yaml::Kind::map || !node.entries.empty()) add_leaves(node, leaves);
  return leaves;
}

class Reader {
 public:
  Reader(const host::Registry& registry, const host::PathRules& paths)
      : registry_(registry), paths_(paths) {}

  PipelineDocument read(const std::string& file) {
    document_.root = read_file(file, {});
    return std::move(document_);
  }

  PipelineDocument lay(PipelineDocument base, const std::vector<Patch>& patches,
                       const std::vector<std::string>& settings) {
    document_ = std::move(base);
    for (const Patch& patch : patches) lay(patch);
    std::vector<Laid> laid;
    for (const std::string& setting : settings) {
      std::error_code code;
      const int source = add_source({setting, fs::current_path(code).string(), true});
      if (!takes_more()) continue;
      if (setting.starts_with(kWithout)) {
        leave_out_by(setting, source);
        laid.push_back({{1, 1, source}, {}});
        continue;
      }
      auto [overlay, problems] = overlay_of(setting, document_.root, registry_);
      yaml::set_source(overlay, source);
      const bool sound = problems.empty();
      report(std::move(problems), source);
      if (sound) laid.push_back({{1, 1, source}, leaves_of(overlay)});
      merge(std::move(overlay));
    }
    refuse_lost(laid);
    return std::move(document_);
  }

 private:
  /// A setting and the places of its values.
  struct Laid {
    yaml::Position at;
    std::vector<yaml::Position> leaves;
  };

  int add_source(ConfigSource source) {
    document_.sources.push_back(std::move(source));
    return static_cast<int>(document_.sources.size()) - 1;
  }

  /// False for a file that is no map: no further error is reported.
  bool takes_more() const {
    return !document_.unreadable && !document_.unclear && document_.root.kind == yaml::Kind::map;
  }

  void lay(const Patch& patch) {
    const int first = static_cast<int>(document_.sources.size());
    for (const ConfigSource& source : patch.sources) add_source(source);
    if (!takes_more()) return;
    yaml::Node node = patch.node;
    shift_sources(node, first);
    refuse_twice(node);
    if (const yaml::Node* without = node.find("without")) leave_out(document_.root, *without);
    const yaml::Node* given = node.find("set");
    const yaml::Node settings = given != nullptr ? *given : yaml::Node{};
    erase(node, "without");
    erase(node, "set");
    merge(std::move(node));
    std::vector<Laid> laid;
    for (const yaml::Entry& setting : settings.entries) {
      auto [overlay, problems] = overlay_of(setting, document_.root, registry_);
      const bool sound = problems.empty();
      for (yaml::Problem& each : problems) problem(each.at, std::move(each.message));
      if (sound) laid.push_back({setting.at, leaves_of(setting.value)});
      merge(std::move(overlay));
    }
    refuse_lost(laid);
  }

  void merge(yaml::Node over) {
    rename(over, document_.root);
    document_.root = merged(std::move(document_.root), std::move(over));
  }

  void rename(yaml::Node& over, const yaml::Node& base) {
    use_current_names(over, base, registry_, document_.former_names, document_.problems);
  }

  /// Refuses settings that a later one overrides completely.
  void refuse_lost(const std::vector<Laid>& laid) {
    if (laid.size() < 2) return;
    const std::vector<yaml::Position> left = leaves_of(document_.root);
    for (const Laid& setting : laid) {
      const auto is_leaf_at = [&](yaml::Position at) {
        return std::find(left.begin(), left.end(), at) != left.end();
      };
      if (setting.leaves.empty() ||
          std::any_of(setting.leaves.begin(), setting.leaves.end(), is_leaf_at))
        continue;
      problem(setting.at,
              "this setting has no effect: a later one sets the same, or takes another plugin, "
              "which drops it; leave it out, or put it behind");
    }
  }

  /// Refuses two entries with one name: the later would be merged into the earlier.
  void refuse_twice(const yaml::Node& root) {
    for (const char* key : {"stages", "sinks"}) {
      const yaml::Node* list = root.find(key);
      if (list == nullptr || list->kind != yaml::Kind::sequence) continue;
      std::set<std::string> known;
      const std::vector<std::string> names = names_of_stages(*list);
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i].empty() || known.insert(names[i]).second) continue;
        const yaml::Node* as = list->items[i].find("as");
        // A name that is not given is a role's, and no stage may be given one of those.
        if (as != nullptr) problem(as->at, "the name " + quote(names[i]) + " is used twice");
      }
    }
  }

  void report(std::vector<yaml::Problem> problems, int source) {
    for (yaml::Problem& problem : problems) {
      problem.at.source = source;
      document_.problems.push_back(std::move(problem));
    }
  }

  /// The only error of a text that is no YAML. Parts that other files merge into it are still
  /// checked, as far as they do not depend on it.
  yaml::Node give_up(yaml::Position at, std::string message) {
    problem(at, std::move(message));
    document_.unclear = true;
    return {};
  }

  yaml::Node read_file(const std::string& file, std::vector<std::string> chain) {
    std::error_code code;
    const int source = add_source({file, fs::absolute(file, code).parent_path().string(), false});
    const auto text = yaml::read_text(file);
    if (!text) {
      document_.unreadable = chain.empty();
      return give_up(yaml::Position::whole_file(source), unreadable_text(text.error()));
    }
    auto parsed = yaml::parse(*text, file);
    if (!parsed) {
      document_.unreadable = chain.empty();
      yaml::Position at = yaml::position_in(parsed.error().where, file);
      at.source = source;
      return give_up(at, parsed.error().message);
    }
    yaml::Node root = std::move(parsed->root);
    yaml::set_source(root, source);
    report(std::move(parsed->problems), source);
    refuse_twice(root);
    if (root.unclear) document_.unclear = true;
    chain.push_back(canonical_path(file));
    root = extended(std::move(root), source, chain);
    for (const char* key : {"source", "template"}) {
      const yaml::Node* part = root.find(key);
      if (part != nullptr) document_.parts.push_back({source, key, *part});
    }
    return root;
  }

  /// The root merged into the file that it extends, if it does.
  yaml::Node extended(yaml::Node root, int source, const std::vector<std::string>& chain) {
    const yaml::Node* extends = root.find("extends");
    const yaml::Node* without = root.find("without");
    if (extends == nullptr) {
      if (without != nullptr) {
        problem(without->at, "'without' needs 'extends', the file whose stages it omits");
        erase(root, "without");
      }
      rename(root, {});
      return root;
    }
    if (root.find_entry("extends")->unclear) document_.unclear = true;
    yaml::Node base = read_base(*extends, source, chain);
    if (without != nullptr && !document_.unclear) leave_out(base, *without);
    if (without != nullptr && root.find_entry("without")->unclear) document_.unclear_names = true;
    erase(root, "extends");
    erase(root, "without");
    rename(root, base);
    if (base.kind == yaml::Kind::null) return root;
    base.at = root.at;  // a missing key is missing in this file
    return merged(std::move(base), std::move(root));
  }

  yaml::Node read_base(const yaml::Node& extends, int source,
                       const std::vector<std::string>& chain) {
    const auto named = extended_file(extends, document_.sources[to_index(source)].folder, chain,
                                     paths_, "a pipeline file");
    if (!named) return give_up(extends.at, named.error().message);
    const std::string& file = *named;
    yaml::Node base = read_file(file, chain);
    if (base.kind == yaml::Kind::map || document_.unclear) return base;
    return give_up(extends.at, "'extends': " + escaped(file) + " is no pipeline, which is a map");
  }

  void leave_out(yaml::Node& base, const yaml::Node& without,
                 const char* unknown = "the extended file has no stage or sink ") {
    if (without.kind != yaml::Kind::sequence) {
      return problem(without.at, "'without' must be a list of names of stages and sinks");
    }
    std::set<std::string> unwanted;
    for (const yaml::Node& name : without.items) {
      if (unwanted.insert(name.scalar).second || name.kind != yaml::Kind::scalar) continue;
      problem(name.at, "'without' names " + quote(name.scalar) + " twice");
    }
    std::vector<std::string> known;
    std::map<std::string, std::string> plugins;
    for (NamedStage& stage : remove_stages(base, unwanted)) {
      plugins[stage.name] = std::move(stage.use);
      known.push_back(std::move(stage.name));
    }
    for (const yaml::Node& name : without.items) {
      if (const auto found = plugins.find(name.scalar); found != plugins.end()) {
        document_.left_out.push_back({name.scalar, found->second, name.at});
        continue;
      }
      document_.unclear_names = true;
      if (name.kind != yaml::Kind::scalar) {
        problem(name.at, "'without' must be a list of names of stages and sinks");
        continue;
      }
      problem(name.at, unknown + quote(name.scalar) + did_you_mean(name.scalar, known));
    }
  }

  /// "without=passes,seen", or a list.
  void leave_out_by(const std::string& setting, int source) {
    std::vector<yaml::Problem> problems;
    auto names = value_of_setting(setting, kWithout.size() - 1, problems);
    report(std::move(problems), source);
    if (!names) return;
    yaml::set_source(*names, source);
    if (names->kind == yaml::Kind::scalar) names = each_of(*names);
    leave_out(document_.root, *names, "no stage or sink is named ");
  }

  /// The parts of a text with commas between, as a list.
  static yaml::Node each_of(const yaml::Node& text) {
    yaml::Node list;
    list.kind = yaml::Kind::sequence;
    list.at = text.at;
    yaml::Position at = text.at;
    std::istringstream parts(text.scalar);
    for (std::string part; std::getline(parts, part, ',');) {
      list.items.push_back(yaml::plain_node(part, at));
      at.column += columns(part) + 1;
    }
    return list;
  }

  void problem(yaml::Position at, std::string message) {
    document_.problems.push_back({at, std::move(message)});
  }

  const host::Registry& registry_;
  const host::PathRules& paths_;
  PipelineDocument document_;
};

}  // namespace

std::string place_in(const std::vector<ConfigSource>& sources, yaml::Position at) {
  const ConfigSource& source = sources.at(to_index(at.source));
  if (!source.is_setting) return yaml::place(source.name, at);
  const std::string shown = escaped(host::shown_setting(source.name), kMostShown);
  if (source.is_generated) return source.option + (shown.empty() ? "" : " " + shown);
  return source.option + " " + shown + ", column " + std::to_string(at.column);
}

PipelineDocument read_document(const std::string& file, const std::vector<std::string>& settings,
                               const host::Registry& registry, const host::PathRules& paths,
                               const std::vector<Patch>& patches) {
  return laid_over(read_base(file, registry, paths), patches, settings, registry, paths);
}

PipelineDocument read_base(const std::string& file, const host::Registry& registry,
                           const host::PathRules& paths) {
  return Reader(registry, paths).read(file);
}

PipelineDocument laid_over(PipelineDocument base, const std::vector<Patch>& patches,
                           const std::vector<std::string>& settings, const host::Registry& registry,
                           const host::PathRules& paths) {
  return Reader(registry, paths).lay(std::move(base), patches, settings);
}

}  // namespace weft
