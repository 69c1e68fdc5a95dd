// SPDX-License-Identifier: Apache-2.0
#include "cli/template/template_picture.hpp"

#include <fmt/core.h>

#include <span>

#include "cli/data/sequence_maker.hpp"
#include "cli/template/template_builder.hpp"
#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"

namespace weft::cli {

namespace {

const char* name_of(Picture picture) {
  switch (picture) {
    case Picture::mesh:
      return "mesh";
    case Picture::texture:
      return "texture";
    case Picture::matches:
      return "matches";
    case Picture::twins:
      return "twins";
  }
  return "";
}

}  // namespace

Result<void> write_picture(const host::Registry& registry, const host::Record& templ,
                           Picture picture, const std::string& path) {
  const weft_record inputs[] = {templ.view("template")};
  return write_picture(registry, inputs, picture, path);
}

Result<void> write_picture(const host::Registry& registry, std::span<const weft_record> inputs,
                           Picture picture, const std::string& path) {
  const auto spec = resolve_text(
      registry, fmt::format("{{use: sinks/drawing, params: {{path: {}, content: {}}}}}",
                            yaml_quoted(path), name_of(picture)));
  if (!spec) return spec.error();
  host::ExecutionContext context(0, {});
  const auto instance = context.instantiate(*spec, "drawing");
  if (!instance) return instance.error();
  for (const int method : {kOpenSink, kWriteFrame, kFinishSink}) {
    const auto given = method == kWriteFrame ? inputs : std::span<const weft_record>();
    const host::Outcome outcome = context.call(**instance, method, given, host::kOfflineFrame);
    if (!outcome.usable()) return outcome.error;
  }
  return {};
}

}  // namespace weft::cli
