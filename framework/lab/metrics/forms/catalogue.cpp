// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/forms/catalogue.hpp"

#include <fmt/format.h>

#include <array>
#include <type_traits>

#include "lab/metrics/forms/every_declaration.hpp"
#include "lab/metrics/run_metrics.hpp"

namespace weft::lab {
namespace {

template <class Member>
struct ListOf : std::false_type {};
template <class Entry>
struct ListOf<std::vector<Entry>> : std::bool_constant<MetricStruct<Entry>> {
  using Type = Entry;
};

/// Collects the paths of all declarations. Columns do not indicate that a member belongs to the
/// truth.
class Collector : public EveryDeclaration<Collector> {
 public:
  Collector(std::string prefix, char joint, std::vector<CatalogueEntry>& entries)
      : prefix_(std::move(prefix)), joint_(joint), entries_(entries) {}

  template <class Member>
  void operator()(const MetricField& field, const Member& member) {
    if constexpr (MetricStruct<const Member>) {
      enter(field.name, member);
    } else if constexpr (ListOf<Member>::value) {
      // The frames have a separate catalogue.
      using Entry = typename ListOf<Member>::Type;
      const char* label = std::is_same_v<Entry, GroupMetrics>  ? "KIND"
                          : std::is_same_v<Entry, PartMetrics> ? "PART"
                                                               : "STAGE";
      if constexpr (!std::is_same_v<Entry, FrameMetrics>) {
        enter(std::string(field.name) + joint_ + label, Entry{});
      }
    } else if constexpr (std::is_arithmetic_v<Member> && !std::is_same_v<Member, bool>) {
      entries_.push_back({prefix_ + field.name, field});
    }
  }

  using EveryDeclaration::derived;
  template <class Value>
  void derived(const MetricField& field, const std::optional<Value>& /*value*/) {
    (*this)(field, Value{});
  }

  template <class Metrics>
  void optional(const std::optional<Metrics>& /*metrics*/) {
    const Metrics any{};
    Metrics::fields(any, *this);
  }

  template <class Metrics>
  void keyed(const MetricField& /*field*/,
             const std::vector<std::pair<std::string, Metrics>>& /*pairs*/) {
    enter(std::is_same_v<Metrics, FramePart> ? "PART" : "STAGE", Metrics{});
  }

 private:
  template <class Metrics>
  void enter(const std::string& name, const Metrics& metrics) {
    Collector inner(prefix_ + name + joint_, joint_, entries_);
    Metrics::fields(metrics, inner);
  }

  std::string prefix_;
  char joint_;
  std::vector<CatalogueEntry>& entries_;
};

template <class Metrics>
std::vector<CatalogueEntry> catalogue_of(char joint) {
  std::vector<CatalogueEntry> entries;
  Collector collector("", joint, entries);
  const Metrics any{};
  Metrics::fields(any, collector);
  return entries;
}

std::vector<std::string> words_of(const std::string& path) {
  std::vector<std::string> words{""};
  for (const char c : path) c == '.' ? void(words.emplace_back()) : words.back().push_back(c);
  return words;
}

/// True if the words of a path match a pattern, whose STAGE or KIND may be omitted; then `label` is
/// the word at that position.
bool matches(const std::vector<std::string>& pattern, const std::vector<std::string>& words,
             std::string& label) {
  std::size_t at = 0;
  for (const std::string& each : pattern) {
    const bool is_label = each == "KIND" || each == "STAGE" || each == "PART";
    const bool is_named = is_label && words.size() == pattern.size();
    if (is_label && !is_named) continue;
    if (at == words.size() || (!is_label && words[at] != each)) return false;
    if (is_named) label = words[at];
    ++at;
  }
  return at == words.size();
}

std::string table_of(const std::string& title, const std::vector<CatalogueEntry>& entries,
                     bool named) {
  std::string text = fmt::format("| {} | {}unit | better | meaning |\n|---|{}---|---|---|\n", title,
                                 named ? "name | " : "", named ? "---|" : "");
  for (const CatalogueEntry& entry : entries) {
    const auto& better = entry.field.better;
    std::string meaning = entry.field.meaning;
    for (std::size_t at = 0; (at = meaning.find('|', at)) != std::string::npos; at += 2) {
      meaning.insert(at, 1, '\\');
    }
    const std::string name = named ? metric_name(entry.path) + " | " : "";
    text += fmt::format("| `{}` | {}{} | {} | {} |\n", entry.path, name, unit_of(entry.path),
                        !better ? "" : (*better == Better::lower ? "lower" : "higher"), meaning);
  }
  return text;
}

}  // namespace

std::vector<CatalogueEntry> run_catalogue() { return catalogue_of<RunMetrics>('.'); }

std::vector<CatalogueEntry> frame_catalogue() { return catalogue_of<FrameMetrics>('_'); }

FoundEntry entry_of(const std::string& path) {
  static const std::vector<CatalogueEntry> kEntries = run_catalogue();
  const std::vector<std::string> words = words_of(path);
  for (const CatalogueEntry& entry : kEntries) {
    std::string label;
    if (matches(words_of(entry.path), words, label)) return {&entry, label};
  }
  return {};
}

const MetricField* field_of(const std::string& path) {
  const CatalogueEntry* entry = entry_of(path).entry;
  return entry == nullptr ? nullptr : &entry->field;
}

std::string unit_of(const std::string& path) {
  for (const auto& [ending, unit] :
       {std::pair{"_mm", "mm"}, std::pair{"_mm2", "mm^2"}, std::pair{"_px", "px"},
        std::pair{"_percent", "%"}, std::pair{"_ms", "ms"}}) {
    if (path.ends_with(ending)) return unit;
  }
  return "";
}

std::string metrics_page() {
  return table_of("`metric:` of a run", run_catalogue(), true) + "\n" +
         table_of("column of a frame", frame_catalogue(), false);
}

}  // namespace weft::lab
