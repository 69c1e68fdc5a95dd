// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/equipment.hpp"

#include <algorithm>
#include <weft/core/version.hpp>

#include "host/loading/processor.hpp"

namespace weft::cluster {

Equipment Equipment::here(const host::Registry& registry) {
  Equipment equipment{kVersion, host::processor_features(), {}};
  for (const host::Installed& installed : registry.installed()) {
    if (installed.shadowed) continue;
    equipment.builds.emplace(installed.component.id, installed.library->build_id);
  }
  return equipment;
}

std::string Equipment::difference(const Equipment& other) const {
  if (weft != other.weft) return "Weft has version " + other.weft + " instead of " + weft;
  if (processor != other.processor) return "the processor has other features";
  std::vector<std::string> ids;
  for (const auto& [id, build] : builds) {
    const auto found = other.builds.find(id);
    if (found == other.builds.end()) ids.push_back(id + " (missing)");
    if (found != other.builds.end() && found->second != build) ids.push_back(id);
  }
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(ids.size(), kMost); ++i) {
    text += (i == 0 ? "components from another build: " : ", ") + ids[i];
  }
  if (ids.size() > kMost) text += " and " + std::to_string(ids.size() - kMost) + " more";
  return text;
}

}  // namespace weft::cluster
