// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/stage.hpp>

namespace {

struct MyPluginInput {
  weft::Call call;
  weft::Image image{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("image", self.image);
  }
};

/// A custom record is also a member here, under its name: docs/examples/own_records.
struct MyPluginOutput {
  weft::Region region{};

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("region", self.region);
  }
};

/// Lets detectors look only at what is bright enough and not blown out.
class MyPluginStage final : public weft::Stage<MyPluginInput, MyPluginOutput> {
 public:
  static constexpr weft::About kAbout{.needs = "image", .produces = "region"};

  explicit MyPluginStage(weft::Params& p) {
    p.read("darkest", darkest_, "grey levels", {0, 255},
           "grey level below which a pixel is excluded");
    p.read("brightest", brightest_, "grey levels", {0, 255},
           "grey level above which a pixel is excluded");
  }

  weft::Result<MyPluginOutput> run(const MyPluginInput& in) override {
    const auto& pixels = in.image.pixels;
    const std::int64_t height = pixels.dim(0), width = pixels.dim(1);
    const std::int64_t channels = pixels.ndim() == 3 ? 3 : 1;
    MyPluginOutput out{{weft::Array<std::uint8_t>({height, width}, 0)}};
    std::int64_t used = 0;
    for (std::int64_t y = 0; y < height; ++y) {
      weft::worked(width);
      for (std::int64_t x = 0; x < width; ++x) {
        const int grey = pixels(y, channels * x + channels / 2);  // green of a colour image
        if (grey < darkest_ || grey > brightest_) continue;
        out.region.mask(y, x) = 1;
        ++used;
      }
    }
    if (used == 0) return weft::no_result("no pixel is bright enough and not too bright");
    return out;
  }

 private:
  int darkest_ = 8, brightest_ = 250;
};

}  // namespace

WEFT_PLUGIN(MyPluginStage, "stages/my_plugin", "1.0.0",
            "Restricts detectors to pixels that are bright enough and not overexposed.")
