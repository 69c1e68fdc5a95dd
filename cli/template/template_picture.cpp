// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_picture.hpp"

#include <fmt/core.h>

#include <span>

#include "cli/data/sequence_maker.hpp"
#include "cli/template/template_builder.hpp"
#include "host/calling/lane.hpp"
#include "roles/role_rules.hpp"

namespace weft::cli {

Result<void> write_picture(const host::Registry& registry, const host::Record& templ,
                           Picture picture, const std::string& path) {
  const auto spec = resolve_text(
      registry, fmt::format("{{use: sinks/drawing, params: {{path: {}, content: {}}}}}",
                            yaml_quoted(path), picture == Picture::mesh ? "mesh" : "texture"));
  if (!spec) return spec.error();
  host::Lane lane(0, {});
  const auto instance = lane.instantiate(*spec, "drawing");
  if (!instance) return instance.error();
  const weft_record inputs[] = {templ.view("template")};
  for (const int method : {kOpenSink, kWriteFrame, kFinishSink}) {
    const std::span<const weft_record> given(inputs, method == kWriteFrame ? 1 : 0);
    const host::Outcome outcome = lane.call(**instance, method, given, host::kOfflineFrame);
    if (!outcome.usable()) return outcome.error;
  }
  return {};
}

}  // namespace weft::cli
