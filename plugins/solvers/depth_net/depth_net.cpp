// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "cell_points.hpp"
#include "common/inference/network_choice.hpp"
#include "common/inference/registration.hpp"
#include "common/seen/image_line.hpp"
#include "local_surface.hpp"
#include "rest_sheet.hpp"
#include "rigid_completion.hpp"

namespace weft::depth_net {
namespace {

// Share of cells that agree with the surface, below which it may well be wrong.
constexpr double kSureShare = 0.6;
// Measured: errors of the depth head against those of Gauss-Newton on the cells.
constexpr double kExcess = 2.5;
// Mean relative error of the edge lengths, beyond which the confidence falls.
constexpr double kMostStrain = 0.03;
// Standard deviations within which a cell agrees with the surface.
constexpr double kAgreeing = 3.0;
// A rigid placement needs six cells to reject one.
constexpr std::size_t kFewestCells = 6;
// Radius of the rigid placements, as a share of the template's diagonal.
constexpr double kPlacementShare = 0.125;

/// The dense head of a network that was trained for the template, without its vertex head. Mask,
/// registration and depth give points. A surface as rigid as possible passes through them.
class DepthNet final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "reconstruction: Fuentes-Jimenez et al., Deep Shape-from-Template: single-image "
          "quasi-isometric deformable registration and reconstruction, Image and Vision Computing "
          "127 (2022); "
          "Sorkine and Alexa, As-rigid-as-possible surface modeling, SGP 2007",
      .needs = "image"};

  explicit DepthNet(Params& p) {
    choice_.read(p);
    p.read("rigidity_m", rigidity_m_, "m", {1e-6, 1.0},
           "standard deviation of the change of a length of one cell on the template; smaller "
           "values give a more rigid surface");
    p.read("iterations", iterations_, "", {1, 10000},
           "number of iterations of the rigid completion");
  }

  void check(Mistakes& mistakes) const { choice_.check(mistakes); }

