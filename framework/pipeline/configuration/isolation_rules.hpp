// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/roles/role_rules.hpp"
#include "pipeline/configuration/document.hpp"

namespace weft {

/// Whether a component has a process of its own where the pipeline says nothing of it.
class IsolationRules {
 public:
  /// Of a component that is not known nothing is wanted.
  IsolationRules(const host::ComponentSpec& component, PipelinePart part, Isolating isolating);

  /// Why it cannot have one, or empty.
  const std::string& bound_by() const { return bound_by_; }

  bool is_wanted() const { return is_wanted_ && bound_by_.empty(); }

  /// Whether it would be worth saying that it has none.
  bool has_reason() const { return has_reason_; }

 private:
  std::string bound_by_;
  bool is_wanted_ = false, has_reason_ = false;
};

}  // namespace weft
