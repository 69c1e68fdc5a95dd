// SPDX-License-Identifier: Apache-2.0
#include "pipeline/overview/origins.hpp"

#include <algorithm>
#include <sstream>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>

#include "pipeline/configuration/document_merge.hpp"

namespace weft {
namespace {

constexpr std::size_t kCommentColumn = 52;

bool is_component_list(const yaml::Node& node) {
  return node.kind == yaml::Kind::sequence && !node.items.empty() &&
         node.items.front().kind == yaml::Kind::map;
}

/// Walks the text of a configuration beside the document that it was loaded from: a value that the
/// document lacks is a default.
class Origins {
 public:
  Origins(const std::vector<ConfigSource>& sources, std::size_t lines)
      : sources_(sources), comments_(lines) {}

  /// `given` is the same part of the document, or null; `owner` the component whose defaults fill
  /// it, empty for those of the format.
  void add(const yaml::Node& shown, const yaml::Node* given, const std::string& owner) {
    const yaml::Node* use = shown.find("use");
    for (const yaml::Entry& entry : shown.entries) {
      const yaml::Node* value = given != nullptr ? given->find(entry.key) : nullptr;
      const bool of_component = use != nullptr && entry.key != "use";
      const std::string& filler = of_component ? use->scalar : owner;
      if (use != nullptr && entry.key == "template_params") {
        const yaml::Node* base = given != nullptr ? given->find("params") : nullptr;
        const yaml::Node both = merged(base != nullptr ? *base : yaml::Node{},
                                       value != nullptr ? *value : yaml::Node{});
        add(entry.value, &both, filler);
      } else if (entry.value.kind == yaml::Kind::map && !entry.value.entries.empty()) {
        add(entry.value, value, filler);
      } else if (is_component_list(entry.value)) {
        for (std::size_t i = 0; i < entry.value.items.size(); ++i) {
          add(entry.value.items[i], value != nullptr ? &value->items.at(i) : nullptr, "");
        }
      } else {
        comment(entry, value, filler);
      }
    }
  }

  const std::string& of_line(std::size_t line) const { return comments_.at(line); }

 private:
  void comment(const yaml::Entry& shown, const yaml::Node* given, const std::string& owner) {
    std::string origin = "default" + (owner.empty() ? "" : " of " + owner);
    if (given != nullptr) {
      const ConfigSource& source = sources_.at(to_index(given->at.source));
      origin = source.is_setting ? source.option
                                 : escaped(source.name) + ":" + std::to_string(given->at.line);
      if (shown.key == "preset") origin += "; defines all parameters that are not listed";
    }
    comments_.at(to_index(shown.at.line) - 1) = origin;
  }

  const std::vector<ConfigSource>& sources_;
  std::vector<std::string> comments_;  ///< by line
};

}  // namespace

std::string yaml_with_origins(const PipelineConfig& config, const yaml::Node& root) {
  const std::string text = effective_yaml(config);
  const auto shown = yaml::parse(text, "");
  Origins origins(config.sources, to_index(std::count(text.begin(), text.end(), '\n')) + 1);
  if (shown) origins.add(shown->root, &root, "");
  std::string annotated;
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    const std::string& origin = origins.of_line(number);
    annotated += line;
    if (!origin.empty()) {
      const std::size_t blanks = line.size() < kCommentColumn ? kCommentColumn - line.size() : 2;
      annotated += std::string(blanks, ' ') + "# " + origin;
    }
    annotated += '\n';
  }
  return annotated;
}

}  // namespace weft
