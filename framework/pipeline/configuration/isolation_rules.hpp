// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/document.hpp"

namespace weft {

/// True if a component has its own process by default.
class IsolationRules {
 public:
  /// No default for an unknown component.
  IsolationRules(const host::ComponentSpec& component, PipelinePart part, Isolating isolating);

  /// Why it cannot have one, or empty.
  const std::string& bound_by() const { return bound_by_; }

  bool is_wanted() const { return is_wanted_ && bound_by_.empty(); }

  /// True if the absence of a separate process deserves a message.
  bool has_reason() const { return has_reason_; }

 private:
  std::string bound_by_;
  bool is_wanted_ = false, has_reason_ = false;
};

}  // namespace weft
