// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>
#include <weft/core/statistics.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/sdk/solver.hpp>

#include "common/rigid/rigid_pose.hpp"
#include "common/seen/seen_points.hpp"
#include "random_bend.hpp"

namespace weft::initial_guess {
namespace {

constexpr std::size_t kFewestMatches = 6;

constexpr double kNoFront = 1e-3;  // mean normal over mean area

enum class Begin { rigid, frontal, previous };

/// The mesh [V,3] m, camera frame, rotated about its mean by the least angle after which its mean
/// normal is parallel to the optical axis. A mesh without a mean normal, such as a closed one,
/// stays.
Points3 without_tilt(const Points3View& vertices_m, const FacesView& faces) {
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0));
    const Eigen::Vector3d b = vertices_m.row(faces(f, 1)), c = vertices_m.row(faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    front += normal;
    area += normal.norm();
  }
  if (!(front.norm() > kNoFront * area)) return vertices_m;
  const double side = front.z() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d rotation =
      Eigen::Quaterniond::FromTwoVectors(front, side * Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::RowVector3d middle_m = vertices_m.colwise().mean();
  return ((vertices_m.rowwise() - middle_m) * rotation.transpose()).rowwise() + middle_m;
}

/// A shape that needs no theory of deformation, from which other solvers begin.
class InitialGuess final : public Solver {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Terzakis, Lourakis, A Consistently Fast and Globally Optimal Solution to the "
          "Perspective-n-Point Problem, ECCV (2020)",
      .needs = "correspondences",
      .reads = "previous.shape",
      .random = true};

  explicit InitialGuess(Params& p) {
    p.choice("shape", begin_,
             {{"rigid", Begin::rigid}, {"frontal", Begin::frontal}, {"previous", Begin::previous}},
             "initial shape; rigid: template at rest in the pose estimated from the matches; "
             "frontal: the same pose without tilt; previous: shape of the previous frame, rigid if "
             "there is none");
    p.read("bend_m", bend_m_, "m", {0.0, 10.0},
           "root mean square of a smooth random deformation along the normals, different in each "
           "frame; 0: none");
  }

  Result<Shape> solve(const SolverInput& in) override {
    if (!in.correspondences) return Error{Errc::invalid_data, "needs 'correspondences'"};
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    const auto faces = in.templ.faces.matrix<3>();
    if (auto valid = check_face_indices(faces, rest_m.rows()); !valid) return valid.error();
    const auto points = solvers::seen_points(*in.correspondences, in.templ, kFewestMatches);
    if (!points) return points.error();
    auto begun = begun_from(in, *points);
    if (!begun) return begun.error();
    Points3 vertices_m = *std::move(begun);
    if (bend_m_ > 0.0) {
      Rng rng = in.call.rng();
      bend_at_random(rest_m, faces, bend_m_, rng, vertices_m);
    }
    return build_shape(in, *points, vertices_m);
  }

 private:
  /// [V,3] m, camera frame, before it is bent.
  Result<Points3> begun_from(const SolverInput& in,
                             const std::vector<solvers::SeenPoint>& points) const {
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    if (begin_ == Begin::previous && in.previous_shape &&
        in.previous_shape->shape_state() != ShapeState::none &&
        in.previous_shape->vertices_m.rows() == rest_m.rows()) {
      return Points3(in.previous_shape->vertices_m.matrix<3>());
    }
    if (!std::isfinite(solvers::frontal_distance_m(points, in.camera, rest_m))) {
      return no_result("the matches coincide in the image");
    }
    const auto pose = solvers::rigid_pose(points, in.camera, rest_m);
    if (!pose) return no_result("no rigid pose explains the matches");
    const Points3 posed_m =
        (rest_m * pose->linear().transpose()).rowwise() + pose->translation().transpose();
    if (begin_ == Begin::frontal) return without_tilt(posed_m, in.templ.faces.matrix<3>());
    return posed_m;
  }

  static Result<Shape> build_shape(const SolverInput& in,
                                   const std::vector<solvers::SeenPoint>& points,
                                   const Points3& vertices_m) {
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return no_result("the surface reaches behind the camera");
    }
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m);
    const std::vector<std::uint8_t> seen = solvers::vertices_seen(points, vertices_m.rows());
    shape.source = Array<std::uint8_t>({vertices_m.rows()});
    std::copy(seen.begin(), seen.end(), shape.source.data());
    const ShapeEvidence evidence =
        shape_evidence(in.templ, in.camera, vertices_m, in.correspondences, {});
    const auto kept = static_cast<double>(std::max(evidence.kept, 1));
    shape.confidence = std::min(1.0, evidence.agreeing / 30.0) * (evidence.agreeing / kept) *
                       confidence_of_filters(in.correspondences);
    shape.diag.set("points", static_cast<double>(points.size()));
    shape.diag.set("residual_px",
                   median(solvers::reprojection_errors_px(points, in.camera, vertices_m)));
    return shape;
  }

  Begin begin_ = Begin::rigid;
  double bend_m_ = 0.0;
};

}  // namespace
}  // namespace weft::initial_guess

using weft::initial_guess::InitialGuess;
WEFT_PLUGIN(
    InitialGuess, "solvers/initial_guess", "1.0.0",
    "Gives a simple initial guess: template at rest, posed rigidly, frontal or randomly bent.")
