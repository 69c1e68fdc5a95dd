// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/history.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft {

History::History(const Graph& graph) {
  for (const ValueInfo& value : graph.values) {
    if (value.lag == 0) continue;
    Past& past = by_slot_[value.slot];
    past.depth = std::max(past.depth, to_index(value.lag));
    past.frames.reserve(past.depth + 1);
  }
  for (std::size_t i = 0; i < graph.values.size(); ++i) {
    const auto found = by_slot_.find("previous." + graph.values[i].slot);
    if (graph.values[i].lag == 0 && found != by_slot_.end()) found->second.values.push_back(i);
  }
}

host::RecordPtr History::find(const std::string& slot, int lag, std::uint64_t place) const {
  const std::lock_guard lock(mutex_);
  const auto found = by_slot_.find(slot);
  const std::uint64_t back = remembered_ - 1 - (place - static_cast<std::uint64_t>(lag));
  if (found == by_slot_.end() || back >= found->second.frames.size()) return nullptr;
  return found->second.frames[back];
}

void History::remember(std::span<const host::RecordPtr> values) {
  const std::lock_guard lock(mutex_);
  ++remembered_;
  for (auto& [slot, past] : by_slot_) {
    host::RecordPtr latest = past.frames.empty() ? nullptr : past.frames.front();
    for (const std::size_t i : past.values) {
      if (values[i] != nullptr) latest = values[i];
    }
    if (latest == nullptr) continue;
    past.frames.insert(past.frames.begin(), std::move(latest));
    if (past.frames.size() > past.depth) past.frames.pop_back();
  }
}

void History::forget() {
  for (auto& [slot, past] : by_slot_) past.frames.clear();
}

}  // namespace weft