  Result<void> prepare(const PrepareInput& in) override {
    return prepare_sheet(in.templ, in.camera);
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.image) return Error{Errc::invalid_data, "needs 'image'"};
    if (auto ready = prepare_sheet(in.templ, in.camera); !ready) return ready.error();
    const auto maps = registration_.run(*in.image, in.call.threads());
    if (!maps) return maps.error();
    const auto seen = registration_.seen_cells(*maps, choice_.least_probability);
    if (auto enough = registration_.check_share(seen); !enough) return enough.error();
    const LocalSurface surface(cell_points(registration_, seen), placement_radius_m());
    if (auto enough = check_cells(surface.cells()); !enough) return enough.error();
    auto shape = shape_on(surface);
    if (!shape) return shape;
    shape->confidence *= registration_.confidence(seen, kExcess);
    if (shape->confidence < kSureShare) shape->state = static_cast<std::int32_t>(ShapeState::weak);
    shape->diag.set("visible_share", registration_.share_of(seen));
    return shape;
  }

 private:
  Result<void> prepare_sheet(const Template& templ, const Camera& camera) {
    if (auto ready = registration_.prepare(choice_, templ, camera); !ready) return ready;
    if (sheet_ && templ.revision != 0 && templ.revision == sheet_revision_) return {};
    sheet_.reset();
    auto made = RestSheet::create(templ, registration_.sheet());
    if (!made) return about("template", made.error());
    sheet_.emplace(*std::move(made));
    sheet_revision_ = templ.revision;
    return {};
  }

  double placement_radius_m() const {
    return kPlacementShare * registration_.sheet().size_m.matrix().norm();
  }

  static Result<void> check_cells(const std::vector<CellPoint>& cells) {
    if (cells.size() < kFewestCells) {
      return no_result("only " + std::to_string(cells.size()) +
                       " cells show a point of the template at a depth of 1 mm to 1 km, " +
                       std::to_string(kFewestCells) + " are needed");
    }
    if (solvers::lie_on_a_line(cells, [](const CellPoint& cell) { return cell.xy_m; })) {
      return no_result("the cells of the object lie on a line of the template");
    }
    return {};
  }

  Result<Shape> shape_on(const LocalSurface& surface) const {
    const std::optional<Draft> draft = draft_on(surface);
    if (!draft) return no_result("the points of the cells determine no pose of the template");
    const auto vertices_m = complete_rigidly(*sheet_, *draft, rigidity_m_, iterations_);
    if (!vertices_m) return vertices_m.error();
    if (!(vertices_m->allFinite() && vertices_m->col(2).minCoeff() > 0.0)) {
      return no_result("the surface of the network reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(*vertices_m);
    shape.source = Array<std::uint8_t>({vertices_m->rows()}, 0);
    for (Eigen::Index v = 0; v < vertices_m->rows(); ++v) {
      shape.source(v) = draft->certainty(v) > 0.0 ? 1 : 0;
    }
    judge(surface.cells(), *vertices_m, shape);
    shape.diag.set("measured_share", static_cast<double>((draft->certainty.array() > 0.0).count()) /
                                         static_cast<double>(vertices_m->rows()));
    return shape;
  }

  /// Measured vertices on the fitted surface, the others on the rigid placement of the template on
  /// the cells nearest to them. A placement of all visible cells together would need a hundred
  /// iterations to turn the hidden part of a bent surface.
  std::optional<Draft> draft_on(const LocalSurface& surface) const {
    const double cell_area_m2 = median_cell_area_m2(surface.cells());
    Draft draft{
        Points3(sheet_->vertex_count(), 3), {}, Eigen::VectorXd::Zero(sheet_->vertex_count())};
    std::map<std::size_t, std::optional<Placement>> placements;
    for (Eigen::Index v = 0; v < sheet_->vertex_count(); ++v) {
      const Eigen::Vector2d xy_m = sheet_->xy_m(v);
      const std::size_t nearest = surface.nearest(xy_m);
      const auto [found, is_new] = placements.try_emplace(nearest);
      if (is_new) found->second = surface.placement_around(nearest);
      if (!found->second) return std::nullopt;
      draft.frames.push_back(found->second->frame);
      const std::optional<FittedPoint> fitted = surface.at(xy_m);
      draft.vertices_m.row(v) = (fitted ? fitted->point_m : found->second->at(xy_m)).transpose();
      if (!fitted) continue;
      // A vertex counts as the measurements of its area, so that finer meshes weigh the same.
      draft.certainty(v) = sheet_->area_m2(v) / cell_area_m2 / (fitted->sigma_m * fitted->sigma_m);
    }
    return draft;
  }

  static double median_cell_area_m2(const std::vector<CellPoint>& cells) {
    std::vector<double> areas_m2;
    for (const CellPoint& cell : cells) areas_m2.push_back(cell.size_m * cell.size_m);
    return median_in_place(areas_m2);
  }

  /// Confidence and state from the cells and the lengths. A standard deviation counts up to one
  /// cell, because a network without any knowledge would else agree with itself.
  void judge(const std::vector<CellPoint>& cells, const Points3& vertices_m, Shape& shape) const {
    double agreeing = 0.0;
    std::vector<double> distances_m, sigmas_m;
    for (const CellPoint& cell : cells) {
      sigmas_m.push_back(cell.sigma_m);
      const auto point_m = sheet_->on(vertices_m, cell.xy_m);
      if (!point_m) continue;
      distances_m.push_back((*point_m - cell.point_m).norm());
      const double reach_m = kAgreeing * std::min(cell.sigma_m, cell.size_m);
      agreeing += distances_m.back() <= reach_m ? 1.0 : 0.0;
    }
    const double share = agreeing / static_cast<double>(cells.size());
    const double strain = sheet_->mean_strain(vertices_m);
    shape.confidence = share * std::min(1.0, kMostStrain / strain);
    shape.diag.set("cells_agree", share);
    if (!distances_m.empty()) {
      shape.diag.set("cells_distance_mm", 1e3 * median_in_place(distances_m));
    }
    shape.diag.set("expected_error_mm", 1e3 * median_in_place(sigmas_m));
    shape.diag.set("mean_strain", strain);
  }

  inference::NetworkChoice choice_;
  double rigidity_m_ = 0.0005;
  int iterations_ = 20;
  inference::Registration registration_;
  std::optional<RestSheet> sheet_;
  std::uint64_t sheet_revision_ = 0;
};

}  // namespace
}  // namespace weft::depth_net

WEFT_PLUGIN(weft::depth_net::DepthNet, "solvers/depth_net", "1.0.0",
            "Gives the shape from the depth and registration of a network trained for the "
            "template.")
