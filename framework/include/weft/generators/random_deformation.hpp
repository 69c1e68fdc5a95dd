// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/geometry/types.hpp>

namespace weft {

/// The random deformations of the synthetic experiments of Shetab-Bushehri et al. 2023, Section V.
/// Two cells of a fronto-parallel surface, in the middle row at the left and the right border, each
/// get a random rigid motion. Position-based dynamics (Mueller et al. 2007) moves the other
/// vertices. The paper does not give the ranges; these are our own.
struct RandomDeformationSpec {
  double distance_m = 0.65;               ///< [] m, initial distance of the surface
  Eigen::Vector3d turn_rad{0.7, 1, 0.5};  ///< [3] rad, uniform in +- this value about x, y and z
  double approach_m = 0.06;               ///< [] m, motion towards each other, uniform from 0
  double shift_y_m = 0.03;                ///< [] m, uniform in +- this value
  double shift_z_m = 0.08;                ///< [] m, uniform in +- this value
  int sweeps = 600;                       ///< [] sweeps over all edges, then over all bending pairs
  double bend_stiffness = 0.3;            ///< [] 0 to 1; the stiffness of the edges is 1
  double max_strain = 0.08;               ///< [] limit of the edge strain |l / l0 - 1|
  int max_draws = 10000;                  ///< [] maximum number of draws per shape
};

/// One draw; draw again if it is not accepted.
struct RandomDeformation {
  Points3 vertices_m;       ///< [V,3] m, camera frame
  double max_strain = 0.0;  ///< [] largest edge strain |l / l0 - 1|
  bool accepted =
      false;  ///< true if no edge exceeds the strain limit and the surface is in the image
};

/// Draws deformations of one surface.
class SheetDeformer {
 public:
  /// Makes a deformer of a flat surface [columns * rows,3] m with the faces of
  /// rectangular_grid_faces(), row by row. Fails on a grid below 4 x 2, where the two cells would
  /// share vertices, and on edges of length 0.
  static Result<SheetDeformer> create(int columns, int rows, const Points3View& rest_m,
                                      const RandomDeformationSpec& spec) {
    const auto faces = rectangular_grid_faces(columns, rows);
    if (!faces || columns < 4 || rest_m.rows() != Eigen::Index{columns} * rows) {
      return Error{Errc::invalid_value,
                   "a surface to be deformed needs at least 4 columns and 2 rows of vertices"};
    }
    const auto topology = build_topology(*faces, rest_m.rows());
    if (!topology) return topology.error();
    auto edges = distance_constraints(topology->edges, rest_m);
    if (!edges) return edges.error();
    auto bending = distance_constraints(topology->bending_pairs, rest_m);
    if (!bending) return bending.error();
    SheetDeformer deformer(spec);
    deformer.edges_ = *std::move(edges);
    deformer.bending_ = *std::move(bending);
    const Eigen::RowVector3d middle =
        0.5 * (rest_m.colwise().maxCoeff() + rest_m.colwise().minCoeff());
    deformer.start_m_ = rest_m.rowwise() + (Eigen::RowVector3d(0.0, 0.0, spec.distance_m) - middle);
    deformer.place_handles(columns, rows);
    return deformer;
  }

  /// Draws a deformation. A cancelled draw is not accepted.
  RandomDeformation draw(const Camera& camera, Rng& rng,
                         const std::function<bool()>& stopped = {}) const {
    RandomDeformation drawn{start_m_};
    move_cell(left_, 1.0, rng, drawn.vertices_m);
    move_cell(right_, -1.0, rng, drawn.vertices_m);
    for (int sweep = 0; sweep < spec_.sweeps; ++sweep) {
      if (stopped && stopped()) return drawn;
      relax(edges_, 1.0, drawn.vertices_m);
      relax(bending_, spec_.bend_stiffness, drawn.vertices_m);
    }
    drawn.max_strain = strain_statistics(edges_, drawn.vertices_m).max;
    drawn.accepted = drawn.max_strain <= spec_.max_strain;
    const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
    for (Eigen::Index v = 0; drawn.accepted && v < drawn.vertices_m.rows(); ++v) {
      const Eigen::Vector2d pixel = project(pinhole, drawn.vertices_m.row(v));
      drawn.accepted = camera.shows(pixel.x(), pixel.y());
    }
    return drawn;
  }

 private:
  using Cell = std::array<Eigen::Index, 4>;

  explicit SheetDeformer(const RandomDeformationSpec& spec) : spec_(spec) {}

  void place_handles(int columns, int rows) {
    const Eigen::Index row = Eigen::Index{(rows - 1) / 2} * columns;
    mobility_.assign(to_index(start_m_.rows()), 1.0);
    for (auto [cell, column] : {std::pair(&left_, 0), std::pair(&right_, columns - 2)}) {
      const Eigen::Index top_left = row + column;
      *cell = {top_left, top_left + 1, top_left + columns, top_left + columns + 1};
      for (const Eigen::Index v : *cell) mobility_[to_index(v)] = 0.0;
    }
  }

  /// Draws a rigid motion about the centre of a cell and applies it to the cell's vertices.
  void move_cell(const Cell& cell, double inwards, Rng& rng, Points3& vertices_m) const {
    Eigen::Vector3d turn, shift;
    for (int k = 0; k < 3; ++k) turn[k] = rng.uniform(-spec_.turn_rad[k], spec_.turn_rad[k]);
    shift.x() = inwards * rng.uniform(0.0, spec_.approach_m);
    shift.y() = rng.uniform(-spec_.shift_y_m, spec_.shift_y_m);
    shift.z() = rng.uniform(-spec_.shift_z_m, spec_.shift_z_m);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Index v : cell) middle += 0.25 * vertices_m.row(v).transpose();
    const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
    for (const Eigen::Index v : cell) {
      const Eigen::Vector3d arm = vertices_m.row(v).transpose() - middle;
      vertices_m.row(v) = (middle + rotation * arm + shift).transpose();
    }
  }

  /// Makes one Gauss-Seidel sweep; vertices with mobility 0 do not move.
  void relax(const std::vector<DistanceConstraint>& constraints, double stiffness,
             Points3& vertices_m) const {
    for (const DistanceConstraint& c : constraints) {
      const double wi = mobility_[to_index(c.i)];
      const double wj = mobility_[to_index(c.j)];
      const Eigen::RowVector3d difference = vertices_m.row(c.j) - vertices_m.row(c.i);
      const double length = difference.norm();
      if (wi + wj == 0.0 || length < 1e-12) continue;
      const Eigen::RowVector3d correction =
          stiffness * (length - c.rest_length_m) / (length * (wi + wj)) * difference;
      vertices_m.row(c.i) += wi * correction;
      vertices_m.row(c.j) -= wj * correction;
    }
  }

  RandomDeformationSpec spec_;
  std::vector<DistanceConstraint> edges_, bending_;
  std::vector<double> mobility_;
  Cell left_{}, right_{};
  Points3 start_m_;
};

}  // namespace weft
