// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/solver.hpp>

#include "common/inference/network_choice.hpp"
#include "common/inference/registration.hpp"
#include "grid_surface.hpp"

namespace weft::mesh_net {
namespace {

using inference::NetworkMaps;
using inference::SeenCell;

// Share of cells that agree with the surface, below which it may well be wrong.
constexpr double kSureShare = 0.6;
// Measured: errors of the vertex head against those of Gauss-Newton on the cells.
constexpr double kExcess = 2.5;
// A logarithm of a depth in m beyond this is no depth of an object before a camera.
constexpr double kMostLogDepth = 7.0;

/// How well the surface of the vertices fits the cells of the same network.
struct Agreement {
  double share = 0.0;        ///< share of the seen cells that agree
  double distance_px = 0.0;  ///< median, frame
};

/// One forward pass of a network that was trained for the template: the vertices of a coarse grid
/// in the camera frame, interpolated to the template's mesh.
class MeshNet final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "reconstruction: Golyanik et al., HDM-Net: monocular non-rigid 3D reconstruction with "
          "learned deformation model, EuroVR 2018; Shimada et al., IsMo-GAN: adversarial learning "
          "for "
          "monocular non-rigid 3D reconstruction, CVPR Workshops 2019",
      .needs = "image"};

  explicit MeshNet(Params& p) { choice_.read(p); }

  void check(Mistakes& mistakes) const { choice_.check(mistakes); }

  Result<void> prepare(const PrepareInput& in) override { return ready(in.templ, in.camera); }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.image) return Error{Errc::invalid_data, "needs 'image'"};
    if (auto prepared = ready(in.templ, in.camera); !prepared) return prepared.error();
    const auto maps = registration_.run(*in.image, in.call.threads());
    if (!maps) return maps.error();
    const std::vector<SeenCell> seen = registration_.seen_cells(*maps, choice_.least_probability);
    if (auto enough = registration_.check_share(seen); !enough) return enough.error();
    const std::optional<Points3> nodes_m = nodes_of(*maps);
    if (!nodes_m) return no_result("the surface of the network is not in front of the camera");
    return build_shape(in, *nodes_m, seen);
  }

 private:
  Result<void> ready(const Template& templ, const Camera& camera) {
    auto prepared = registration_.prepare(choice_, templ, camera);
    if (!prepared || !registration_.file().is_for_any_texture()) return prepared;
    return about("network", Error{Errc::unsupported,
                                  choice_.path + ": a network for any texture has no vertices: use "
                                                 "matchers/dense_net"});
  }

  const inference::VertexGrid& grid() const { return registration_.file().vertices; }

  /// The nodes [columns * rows, 3] m, camera frame.
  std::optional<Points3> nodes_of(const NetworkMaps& maps) const {
    Points3 nodes_m(maps.vertices.cols, 3);
    for (int n = 0; n < maps.vertices.cols; ++n) {
      const double log_z = static_cast<double>(maps.vertices.at<float>(2, n));
      if (!(std::abs(log_z) <= kMostLogDepth)) return std::nullopt;
      const double z_m = std::exp(log_z);
      nodes_m.row(n) << z_m * static_cast<double>(maps.vertices.at<float>(0, n)),
          z_m * static_cast<double>(maps.vertices.at<float>(1, n)), z_m;
    }
    return nodes_m;
  }

  Result<Shape> build_shape(const SolverInput& in, const Points3& nodes_m,
                            const std::vector<SeenCell>& seen) const {
    const GridSurface surface(grid().columns, grid().rows);
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    Points3 vertices_m(rest_m.rows(), 3);
    for (Eigen::Index v = 0; v < rest_m.rows(); ++v) {
      const Eigen::Array2d uv = registration_.sheet().shares(rest_m(v, 0), rest_m(v, 1));
      vertices_m.row(v) = surface.weights(uv.x(), uv.y()) * nodes_m;
    }
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return no_result("the surface of the network reaches behind the camera");
    }
    const Agreement agreement = agreement_of(surface, nodes_m, seen);
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    shape.source = seen_vertices(vertices_m, seen);
    shape.confidence = agreement.share * registration_.confidence(seen, kExcess);
    if (shape.confidence < kSureShare) shape.state = static_cast<std::int32_t>(ShapeState::weak);
    shape.diag.set("visible_share", registration_.share_of(seen));
    shape.diag.set("heads_agree", agreement.share);
    shape.diag.set("heads_distance_px", agreement.distance_px);
    return shape;
  }

  std::optional<Eigen::Array2d> pixel_of(const Eigen::Vector3d& point_m) const {
    if (!(point_m.z() > 0.0)) return std::nullopt;
    const Camera& camera = registration_.camera();
    return Eigen::Array2d(camera.fx * point_m.x() / point_m.z() + camera.cx,
                          camera.fy * point_m.y() / point_m.z() + camera.cy);
  }

  /// A cell agrees if its point on the surface projects within one cell and two standard deviations
  /// of its centre. A standard deviation counts up to one cell, because a network without any
  /// knowledge would else agree with itself.
  Agreement agreement_of(const GridSurface& surface, const Points3& nodes_m,
                         const std::vector<SeenCell>& seen) const {
    const double cell_px = registration_.cell_px().mean();
    std::vector<double> distances_px;
    double agreeing = 0.0;
    for (const SeenCell& cell : seen) {
      const auto pixel = pixel_of(surface.at(nodes_m, cell.uv.x(), cell.uv.y()));
      const double off_px =
          pixel ? (*pixel - cell.image_px).matrix().norm() : std::numeric_limits<double>::max();
      const double reach_px = cell_px + 2.0 * inference::sigma_px(cell, 0.0, cell_px);
      agreeing += off_px <= reach_px ? 1.0 : 0.0;
      distances_px.push_back(off_px);
    }
    return {agreeing / static_cast<double>(seen.size()), median_in_place(distances_px)};
  }

  /// 1 for the vertices that project into a seen cell.
  Array<std::uint8_t> seen_vertices(const Points3& vertices_m,
                                    const std::vector<SeenCell>& seen) const {
    const inference::CellGrid& cells = registration_.file().cells;
    std::vector<std::uint8_t> is_seen(to_index(registration_.cell_count()), 0);
    for (const SeenCell& cell : seen) is_seen[to_index(cell.row * cells.columns + cell.column)] = 1;
    Array<std::uint8_t> source({vertices_m.rows()}, 0);
    for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
      const auto pixel = pixel_of(vertices_m.row(v).transpose());
      if (!pixel) continue;
      const auto place = registration_.map().to_network(pixel->x(), pixel->y());
      const double column = std::floor((place[0] + 0.5) / cells.step_px);
      const double row = std::floor((place[1] + 0.5) / cells.step_px);
      const bool inside = column >= 0.0 && row >= 0.0 && column < cells.columns && row < cells.rows;
      if (!inside) continue;
      source(v) =
          is_seen[to_index(static_cast<int>(row) * cells.columns + static_cast<int>(column))];
    }
    return source;
  }

  inference::NetworkChoice choice_;
  inference::Registration registration_;
};

}  // namespace
}  // namespace weft::mesh_net

WEFT_PLUGIN(weft::mesh_net::MeshNet, "solvers/mesh_net", "1.0.0",
            "Gives the shape that a network trained for the template sees in one image.")
