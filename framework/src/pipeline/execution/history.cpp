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

host::RecordPtr History::find(const std::string& slot, int lag) const {
  const auto found = by_slot_.find(slot);
  const auto back = to_index(lag) - 1;
  if (found == by_slot_.end() || back >= found->second.frames.size()) return nullptr;
  return found->second.frames[back];
}

void History::remember(const std::vector<host::RecordPtr>& values) {
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

}  // namespace weft
