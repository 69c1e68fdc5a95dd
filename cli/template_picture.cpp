// SPDX-License-Identifier: Apache-2.0
#include "template_picture.hpp"

#include <fmt/core.h>

#include <span>
#include <weft/host/lane.hpp>

#include "sequence_maker.hpp"
#include "template_builder.hpp"

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
  constexpr int kOpen = 0, kWrite = 1, kFinish = 2;
  const weft_record inputs[] = {templ.view("template")};
  for (const int method : {kOpen, kWrite, kFinish}) {
    const std::span<const weft_record> given(inputs, method == kWrite ? 1 : 0);
    const host::Outcome outcome = lane.call(**instance, method, given, host::kOfflineFrame);
    if (!outcome.usable()) return outcome.error;
  }
  return {};
}

}  // namespace weft::cli
