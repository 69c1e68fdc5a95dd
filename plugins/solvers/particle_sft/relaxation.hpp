// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/known_surface.hpp>
#include <weft/geometry/types.hpp>

#include "particles.hpp"

namespace weft::particle_sft {

/// A point of the surface, sum_k weights[k] X[vertices[k]], and the ray on which it is seen.
struct RayConstraint {
  std::array<std::int32_t, 3> vertices{};  ///< [3] a vertex of the mesh comes first and alone
  std::array<double, 3> weights{};         ///< [3] 1, 0, 0 for a vertex
  std::array<double, 3> ray{};             ///< [3] unit, camera frame
  double trust = 1.0;                      ///< [] share of the way to the ray, 0 to 1

  bool at_vertex() const { return weights[0] == 1.0 && weights[1] == 0.0 && weights[2] == 0.0; }
};

/// All that acts on the particles, which are the vertices of the mesh.
struct ParticleSystem {
  std::vector<DistanceConstraint> stretch;  ///< edges of the mesh, in a fixed order
  std::vector<DistanceConstraint> bending;  ///< opposite vertices of adjacent faces
  std::vector<RayConstraint> rays;
  std::vector<KnownSurfacePoint> spheres;
};

/// [V] 1 for the vertices that a ray or a known point holds, by themselves or through a face.
std::vector<std::uint8_t> observed_vertices(const std::vector<RayConstraint>& rays,
                                            const std::vector<KnownSurfacePoint>& known,
                                            Eigen::Index vertex_count);

struct RelaxationOptions {
  double damping = 0.008;          ///< [] share of the velocity lost in an iteration
  double stretch_stiffness = 1.0;  ///< [] 0 to 1
  double bend_stiffness = 1.0;     ///< [] 0 to 1
  int solver_iterations = 2;       ///< [] sweeps over the distances in an iteration
  int max_iterations = 2000;       ///< []
  double tolerance_m = 1e-6;       ///< [] m, rms step at which to stop
};

/// Why the iteration ended.
enum class Stop { converged = 0, stalled = 1, iterations = 2, cancelled = 3, not_finite = 4 };

struct RelaxationResult {
  Stop stop = Stop::iterations;
  int iterations = 0;        ///< []
  double last_step_m = 0.0;  ///< [] m, rms over the vertices
};

/// Particle-SfT (Ozgur and Bartoli, IJCV 123, 2017): position based dynamics between the rays and
/// the distances at rest. From rest, and with a time step of 1, each iteration
///   1. v <- (1 - damping) v,  Y <- X + v,
///   2. projects every seen vertex orthogonally onto its ray; of points inside faces each vertex
///      follows the weighted mean,
///   3. solver_iterations times: moves the ends of every edge, then of every bending pair, along
///      their difference by half of stiffness (length - rest length) each (Gauss-Seidel, in order),
///      then brings every known point back into its sphere, by the least motion of its vertices,
///   4. v <- Y - X,  X <- Y.
/// It ends when the rms step is below the tolerance, when the smallest step so far has not fallen
/// by 1 % for 200 iterations, or after max_iterations. Pairs closer than 1e-9 m are left alone.
class Relaxation {
 public:
  /// Moves `vertices_m` [V,3], which must be finite. The solver calls `cancelled` now and then. The
  /// result depends on the arguments alone.
  RelaxationResult run(const ParticleSystem& system, const RelaxationOptions& options,
                       Points3& vertices_m, const std::function<bool()>& cancelled);

 private:
  void load(const ParticleSystem& system);
  void pull_faces(Particle* y);
  double iterate(const ParticleSystem& system, const RelaxationOptions& options);

  std::vector<SpringQuad> stretch_, bending_;
  std::vector<RayQuad> at_vertices_;
  std::vector<RayConstraint> in_faces_;
  std::vector<double> shares_;                             ///< [V] weights of points in faces
  std::vector<Particle> place_, fresh_, velocity_, pull_;  ///< [V+1]
};

}  // namespace weft::particle_sft
