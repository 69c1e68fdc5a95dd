// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "common/smooth_spline.hpp"
#include "common/surface_shape.hpp"
#include "common/warp_grid.hpp"
#include "depth_from_gradients.hpp"
#include "depth_from_normals.hpp"

namespace weft::chhatkuli_stable {
namespace {

constexpr std::size_t kFewestPoints = 50;
constexpr double kLeastShare = 0.2;  // least share of the template; with less, no surface bends
                                     // reliably
// Fitted to simulated surfaces: docs/evidence/0023-confidence-of-solvers.md.
constexpr solvers::ConfidenceWeights kConfidence{.bias = -20.462,
                                                 .strain = -0.566,
                                                 .residual = -1.159,
                                                 .roughness = -1.308,
                                                 .size = 2.481,
                                                 .agreeing = 0.384,
                                                 .share = 3.432,
                                                 .coverage = 0.417};

enum class Variant { cvpr2014, tpami2017 };

/// The stable closed-form isometric solution: the first-order part of the direct one, integrated.
class ChhatkuliStable final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "paper: Chhatkuli, Pizarro, Bartoli, Stable Template-Based Isometric 3D Reconstruction "
          "in All "
          "Imaging Conditions by Linear Least-Squares, CVPR 2014; with Collins, TPAMI 39(5) (2017)",
      .needs = "correspondences",
      .reads = ""};

  explicit ChhatkuliStable(Params& p) {
    p.choice("variant", variant_,
             {{"cvpr2014", Variant::cvpr2014}, {"tpami2017", Variant::tpami2017}},
             "published method; cvpr2014: integration of the gradient of the distance over the "
             "template; tpami2017: integration of normals over the image");
    grid_.declare(p);
    p.read("reference_smoothing", stiffness_.reference, "", {1e-9, 1e6},
           "bending weight of the spline that determines the signs of gradients and normals, in "
           "areas of the domain");
    p.read("integration_smoothing", stiffness_.integration, "", {1e-12, 1e6},
           "bending weight of the integrated function, relative to squared slopes");
    p.read("image_control", image_control_, "", {4, 60},
           "number of control points of the depth along each side of the image; for tpami2017");
    p.read("control", control_, "", {4, 40},
           "number of control points of the surface along u and along v");
    p.read("smoothing", smoothing_, "", {1e-6, 1e6},
           "weight of the surface's bending energy, in areas of a knot cell");
  }

  Result<Shape> solve(const SolverInput& in) override {
    const auto warp = grid_.read(in);
    if (!warp) return warp.error();
    const auto reading = solvers::isometric_reading(warp->places);
    if (auto enough = check_points(reading.points.size(), warp->on_mesh); !enough) {
      return enough.error();
    }
    const SplineDomain domain = grid_.domain(control_);
    const auto depth = variant_ == Variant::cvpr2014
                           ? from_gradients_.find(reading, domain, stiffness_)
                           : from_normals_.find(reading, image_control_, stiffness_);
    if (!depth) return depth.error();
    surface_.set_domain(domain);
    if (auto fitted = surface_.fit(reading.places_px, depth->points_m, smoothing_); !fitted) {
      return fitted.error();
    }
    auto shape =
        solvers::surface_shape(in, grid_, surface_.at(in.templ.flat_px.matrix<2>()), kConfidence);
    if (!shape) return shape;
    report(reading, *depth, shape->diag);
    if (warp->degenerate_reason.empty()) return shape;
    return degenerate(*std::move(shape), warp->degenerate_reason);
  }

  bool joins_seams() const override { return false; }  // works in the plane of the texture

 private:
  static Result<void> check_points(std::size_t points, std::size_t on_mesh) {
    if (points < kFewestPoints) {
      return no_result("the depth is known at " + std::to_string(points) + " places of at least " +
                       std::to_string(kFewestPoints));
    }
    if (static_cast<double>(points) < kLeastShare * static_cast<double>(on_mesh)) {
      return no_result("the depth is known at " + std::to_string(points) + " of " +
                       std::to_string(on_mesh) + " places, less than a fifth of the template");
    }
    return {};
  }

  static void report(const solvers::IsometricReading& reading, const StableDepth& depth,
                     Diagnostics& diag) {
    diag.set("points", static_cast<double>(reading.points.size()));
    diag.set("folded_points", static_cast<double>(reading.folded));
    diag.set("left_out_points", static_cast<double>(depth.left_out));
    diag.set("is_direct", depth.is_direct ? 1.0 : 0.0);
    diag.set("normal_angle_rad", depth.angle_rad);
  }

  Variant variant_ = Variant::tpami2017;
  solvers::WarpGrid grid_;
  Smoothing stiffness_;
  int image_control_ = 20;
  int control_ = 12;
  double smoothing_ = 0.1;
  DepthFromGradients from_gradients_;
  DepthFromNormals from_normals_;
  solvers::SmoothSpline surface_;
};

}  // namespace
}  // namespace weft::chhatkuli_stable

using weft::chhatkuli_stable::ChhatkuliStable;
WEFT_PLUGIN(ChhatkuliStable, "solvers/chhatkuli_stable", "1.1.0",
            "Integrates an isometric shape in closed form from gradients or normals.")
