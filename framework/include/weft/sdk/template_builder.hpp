// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// Role `templates`: builds the template from parameters, once, before the first frame.
class TemplateBuilder {
 public:
  static constexpr const char* kRole = "templates";
  static constexpr About kAbout{};
  virtual ~TemplateBuilder() = default;

  virtual Result<Template> build(const Call& call) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    return {kRole, {role_method<EmptyInput>("build", {output_slot<Template>("template")})}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run<EmptyInput>("template", [&](const auto& in) { return build(in.call); });
  }
};

/// A nested template, for example of the object that a source simulates.
struct TemplateComponent : ComponentHandle {
  explicit TemplateComponent(const char* default_component)
      : ComponentHandle{"templates", default_component} {}

  Result<Template> build(const Call& call) const {
    return detail::invoke<Template>(call, handle, 0, {});
  }
};

}  // namespace weft
