// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/grid_parts.hpp"

#include <weft/core/index.hpp>

#include "host/records/content_hash.hpp"

namespace weft::lab {
namespace {

void append_number(std::string& text, std::size_t number) {
  text.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

void append_text(std::string& text, const std::string& part) {
  append_number(text, part.size());
  text += part;
}

/// The value and the index of its text, as bytes that no other value has.
void append_node(std::string& text, const yaml::Node& node) {
  text += static_cast<char>(node.kind);
  text += node.quoted ? '"' : ' ';
  append_number(text, to_index(node.at.source));
  append_text(text, node.scalar);
  append_number(text, node.items.size());
  for (const yaml::Node& item : node.items) append_node(text, item);
  append_number(text, node.entries.size());
  for (const yaml::Entry& entry : node.entries) {
    append_text(text, entry.key);
    append_node(text, entry.value);
  }
}

/// Which components stand where.
void append_components(std::string& text, const yaml::Node& node) {
  for (const yaml::Entry& entry : node.entries) {
    append_text(text, entry.key);
    if (entry.key == "use") append_text(text, entry.value.scalar);
    append_components(text, entry.value);
  }
  append_number(text, node.entries.size());
}

}  // namespace

PartNames part_names(const yaml::Node& root) {
  std::string data, rest;
  for (const yaml::Entry& entry : root.entries) {
    const bool is_data = entry.key == "source" || entry.key == "template";
    std::string& part = is_data ? data : rest;
    append_text(part, entry.key);
    append_node(part, entry.value);
    if (is_data) append_components(rest, entry.value);
  }
  return {host::content_hash(data), host::content_hash(rest)};
}

const IdentityPart* KnownParts::text_for(const Texts& texts, std::uint64_t seed) {
  auto found = texts.find(seed);
  if (found == texts.end()) found = texts.find(0);
  const bool fits = found != texts.end() && (found->first == seed || !found->second.seeded);
  return fits ? &found->second : nullptr;
}

std::optional<KnownPipeline> KnownParts::find(const PartNames& names,
                                              const std::vector<std::uint64_t>& seeds) const {
  const auto data = data_.find(names.data);
  const auto rest = rests_.find(names.rest);
  if (data == data_.end() || rest == rests_.end()) return std::nullopt;
  KnownPipeline known{rest->second.stages, rest->second.filters, seeds, {}};
  if (known.seeds.empty()) known.seeds.push_back(rest->second.own_seed);
  for (const std::uint64_t seed : known.seeds) {
    const IdentityPart* first = text_for(data->second, seed);
    const IdentityPart* second = text_for(rest->second.texts, seed);
    if (first == nullptr || second == nullptr) return std::nullopt;
    known.identities.push_back(Identifier::join(*first, *second));
    // Without the seed in it the next cell is the same work.
    if (!first->seeded && !second->seeded) {
      known.identities.resize(known.seeds.size(), known.identities.front());
      break;
    }
  }
  return known;
}

void KnownParts::note(const PartNames& names, const CheckedPipeline& pipeline,
                      const std::vector<std::uint64_t>& seeds, const Measurement& measurement,
                      Identifier& identifier, std::vector<yaml::Problem>& problems) {
  Rest rest;
  for (const StageConfig& stage : pipeline.config.stages) {
    rest.stages.push_back(stage.name);
    if (rules_of(stage.role).marks) rest.filters.push_back(stage.name);
  }
  rest.own_seed = pipeline.config.seed;
  std::vector<std::uint64_t> wanted = seeds;
  if (wanted.empty()) wanted.push_back(rest.own_seed);
  Texts data;
  std::vector<yaml::Problem> found, again;
  for (const std::uint64_t seed : wanted) {
    std::vector<yaml::Problem>& place = seed == wanted.front() ? found : again;
    IdentityPart first = identifier.data_part(pipeline, seed, place);
    IdentityPart second = identifier.rest_part(pipeline, seed, measurement, place);
    data.emplace(first.seeded ? seed : 0, first);
    rest.texts.emplace(second.seeded ? seed : 0, second);
    if (!first.seeded && !second.seeded) break;
  }
  problems.insert(problems.end(), found.begin(), found.end());
  if (!found.empty()) return;
  data_[names.data].merge(data);
  rests_.emplace(names.rest, std::move(rest));
}

}  // namespace weft::lab
