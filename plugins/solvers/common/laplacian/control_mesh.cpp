// SPDX-License-Identifier: Apache-2.0
#include "common/laplacian/control_mesh.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/surface_distance.hpp>

#include "common/laplacian/affine_rows.hpp"

namespace weft::solvers {
namespace {

/// True if every face is reached from the first one across edges.
bool hangs_together(const MeshTopology& topology, Eigen::Index face_count) {
  std::vector<std::int32_t> part(to_index(face_count));
  for (std::size_t f = 0; f < part.size(); ++f) part[f] = static_cast<std::int32_t>(f);
  const auto root = [&](std::int32_t f) {
    while (part[to_index(f)] != f) f = part[to_index(f)] = part[to_index(part[to_index(f)])];
    return f;
  };
  Eigen::Index parts = face_count;
  for (Eigen::Index e = 0; e < topology.edge_faces.rows(); ++e) {
    worked_in_loop(e, 5);
    if (topology.edge_faces(e, 1) < 0) continue;
    const std::int32_t one = root(topology.edge_faces(e, 0)),
                       other = root(topology.edge_faces(e, 1));
    if (one == other) continue;
    part[to_index(one)] = other;
    --parts;
  }
  return parts == 1;
}

/// P for all points of A, and A P.
struct Elimination {
  Eigen::MatrixXd weights;  ///< [V+M,N]
  Eigen::MatrixXd bent;     ///< [R,N]
};

/// Splits A into the columns of the controls and the free ones, and eliminates these:
/// P_free = -(A_f^T A_f)^-1 A_f^T A_c.
Result<Elimination> eliminate(const Eigen::SparseMatrix<double>& rows,
                              const std::vector<std::int32_t>& controls) {
  const auto count = static_cast<Eigen::Index>(controls.size());
  std::vector<Eigen::Index> place(to_index(rows.cols()), -1);
  for (std::size_t k = 0; k < controls.size(); ++k) {
    place[to_index(controls[k])] = static_cast<Eigen::Index>(k);
  }
  std::vector<Eigen::Index> free;
  std::vector<Eigen::Triplet<double>> of_free;
  Eigen::MatrixXd of_controls = Eigen::MatrixXd::Zero(rows.rows(), count);
  for (Eigen::Index v = 0; v < rows.cols(); ++v) {
    worked_in_loop(v, 10);
    const Eigen::Index control = place[to_index(v)];
    if (control < 0) free.push_back(v);
    for (Eigen::SparseMatrix<double>::InnerIterator at(rows, v); at; ++at) {
      if (control >= 0) of_controls(at.row(), control) = at.value();
      if (control < 0) of_free.emplace_back(at.row(), free.size() - 1, at.value());
    }
  }
  Elimination result{Eigen::MatrixXd::Zero(rows.cols(), count), of_controls};
  for (Eigen::Index k = 0; k < count; ++k) result.weights(controls[to_index(k)], k) = 1.0;
  if (free.empty()) return result;
  Eigen::SparseMatrix<double> a(rows.rows(), static_cast<Eigen::Index>(free.size()));
  a.setFromTriplets(of_free.begin(), of_free.end());
  ask_to_go_on();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(a.transpose() * a);
  if (factor.info() != Eigen::Success) return no_result("singular");
  const Eigen::MatrixXd solved = factor.solve(-(a.transpose() * of_controls));
  for (std::size_t f = 0; f < free.size(); ++f) {
    result.weights.row(free[f]) = solved.row(static_cast<Eigen::Index>(f));
  }
  result.bent += a * solved;
  return result;
}

/// True if P reproduces the mesh at rest, and shifts of it, within a millionth of its size.
bool reproduces_rest(const ControlMesh& mesh) {
  const double size_m =
      (mesh.rest_m.colwise().maxCoeff() - mesh.rest_m.colwise().minCoeff()).norm();
  Points3 controls_m(mesh.control_count(), 3);
  for (Eigen::Index k = 0; k < controls_m.rows(); ++k) {
    controls_m.row(k) = mesh.rest_m.row(mesh.controls[to_index(k)]);
  }
  const Points3 off_m = mesh.weights * controls_m - mesh.rest_m;
  const Eigen::VectorXd sums = mesh.weights.rowwise().sum();
  // A mesh that counts as flat may have a relief, which is not reproduced.
  const double relief = mesh.flat ? 0.02 : 1e-6;
  return mesh.weights.allFinite() && off_m.cwiseAbs().maxCoeff() <= relief * size_m &&
         (sums.array() - 1.0).abs().maxCoeff() <= 1e-6;
}

/// The vertices that reach furthest along the four diagonals of the two long axes.
std::array<std::int32_t, 4> outermost(const Points3View& rest_m) {
  const Points3 centred = rest_m.rowwise() - rest_m.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred.transpose() * centred);
  const Eigen::VectorXd x = centred * axes.eigenvectors().col(2),
                        y = centred * axes.eigenvectors().col(1);
  const Eigen::VectorXd along = x / x.cwiseAbs().maxCoeff(), across = y / y.cwiseAbs().maxCoeff();
  std::array<std::int32_t, 4> furthest{};
  for (std::size_t k = 0; k < 4; ++k) {
    Eigen::Index v = 0;
    ((k % 2 == 0 ? 1.0 : -1.0) * along + (k < 2 ? 1.0 : -1.0) * across).maxCoeff(&v);
    furthest[k] = static_cast<std::int32_t>(v);
  }
  return furthest;
}

}  // namespace

