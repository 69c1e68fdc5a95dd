// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/history.hpp"

#include <algorithm>
#include <weft/core/index.hpp>

namespace weft {

History::History(const Graph& graph) : graph_(graph) {
  for (const ValueInfo& value : graph.values) {
    if (value.lag == 0) continue;
    Past& past = by_slot_[value.slot];
    past.depth = std::max(past.depth, to_index(value.lag));
  }
}

host::RecordPtr History::find(const std::string& slot, int lag, std::uint64_t place) const {
  const std::lock_guard lock(mutex_);
  const auto found = by_slot_.find(slot);
  const std::uint64_t back = remembered_ - 1 - (place - static_cast<std::uint64_t>(lag));
  if (found == by_slot_.end() || back >= found->second.frames.size()) return nullptr;
  return found->second.frames[back];
}

void History::remember(const std::vector<host::RecordPtr>& values) {
  const std::lock_guard lock(mutex_);
  ++remembered_;
  std::map<std::string, host::RecordPtr> latest;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ValueInfo& value = graph_.values[i];
    if (value.lag == 0 && values[i] != nullptr) latest["previous." + value.slot] = values[i];
  }
  for (auto& [slot, past] : by_slot_) {
    const auto found = latest.find(slot);
    if (found != latest.end()) {
      past.frames.push_front(found->second);
    } else if (!past.frames.empty()) {
      past.frames.push_front(past.frames.front());
    }
    if (past.frames.size() > past.depth) past.frames.pop_back();
  }
}

void History::forget() {
  for (auto& [slot, past] : by_slot_) past.frames.clear();
}

}  // namespace weft
