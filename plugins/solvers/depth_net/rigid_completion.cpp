// SPDX-License-Identifier: Apache-2.0
#include "rigid_completion.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::depth_net {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

// Weight of the tie to the draft, as a share of the mean stiffness of a vertex.
constexpr double kTie = 1e-9;

/// Weights [V] of the draft, in units of the stiffness of the edges.
Eigen::VectorXd draft_weights(const RestSheet& sheet, const Draft& draft, double rigidity_m) {
  double stiffness = 0.0;
  for (const RestEdge& edge : sheet.edges()) stiffness += 2.0 * edge.stiffness;
  const double tie = kTie * stiffness / static_cast<double>(sheet.vertex_count());
  return (rigidity_m * rigidity_m * draft.certainty).array() + tie;
}

Matrix normal_matrix(const RestSheet& sheet, const Eigen::VectorXd& weights) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < weights.size(); ++v) entries.emplace_back(v, v, weights(v));
  for (const RestEdge& edge : sheet.edges()) {
    entries.emplace_back(edge.from, edge.from, edge.stiffness);
    entries.emplace_back(edge.to, edge.to, edge.stiffness);
    entries.emplace_back(edge.from, edge.to, -edge.stiffness);
    entries.emplace_back(edge.to, edge.from, -edge.stiffness);
  }
  Matrix matrix(weights.size(), weights.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The edges at rest, turned by the mean of the frames at their ends.
void add_turned_edges(const RestSheet& sheet, const std::vector<Frame>& frames, Points3& right) {
  for (const RestEdge& edge : sheet.edges()) {
    const Frame both = frames[to_index(edge.from)] + frames[to_index(edge.to)];
    const Eigen::Vector3d turned = 0.5 * edge.stiffness * (both * edge.vector_m);
    right.row(edge.from) += turned.transpose();
    right.row(edge.to) -= turned.transpose();
  }
}

void fit_frames(const RestSheet& sheet, const Points3& vertices_m, std::vector<Frame>& frames) {
  std::vector<Frame> sums(frames.size(), Frame::Zero());
  for (const RestEdge& edge : sheet.edges()) {
    const Eigen::RowVector3d vector_m = vertices_m.row(edge.from) - vertices_m.row(edge.to);
    const Frame product = edge.stiffness * vector_m.transpose() * edge.vector_m.transpose();
    sums[to_index(edge.from)] += product;
    sums[to_index(edge.to)] += product;
  }
  for (std::size_t v = 0; v < frames.size(); ++v) {
    // Around a vertex without a unique rotation the last one is as good as any.
    if (const auto frame = nearest_frame(sums[v])) frames[v] = *frame;
  }
}

}  // namespace

Result<Points3> complete_rigidly(const RestSheet& sheet, const Draft& draft, double rigidity_m,
                                 int iterations) {
  const Eigen::VectorXd weights = draft_weights(sheet, draft, rigidity_m);
  const Eigen::SimplicialLDLT<Matrix> factor(normal_matrix(sheet, weights));
  if (factor.info() != Eigen::Success) {
    return no_result("the rigid completion has no unique solution");
  }
  const Points3 measured = weights.asDiagonal() * draft.vertices_m;
  std::vector<Frame> frames = draft.frames;
  Points3 vertices_m = draft.vertices_m;
  for (int i = 0; i < iterations; ++i) {
    worked(50 * sheet.vertex_count());
    Points3 right = measured;
    add_turned_edges(sheet, frames, right);
    vertices_m = factor.solve(right);
    fit_frames(sheet, vertices_m, frames);
  }
  return vertices_m;
}

}  // namespace weft::depth_net
