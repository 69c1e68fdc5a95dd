// SPDX-License-Identifier: Apache-2.0
#include "sharpness.hpp"

#include <algorithm>

namespace acme {
namespace {

struct MeasureInput {
  weft::Call call;
  weft::Image image{};
  weft::OptionalInput<Sharpness> previous{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
    visit("previous.acme.sharpness", self.previous);
  }
};

struct MeasureOutput {
  Sharpness sharpness{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("acme.sharpness", self.sharpness);
  }
};

/// Measures how sharp each cell of the image is, and forgets slowly.
struct Measure final : weft::Stage<MeasureInput, MeasureOutput> {
  static constexpr weft::About kAbout{.reference = "Pech-Pacheco et al. 2000, ICPR",
                                      .needs = "image",
                                      .reads = "previous.acme.sharpness",
                                      .produces = "acme.sharpness"};
  int cell_px = 32;
  double memory = 0.5;

  explicit Measure(weft::Params& p) {
    p.read("cell_px", cell_px, "px", {8, 512}, "side of a cell");
    p.read("memory", memory, "", {0, 0.95}, "weight of the previous frame's value");
  }

  weft::Result<MeasureOutput> run(const MeasureInput& in) override {
    const auto& pixels = in.image.pixels;
    const std::int64_t rows = pixels.dim(0) / cell_px, columns = pixels.dim(1) / cell_px;
    if (rows == 0 || columns == 0) return weft::no_result("the image is smaller than a cell");
    MeasureOutput out{{weft::Array<double>({rows, columns}), cell_px}};
    const bool goes_on = in.previous && in.previous->cell_px == cell_px &&
                         in.previous->variance.shape() == out.sharpness.variance.shape();
    for (std::int64_t r = 0; r < rows; ++r) {
      for (std::int64_t c = 0; c < columns; ++c) {
        const double now = variance(pixels, r * cell_px, c * cell_px);
        const double before = goes_on ? in.previous->variance(r, c) : now;
        out.sharpness.variance(r, c) = memory * before + (1.0 - memory) * now;
      }
    }
    return out;
  }

 private:
  static double grey(const weft::Array<std::uint8_t>& pixels, std::int64_t y, std::int64_t x) {
    return pixels(y, pixels.ndim() == 3 ? 3 * x + 1 : x);  // green of a colour image
  }

  double variance(const weft::Array<std::uint8_t>& pixels, std::int64_t top,
                  std::int64_t left) const {
    double sum = 0.0, sum_of_squares = 0.0;
    int count = 0;
    for (std::int64_t y = top + 1; y < top + cell_px - 1; ++y) {
      for (std::int64_t x = left + 1; x < left + cell_px - 1; ++x, ++count) {
        const double laplacian = grey(pixels, y - 1, x) + grey(pixels, y + 1, x) +
                                 grey(pixels, y, x - 1) + grey(pixels, y, x + 1) -
                                 4.0 * grey(pixels, y, x);
        sum += laplacian;
        sum_of_squares += laplacian * laplacian;
      }
    }
    return sum_of_squares / count - sum / count * (sum / count);
  }
};

struct FocusInput {
  weft::Call call;
  weft::Image image{};
  Sharpness sharpness{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
    visit("acme.sharpness", self.sharpness);
  }
};

struct FocusOutput {
  weft::Region region{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("region", self.region);
  }
};

/// Lets detectors look only where the image is sharp.
struct InFocus final : weft::Stage<FocusInput, FocusOutput> {
  static constexpr weft::About kAbout{.needs = "image acme.sharpness", .produces = "region"};
  double least = 20.0;

  explicit InFocus(weft::Params& p) {
    p.read("least", least, "grey levels^2", {0, 1e6}, "sharpness below which a cell is excluded");
  }

  weft::Result<FocusOutput> run(const FocusInput& in) override {
    const std::int64_t height = in.image.pixels.dim(0), width = in.image.pixels.dim(1);
    FocusOutput out{{weft::Array<std::uint8_t>({height, width}, 0)}};
    const auto& variance = in.sharpness.variance;
    std::int64_t sharp = 0;
    for (std::int64_t y = 0; y < height; ++y) {
      for (std::int64_t x = 0; x < width; ++x) {
        const std::int64_t r = std::min(y / in.sharpness.cell_px, variance.dim(0) - 1);
        const std::int64_t c = std::min(x / in.sharpness.cell_px, variance.dim(1) - 1);
        out.region.mask(y, x) = variance(r, c) >= least ? 1 : 0;
        sharp += out.region.mask(y, x);
      }
    }
    if (sharp == 0) return weft::no_result("no cell is sharp");
    return out;
  }
};

}  // namespace
}  // namespace acme

WEFT_LIBRARY(WEFT_COMPONENT(acme::Measure, "stages/acme.sharpness", "1.0.0",
                            "Measures how sharp each cell of the image is."),
             WEFT_COMPONENT(acme::InFocus, "stages/acme.in_focus", "1.0.0",
                            "Lets detectors look only where the image is sharp."))
