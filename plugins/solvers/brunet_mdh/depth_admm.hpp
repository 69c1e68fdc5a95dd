// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <functional>
#include <span>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/types.hpp>

namespace weft::brunet_mdh {

struct DepthOptions {
  double tolerance_m = 1e-5;   ///< [] m, rms violation of the constraints at which to stop
  int max_iterations = 5000;   ///< []
  double slack_penalty = 0.0;  ///< [] price of 1 m above a distance; 0: no slack
};

/// A point on a ray that is no further than this from a place in space.
struct DepthAnchor {
  int point = 0;             ///< []
  Eigen::Vector3d centre_m;  ///< [3] m, camera frame
  double reach_m = 0.0;      ///< [] m, positive
};

struct DepthResult {
  std::vector<double> depths_m;  ///< [n] m, along each ray
  std::vector<double> tensions;  ///< [e] multiplier of each distance, then of each anchor: depth
                                 ///< gained per m of it
  int iterations = 0;            ///< []
  bool converged = false;        ///< []
  bool cancelled = false;        ///< []
  double max_violation_m = 0.0;  ///< [] m, largest excess over a distance
};

/// The convex maximum-depth problem of n points on n rays v_i,
///   max sum mu_i   subject to   |mu_i v_i - mu_j v_j| <= d_ij   for all edges (i, j)
///                               |mu_i v_i - c_a| <= r_a         for all anchors a of points i,
/// by ADMM: with A mu the stacked differences, z their copies in the balls and y the scaled
/// multipliers,
///     mu <- (A'A + 1e-9 I)^-1 (A'(z - y) + 1/rho),   w = a A mu + (1 - a) z + y,
///     z <- w projected on the balls,   y <- w - z,   a = 1.6,
/// in units of the median distance; anchors are edges to points that stay where they are. With
/// slack, an excess s costs penalty * s and the projection becomes a shrinkage. Brunet, Hartley,
/// Bartoli, CVIU 125 (2014); Boyd et al. (2011).
class DepthAdmm {
 public:
  /// Analyses the graph; the edges must connect [0, count) and lengths be positive.
  void set_graph(std::span<const DistanceConstraint> edges, int count);

  /// Depths along `rays` [n,3]. The solver calls `cancelled` now and then. The result depends on
  /// the arguments and the graph alone.
  DepthResult solve(const Points3View& rays, const DepthOptions& options,
                    const std::function<bool()>& cancelled,
                    std::span<const DepthAnchor> anchors = {});

 private:
  struct Edge {
    int i, j;       ///< j from count_ on: the centre of an anchor
    double length;  ///< in units of unit_m_
  };
  struct Residuals {
    double primal2, dual2;
  };

  void load(const Points3View& rays, std::span<const DepthAnchor> anchors);
  void factorise();
  void start();
  void solve_depths(double rho);
  Residuals update_edges(double threshold);
  void rescale_multipliers(double factor);
  DepthResult finish(double rho) const;

  Eigen::Map<const Eigen::Vector3d> ray(int i) const;

  int count_ = 0;
  std::size_t graph_edges_ = 0;
  double unit_m_ = 1.0;
  std::vector<Edge> edges_;  ///< edges of the graph, then the anchors
  Eigen::SparseMatrix<double> normal_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  std::vector<double> rays_;   ///< 3 numbers a point; then the centres of the anchors
  std::vector<double> z_, y_;  ///< 3 numbers an edge
  std::vector<double> pull_;   ///< [n] A'(z - y); what follows belongs to anchors and is not read
  std::vector<double> anchor_pull_;  ///< [n] what the centres of anchors add to it
  std::vector<double> depths_;       ///< [n]; then 1 for each anchor
  std::vector<double> permuted_;     ///< [n] buffer
};

}  // namespace weft::brunet_mdh
