// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/check_sightlines.hpp>
#include <weft/geometry/rigid_alignment.hpp>
#include <weft/sdk/solver.hpp>

namespace {

constexpr std::int64_t kFewest = 4;  ///< sightlines
constexpr double kSettled = 1e-12;   ///< largest change of a rotation that ends the rounds

/// Points of the template and the rays on which they are seen.
struct Seen {
  weft::Points3 rest_m;  ///< [N,3] m, template frame
  weft::Points3 ray;     ///< [N,3] unit, camera frame
};

/// The rotation and translation with the least sum of squared distances of the points from their
/// rays, by orthogonal iteration. The best translation of a rotation has a closed form. The next
/// rotation aligns the points with their nearest points on the rays.
weft::Result<weft::RigidAlignment> rigid_pose(const Seen& seen, int rounds) {
  // The initial pose faces the camera, with the rotation of the image.
  const weft::Points3 picture = (seen.ray.array().colwise() / seen.ray.col(2).array()).matrix();
  auto pose = weft::align_points(seen.rest_m, picture);
  if (!pose) return pose.error();
  std::vector<Eigen::Matrix3d> across;  // takes away what lies along a ray
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < seen.ray.rows(); ++i) {
    const Eigen::Vector3d ray = seen.ray.row(i).transpose();
    across.push_back(Eigen::Matrix3d::Identity() - ray * ray.transpose());
    sum += across.back();
  }
  const Eigen::Matrix3d inverse = sum.inverse();
  for (int round = 0; round < rounds; ++round) {
    weft::worked(10 * seen.ray.rows());
    const weft::Points3 turned_m = seen.rest_m * pose->rotation.transpose();
    Eigen::Vector3d off_m = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < turned_m.rows(); ++i) {
      off_m += across[weft::to_index(i)] * turned_m.row(i).transpose();
    }
    const Eigen::Vector3d place_m = -inverse * off_m;
    weft::Points3 on_ray_m = turned_m.rowwise() + place_m.transpose();
    for (Eigen::Index i = 0; i < on_ray_m.rows(); ++i) {
      on_ray_m.row(i) = on_ray_m.row(i).dot(seen.ray.row(i)) * seen.ray.row(i);
    }
    auto next = weft::align_points(seen.rest_m, on_ray_m);
    if (!next) return next.error();
    const double change = (next->rotation - pose->rotation).cwiseAbs().maxCoeff();
    pose->rotation = next->rotation;
    pose->translation = next->translation;
    if (change < kSettled) break;
  }
  return pose;
}

/// The template at rest, placed as a rigid body.
class MyPluginSolver final : public weft::Solver {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "paper: Lu, Hager and Mjolsness, Fast and globally convergent pose estimation from video "
          "images, IEEE PAMI 22(6), 2000",
      .needs = "sightlines"};

  explicit MyPluginSolver(weft::Params& p) {
    p.read("rounds", rounds_, "", {1, 100000}, "maximum number of iterations of the pose search");
  }

  weft::Result<weft::Shape> solve(const weft::SolverInput& in) override {
    if (!in.sightlines) return weft::Error{weft::Errc::invalid_data, "needs 'sightlines'"};
    const weft::Sightlines& lines = *in.sightlines;
    const auto rest_m = in.templ.vertices_m.matrix<3>();
    const auto faces = in.templ.faces.matrix<3>();
    if (auto fit = weft::check_sightlines(lines, rest_m.rows(), faces.rows()); !fit) {
      return fit.error();
    }
    std::vector<std::int64_t> used;
    weft::Array<std::uint8_t> source({rest_m.rows()}, 0);
    for (std::int64_t i = 0; i < lines.count(); ++i) {
      if (!(lines.weight(i) > 0.0 && lines.ray(i, 2) > 0.0)) continue;
      used.push_back(i);
      for (int k = 0; k < 3 && lines.vertex(i) < 0; ++k) source(faces(lines.face(i), k)) = 1;
      if (lines.vertex(i) >= 0) source(lines.vertex(i)) = 1;
    }
    if (std::ssize(used) < kFewest) {
      return weft::no_result(std::to_string(used.size()) + " sightlines count; at least " +
                             std::to_string(kFewest) + " are needed");
    }
    Seen seen{weft::Points3(std::ssize(used), 3), weft::Points3(std::ssize(used), 3)};
    Eigen::Index k = 0;
    for (const std::int64_t i : used) {
      seen.ray.row(k) = lines.ray.matrix<3>().row(i);
      const Eigen::Vector3d weights = lines.barycentrics.matrix<3>().row(i).transpose();
      seen.rest_m.row(k) =
          lines.vertex(i) >= 0
              ? Eigen::RowVector3d(rest_m.row(lines.vertex(i)))
              : Eigen::RowVector3d(
                    weft::interpolate(rest_m, faces, lines.face(i), weights).transpose());
      ++k;
    }
    const auto pose = rigid_pose(seen, rounds_);
    if (!pose) return pose.error();
    const weft::Points3 vertices_m = weft::transform_points(*pose, rest_m);
    if (!(vertices_m.allFinite() && vertices_m.col(2).minCoeff() > 0.0)) {
      return weft::no_result("the surface would reach behind the camera");
    }
    const weft::ShapeEvidence evidence =
        weft::shape_evidence(in.templ, in.camera, vertices_m, std::nullopt, in.sightlines);
    weft::Shape shape;
    shape.vertices_m = weft::make_array<double>(vertices_m);
    shape.source = std::move(source);
    shape.confidence = std::min(1.0, evidence.agreeing / static_cast<double>(evidence.needed)) *
                       evidence.agreeing / static_cast<double>(evidence.kept);
    shape.diag.set("rms_from_rays_m", rms_from_rays_m(seen, *pose));
    return shape;
  }

 private:
  static double rms_from_rays_m(const Seen& seen, const weft::RigidAlignment& pose) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < seen.ray.rows(); ++i) {
      const Eigen::Vector3d place_m = pose(seen.rest_m.row(i).transpose());
      const double off_m = weft::distance_to_ray_m(place_m, seen.ray.row(i).transpose());
      sum += off_m * off_m;
    }
    return std::sqrt(sum / static_cast<double>(seen.ray.rows()));
  }

  int rounds_ = 500;
};

}  // namespace

WEFT_PLUGIN(MyPluginSolver, "solvers/my_plugin", "1.0.0",
            "Fits the template at rest as a rigid body.")
