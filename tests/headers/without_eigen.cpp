// SPDX-License-Identifier: Apache-2.0
// A filter and a solver that read their arrays element by element.
#include <weft/sdk/filter.hpp>
#include <weft/sdk/solver.hpp>

namespace {

class LeftHalf final : public weft::Filter {
 public:
  static constexpr weft::About kAbout{.needs = "camera"};
  explicit LeftHalf(weft::Params& p) { p.read("share", share_, "", {0, 1}, "of the image"); }

  weft::Result<weft::InlierMask> filter(const weft::FilterInput& in) override {
    const std::int64_t n = in.correspondences.count();
    weft::InlierMask mask{weft::Array<std::uint8_t>({n}), weft::Array<double>({n}, 1.0), {}};
    const double last_px = share_ * static_cast<double>(in.camera->width_px);
    for (std::int64_t i = 0; i < n; ++i) {
      mask.kept(i) = in.correspondences.image_px(i, 0) < last_px ? 1 : 0;
    }
    return mask;
  }

 private:
  double share_ = 0.5;
};

class Still final : public weft::Solver {
 public:
  explicit Still(weft::Params&) {}

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    weft::Shape shape;
    shape.vertices_m = in.templ.vertices_m;
    shape.confidence = weft::shape_evidence(in.templ, in.camera, shape.vertices_m,
                                            in.correspondences, in.sightlines)
                           .coverage;
    return shape;
  }
};

}  // namespace

WEFT_LIBRARY(WEFT_COMPONENT(LeftHalf, "filters/left_half", "1.0.0", "Keeps the left half."),
             WEFT_COMPONENT(Still, "solvers/still", "1.0.0", "Leaves the template where it is."))
