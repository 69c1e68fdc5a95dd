// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/sink.hpp>

namespace {

/// Counts vertices, and reports the count as its error.
struct Small final : weft::Sink {
  static constexpr weft::About kAbout{.needs = "shape", .reads = "image"};

  explicit Small(weft::Params&) {}

  weft::Result<void> open(const weft::Call&) override { return {}; }
  weft::Result<void> write(const weft::SinkInput& in) override {
    vertices_ += in.shape->vertices_m.rows();
    return {};
  }
  std::vector<weft::ChangeRequest> take_change_requests() { return {{7, "pause"}, {8, "stop"}}; }
  void answer(const weft::ChangeAnswer& given) { vertices_ += 100 * (given.refusal == "no"); }
  weft::Result<void> finish(const weft::Call&) override {
    return weft::Error{weft::Errc::io, "written: " + std::to_string(vertices_) + " vertices", {}};
  }

 private:
  std::int64_t vertices_ = 0;
};

}  // namespace

WEFT_PLUGIN(Small, "sinks/kept.small", "1.0.0", "Counts vertices.")
