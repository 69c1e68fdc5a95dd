// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// Role `templates`: builds the template from parameters, once, before the first frame.
class TemplateBuilder {
 public:
  virtual ~TemplateBuilder() = default;

  virtual Result<Template> build(const Call& call) = 0;

  static Role role() {
    return {"templates", {role_method<EmptyInput>("build", {output_slot<Template>("template")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<EmptyInput>("template", [&](const auto& in) { return build(in.call); });
  }
};

}  // namespace weft
