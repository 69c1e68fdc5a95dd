// SPDX-License-Identifier: Apache-2.0
// Uses inputs that it did not declare.
#include <algorithm>
#include <weft/sdk/filter.hpp>

namespace {

enum class Wanted { nothing, templ, camera, previous_shape };

class Undeclared final : public weft::Filter {
 public:
  explicit Undeclared(weft::Params& p) {
    p.choice("wanted", wanted_,
             {{"nothing", Wanted::nothing},
              {"template", Wanted::templ},
              {"camera", Wanted::camera},
              {"previous_shape", Wanted::previous_shape}},
             "which input it uses");
    p.read("frame", frame_, "", {-1, 1e6}, "in which frame, -1 for all");
  }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}, 0), weft::Array<double>({n}, 0.0), {}};
    std::fill_n(mask.kept.data(), n, std::uint8_t{1});
    if (frame_ >= 0 && in.call.frame() != static_cast<std::uint64_t>(frame_)) return mask;
    if (wanted_ == Wanted::templ) use(in.templ->vertices_m);
    if (wanted_ == Wanted::camera) mask.diag.set("fx_px", in.camera.value().fx);
    if (wanted_ == Wanted::previous_shape) use((*in.previous_shape).vertices_m);
    return mask;
  }

 private:
  static void use(const weft::Array<double>& vertices_m) {
    const volatile double read = vertices_m(0, 0);
    static_cast<void>(read);
  }

  Wanted wanted_ = Wanted::nothing;
  int frame_ = -1;
};

}  // namespace

WEFT_PLUGIN(Undeclared, "filters/test_undeclared", "1.0.0", "Uses inputs that it did not ask for.")
