// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <weft/core/suggest.hpp>
#include <weft/pipeline/document.hpp>

#include "document_merge.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;

void stamp(yaml::Position& at, int source) { at.source = source; }

void stamp(yaml::Node& node, int source) {
  stamp(node.at, source);
  for (yaml::Node& item : node.items) stamp(item, source);
  for (yaml::Entry& entry : node.entries) {
    stamp(entry.at, source);
    stamp(entry.value, source);
  }
}

void erase(yaml::Node& map, std::string_view key) {
  std::erase_if(map.entries, [&](const yaml::Entry& entry) { return entry.key == key; });
}

class Reader {
 public:
  explicit Reader(const host::PathRules& paths) : paths_(paths) {}

  Document read(const std::string& file) {
    document_.root = read_file(file, {});
    return std::move(document_);
  }

  Document lay(Document base, const std::vector<Patch>& patches,
               const std::vector<std::string>& settings) {
    document_ = std::move(base);
    for (const Patch& patch : patches) lay(patch);
    for (const std::string& setting : settings) {
      const int source = add_source({setting, fs::current_path().string(), true});
      if (document_.unreadable) continue;
      auto [overlay, problems] = overlay_of(setting, document_.root);
      stamp(overlay, source);
      report(std::move(problems), source);
      document_.root = merged(std::move(document_.root), std::move(overlay));
    }
    return std::move(document_);
  }

 private:
  int add_source(ConfigSource source) {
    document_.sources.push_back(std::move(source));
    return static_cast<int>(document_.sources.size()) - 1;
  }

  void lay(const Patch& patch) {
    const int source = add_source(patch.source);
    if (document_.unreadable) return;
    yaml::Node node = patch.node;
    stamp(node, source);
    if (const yaml::Node* without = node.find("without")) leave_out(document_.root, *without);
    const yaml::Node* given = node.find("set");
    const yaml::Node settings = given != nullptr ? *given : yaml::Node{};
    erase(node, "without");
    erase(node, "set");
    document_.root = merged(std::move(document_.root), std::move(node));
    for (const yaml::Entry& setting : settings.entries) {
      auto [overlay, problems] = overlay_of(setting, document_.root);
      report(std::move(problems), source);
      document_.root = merged(std::move(document_.root), std::move(overlay));
    }
  }

  void report(std::vector<yaml::Problem> problems, int source) {
    for (yaml::Problem& problem : problems) {
      stamp(problem.at, source);
      document_.problems.push_back(std::move(problem));
    }
  }

  /// Nothing but this can be said of a text that is no YAML.
  yaml::Node syntax_error(yaml::Position at, std::string message) {
    document_.problems.clear();
    return give_up(at, std::move(message));
  }

  /// What else is missing would only follow from this.
  yaml::Node give_up(yaml::Position at, std::string message) {
    problem(at, std::move(message));
    document_.unreadable = true;
    return {};
  }

  yaml::Node read_file(const std::string& file, std::vector<std::string> chain) {
    const int source = add_source({file, fs::absolute(file).parent_path().string(), false});
    const auto text = yaml::read_text(file);
    if (!text) {
      return syntax_error({1, 1, source},
                          "the pipeline file cannot be read: " + text.error().message);
    }
    auto parsed = yaml::parse(*text, file);
    if (!parsed) {
      yaml::Position at = yaml::position_in(parsed.error().where, file);
      stamp(at, source);
      return syntax_error(at, parsed.error().message);
    }
    yaml::Node root = std::move(parsed->root);
    stamp(root, source);
    report(std::move(parsed->problems), source);
    chain.push_back(fs::weakly_canonical(file).string());
    return extended(std::move(root), source, chain);
  }

  /// The root laid over the file that it extends, if it does.
  yaml::Node extended(yaml::Node root, int source, const std::vector<std::string>& chain) {
    const yaml::Node* extends = root.find("extends");
    const yaml::Node* without = root.find("without");
    if (extends == nullptr) {
      if (without != nullptr) {
        problem(without->at, "'without' needs 'extends', the file whose stages it leaves out");
        erase(root, "without");
      }
      return root;
    }
    yaml::Node base = read_base(*extends, source, chain);
    if (document_.unreadable) return {};
    if (without != nullptr) leave_out(base, *without);
    erase(root, "extends");
    erase(root, "without");
    base.at = root.at;  // a missing key is missing in this file
    return merged(std::move(base), std::move(root));
  }

  yaml::Node read_base(const yaml::Node& extends, int source,
                       const std::vector<std::string>& chain) {
    if (extends.kind != yaml::Kind::scalar || extends.scalar.empty()) {
      return give_up(extends.at, "'extends' must be the path of a pipeline file");
    }
    const auto expanded = host::expand_variables(extends.scalar, paths_);
    if (!expanded) {
      return give_up(extends.at, expanded.error().message);
    }
    const std::string& folder = document_.sources[static_cast<std::size_t>(source)].folder;
    const std::string file = (fs::path(folder) / *expanded).lexically_normal().string();
    if (const auto text = yaml::read_text(file); !text) {
      return give_up(extends.at, text.error().code == Errc::not_found
                                     ? "'extends': there is no file " + file
                                     : "'extends': " + file + ": " + text.error().message);
    }
    if (std::find(chain.begin(), chain.end(), fs::weakly_canonical(file).string()) != chain.end()) {
      return give_up(extends.at, "'extends': " + file + " extends itself");
    }
    return read_file(file, chain);
  }

  void leave_out(yaml::Node& base, const yaml::Node& without) {
    if (without.kind != yaml::Kind::sequence) {
      return problem(without.at, "'without' must be a list of names of stages and sinks");
    }
    std::set<std::string> unwanted;
    for (const yaml::Node& name : without.items) unwanted.insert(name.scalar);
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
      const std::string near = nearest(name.scalar, known);
      problem(name.at, "the extended file has no stage or sink '" + name.scalar + "'" +
                           (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
  }

  void problem(yaml::Position at, std::string message) {
    document_.problems.push_back({at, std::move(message)});
  }

  const host::PathRules& paths_;
  Document document_;
};

}  // namespace

std::string place_in(const std::vector<ConfigSource>& sources, yaml::Position at) {
  const ConfigSource& source = sources.at(static_cast<std::size_t>(at.source));
  if (!source.is_setting) return yaml::place(source.name, at);
  return "--set " + source.name + ", column " + std::to_string(at.column);
}

std::vector<std::string> names_of_stages(const yaml::Node& list) {
  std::map<std::string, int> unnamed;
  std::vector<std::string> names;
  for (const yaml::Node& item : list.items) {
    const yaml::Node* as = item.find("as");
    if (as != nullptr) {
      names.push_back(as->scalar);
      continue;
    }
    const yaml::Node* use = item.find("use");
    const std::string role = use != nullptr ? use->scalar.substr(0, use->scalar.find('/')) : "";
    const int number = ++unnamed[role];
    names.push_back(number == 1 ? role : role + "#" + std::to_string(number));
  }
  return names;
}

Document read_document(const std::string& file, const std::vector<std::string>& settings,
                       const host::PathRules& paths, const std::vector<Patch>& patches) {
  return laid_over(read_base(file, paths), patches, settings, paths);
}

Document read_base(const std::string& file, const host::PathRules& paths) {
  return Reader(paths).read(file);
}

Document laid_over(Document base, const std::vector<Patch>& patches,
                   const std::vector<std::string>& settings, const host::PathRules& paths) {
  return Reader(paths).lay(std::move(base), patches, settings);
}

}  // namespace weft
