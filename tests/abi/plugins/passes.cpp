// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/pass.hpp>

namespace {

/// Marks every other vertex as visible.
struct Small final : weft::Pass {
  static constexpr weft::About kAbout{.reads = "previous.shape", .produces = "visibility"};

  explicit Small(weft::Params&) {}

  weft::Result<weft::PassOutput> run(const weft::PassInput& in) override {
    const std::int64_t vertices = in.templ.vertices_m.rows();
    weft::PassOutput out;
    out.visibility.emplace();
    out.visibility->visible = weft::Array<std::uint8_t>({vertices});
    out.visibility->score = weft::Array<double>({vertices});
    out.visibility->reason = weft::Array<std::uint8_t>({vertices});
    for (std::int64_t i = 0; i < vertices; ++i) {
      out.visibility->visible(i) = i % 2 == 0 ? 1 : 0;
      out.visibility->score(i) = i % 2 == 0 ? 1.0 : 0.0;
      out.visibility->reason(i) = i % 2 == 0 ? 0 : 3;
    }
    out.visibility->diag.set("went_on", in.previous_shape ? 1.0 : 0.0);
    return out;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "passes/kept.small", "1.0.0", "Says that every other vertex is seen.")
