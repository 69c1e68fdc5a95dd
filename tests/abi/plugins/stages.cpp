// SPDX-License-Identifier: Apache-2.0
#include <weft/sdk/stage.hpp>

namespace {

struct Brightness {
  static constexpr const char* kType = "kept.brightness/1";
  weft::Array<std::uint16_t> sums;  ///< [H] grey levels
  double mean = 0.0;                ///< [] grey levels
  weft::Others others = {};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.sums, weft::Field{"sums", "H", "grey levels", "of each row"});
    visit(self.mean, weft::Field{"mean", "", "grey levels", "of the image"});
  }
};

struct Input {
  weft::Call call;
  weft::Image image{};
  weft::OptionalInput<Brightness> before{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
    visit("previous.kept.brightness", self.before);
  }
};

struct Output {
  Brightness brightness{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("kept.brightness", self.brightness);
  }
};

/// Adds up the rows of the image.
struct Small final : weft::Stage<Input, Output> {
  static constexpr weft::About kAbout{
      .needs = "image", .reads = "previous.kept.brightness", .produces = "kept.brightness"};

  explicit Small(weft::Params&) {}

  weft::Result<Output> run(const Input& in) override {
    const auto& pixels = in.image.pixels;
    Output out{{weft::Array<std::uint16_t>({pixels.dim(0)}, 0), 0.0}};
    for (std::int64_t y = 0; y < pixels.dim(0); ++y) {
      for (std::int64_t x = 0; x < pixels.dim(1); ++x) {
        out.brightness.sums(y) = static_cast<std::uint16_t>(out.brightness.sums(y) + pixels(y, x));
        out.brightness.mean += 0.015625 * pixels(y, x);
      }
    }
    if (in.before) out.brightness.mean += in.before->mean;
    return out;
  }
};

}  // namespace

WEFT_PLUGIN(Small, "stages/kept.small", "1.0.0", "Adds up the rows of the image.")