std::vector<std::int32_t> farthest_vertices(const Points3View& rest_m, const EdgesView& edges,
                                            int count) {
  const IndexLists neighbours = vertex_neighbours(edges, rest_m.rows());
  std::vector<double> nearest_m(to_index(rest_m.rows()), std::numeric_limits<double>::infinity());
  std::vector<std::int32_t> chosen;
  const Eigen::Index all = std::min<Eigen::Index>(count, rest_m.rows());
  const auto choose = [&](std::int32_t next) {
    const PathStart start[] = {{next, 0.0}};
    const std::vector<double> from_next = path_lengths_m(rest_m, neighbours, start);
    for (std::size_t v = 0; v < nearest_m.size(); ++v) {
      nearest_m[v] = std::min(nearest_m[v], from_next[v]);
    }
    chosen.push_back(next);
  };
  for (const std::int32_t v : outermost(rest_m)) {
    const bool is_new = std::find(chosen.begin(), chosen.end(), v) == chosen.end();
    if (is_new && static_cast<Eigen::Index>(chosen.size()) < all) choose(v);
  }
  while (static_cast<Eigen::Index>(chosen.size()) < all) {
    const auto furthest = std::max_element(nearest_m.begin(), nearest_m.end());
    choose(static_cast<std::int32_t>(furthest - nearest_m.begin()));
  }
  return chosen;
}

Result<ControlMesh> make_control_mesh(const Template& templ, int control_count) {
  ControlMesh mesh;
  mesh.rest_m = templ.vertices_m.matrix<3>();
  mesh.faces = templ.faces.matrix<3>();
  if (auto valid = validate_mesh(mesh.rest_m, mesh.faces); !valid) return valid.error();
  const auto topology = build_topology(mesh.faces, mesh.rest_m.rows());
  if (!topology) return topology.error();
  if (!hangs_together(*topology, mesh.faces.rows())) {
    return Error{Errc::unsupported,
                 "the faces of the template are not connected by edges, so the depth of one part "
                 "does not determine that of another: use one part, or another solver"};
  }
  auto edges = distance_constraints(topology->edges, mesh.rest_m);
  if (!edges) return edges.error();
  mesh.edges = *std::move(edges);
  mesh.controls = farthest_vertices(mesh.rest_m, topology->edges, control_count);
  const AffineRows affine = affine_rows(mesh.rest_m, mesh.faces, *topology);
  mesh.flat = affine.flat;
  const auto eliminated = eliminate(affine.rows, mesh.controls);
  if (eliminated) mesh.weights = eliminated->weights.topRows(mesh.rest_m.rows());
  if (!eliminated || !reproduces_rest(mesh)) {
    return Error{Errc::unsupported, std::to_string(mesh.controls.size()) +
                                        " control vertices do not hold the template: raise "
                                        "'controls', or use another mesh"};
  }
  const double diagonal_m =
      (mesh.rest_m.colwise().maxCoeff() - mesh.rest_m.colwise().minCoeff()).norm();
  const double finer = diagonal_m / (12.0 * mean_edge_length(mesh.rest_m, topology->edges));
  mesh.bending = finer * finer * (eliminated->bent.transpose() * eliminated->bent);
  mesh.edge_weights.resize(static_cast<Eigen::Index>(mesh.edges.size()), mesh.control_count());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    mesh.edge_weights.row(static_cast<Eigen::Index>(e)) =
        mesh.weights.row(mesh.edges[e].i) - mesh.weights.row(mesh.edges[e].j);
  }
  return mesh;
}

}  // namespace weft::solvers
