// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {
namespace {

/// The value of a Result that only a mistake in a test makes fail.
template <class T>
T value_or_throw(Result<T> result) {
  if (!result) throw std::invalid_argument(result.error().message);
  return *std::move(result);
}

Eigen::Vector2d sheet_centre_m(const SheetSpec& sheet) {
  const double pitch_u = sheet.width_m / sheet.width_px, pitch_v = sheet.height_m / sheet.height_px;
  return {0.5 * (sheet.width_m - pitch_u), 0.5 * (sheet.height_m - pitch_v)};
}

Eigen::Matrix3d turn_zyx(double x_rad, double y_rad, double z_rad) {
  return (Eigen::AngleAxisd(z_rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(y_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Isometry3d flat_pose(const Eigen::Vector2d& centre_m, const Eigen::Matrix3d& rotation,
                            const Eigen::Vector3d& position_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = position_m - rotation * Eigen::Vector3d(centre_m.x(), centre_m.y(), 0.0);
  return pose;
}

bool in_image(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() >= -0.5 && pixel.x() <= static_cast<double>(camera.width_px) - 0.5 &&
         pixel.y() >= -0.5 && pixel.y() <= static_cast<double>(camera.height_px) - 0.5;
}

using TruePlace = std::function<Eigen::Vector3d(const Eigen::Vector2d&, const FaceLocation&)>;

/// Draws the template points: fills template_px, face, barycentrics and true_px.
void draw_points(const Template& templ, const Camera& camera, const TruePlace& true_place, Rng& rng,
                 LabelledMatches& drawn) {
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const auto locator = value_or_throw(FaceLocator::create(flat_px, templ.faces.matrix<3>()));
  const Eigen::Vector2d low = flat_px.colwise().minCoeff(), high = flat_px.colwise().maxCoeff();
  for (Eigen::Index i = 0; i < drawn.true_px.rows(); ++i) {
    FaceLocation location;
    Eigen::Vector2d point;
    do {
      point.x() = rng.uniform(low.x(), high.x());
      point.y() = rng.uniform(low.y(), high.y());
      location = locator.locate(point);
    } while (!location.inside);
    drawn.matches.template_px.matrix<2>().row(i) = point;
    drawn.matches.face(i) = location.face;
    drawn.matches.barycentrics.matrix<3>().row(i) = location.weights;
    drawn.true_px.row(i) = project(pinhole(camera), true_place(point, location));
  }
}

LabelledMatches draw_with(const Template& templ, const Camera& camera, const TruePlace& true_place,
                          const MatchSpec& spec, Rng& rng) {
  const Eigen::Index n = spec.count;
  const std::int64_t mismatches = std::lround((1.0 - spec.correct_rate) * spec.count);
  LabelledMatches drawn{{}, Points2(n, 2), {}};
  drawn.matches.template_px = Array<double>({n, 2});
  drawn.matches.image_px = Array<double>({n, 2});
  drawn.matches.face = Array<std::int32_t>({n});
  drawn.matches.barycentrics = Array<double>({n, 3});
  drawn.matches.kept = Array<std::uint8_t>({n});
  drawn.matches.score = Array<double>({n});
  std::fill_n(drawn.matches.kept.data(), n, std::uint8_t{1});
  std::fill_n(drawn.matches.score.data(), n, 1.0);
  draw_points(templ, camera, true_place, rng, drawn);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::RowVector2d pixel = drawn.true_px.row(i);
    if (i < mismatches) {
      pixel.x() = rng.uniform(-0.5, static_cast<double>(camera.width_px) - 0.5);
      pixel.y() = rng.uniform(-0.5, static_cast<double>(camera.height_px) - 0.5);
    } else {
      pixel.x() += spec.noise_px * rng.normal();
      pixel.y() += spec.noise_px * rng.normal();
    }
    drawn.matches.image_px.matrix<2>().row(i) = pixel;
    const double error_px = (pixel - drawn.true_px.row(i)).norm();
    drawn.correct.push_back(error_px < spec.label_distance_px ? 1 : 0);
  }
  return drawn;
}

/// The four vertices of the cell in column `column` of cells and in the middle row.
std::array<Eigen::Index, 4> handle_cell(const SheetSpec& sheet, int column) {
  const int row = (sheet.rows - 1) / 2;
  const Eigen::Index top_left = Eigen::Index{row} * sheet.columns + column;
  return {top_left, top_left + 1, top_left + sheet.columns, top_left + sheet.columns + 1};
}

/// Draws a rigid motion about the middle of a cell and applies it to the cell's vertices.
void move_cell(const std::array<Eigen::Index, 4>& cell, double inwards,
               const RandomDeformationSpec& spec, Rng& rng, Points3& vertices_m) {
  Eigen::Vector3d turn;
  for (int k = 0; k < 3; ++k) turn[k] = rng.uniform(-spec.turn_rad[k], spec.turn_rad[k]);
  Eigen::Vector3d shift;
  shift.x() = inwards * rng.uniform(0.0, spec.approach_m);
  shift.y() = rng.uniform(-spec.shift_y_m, spec.shift_y_m);
  shift.z() = rng.uniform(-spec.shift_z_m, spec.shift_z_m);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Index v : cell) middle += 0.25 * vertices_m.row(v).transpose();
  const Eigen::Matrix3d rotation = turn_zyx(turn.x(), turn.y(), turn.z());
  for (const Eigen::Index v : cell) {
    const Eigen::Vector3d arm = vertices_m.row(v).transpose() - middle;
    vertices_m.row(v) = (middle + rotation * arm + shift).transpose();
  }
}

/// One Gauss-Seidel sweep of position based dynamics; vertices with mobility 0 stay.
void relax(const std::vector<DistanceConstraint>& constraints, double stiffness,
           const std::vector<double>& mobility, Points3& vertices_m) {
  for (const DistanceConstraint& c : constraints) {
    const double wi = mobility[static_cast<std::size_t>(c.i)];
    const double wj = mobility[static_cast<std::size_t>(c.j)];
    const Eigen::RowVector3d difference = vertices_m.row(c.j) - vertices_m.row(c.i);
    const double length = difference.norm();
    if (wi + wj == 0.0 || length < 1e-12) continue;
    const Eigen::RowVector3d correction =
        stiffness * (length - c.rest_length_m) / (length * (wi + wj)) * difference;
    vertices_m.row(c.i) += wi * correction;
    vertices_m.row(c.j) -= wj * correction;
  }
}

}  // namespace

Camera make_camera() { return {820.0, 820.0, 319.5, 239.5, 640, 480}; }

Template make_template(const SheetSpec& spec) {
  Template templ;
  const Eigen::Vector2d pitch(spec.width_m / spec.width_px, spec.height_m / spec.height_px);
  const Eigen::Index vertices = Eigen::Index{spec.columns} * spec.rows;
  Points2 flat_px(vertices, 2);
  Points3 vertices_m = Points3::Zero(vertices, 3);
  for (int j = 0; j < spec.rows; ++j) {
    for (int i = 0; i < spec.columns; ++i) {
      const Eigen::Index v = Eigen::Index{j} * spec.columns + i;
      flat_px(v, 0) = static_cast<double>(i) * spec.width_px / (spec.columns - 1) - 0.5;
      flat_px(v, 1) = static_cast<double>(j) * spec.height_px / (spec.rows - 1) - 0.5;
      vertices_m.row(v).head<2>() = flat_px.row(v).cwiseProduct(pitch.transpose());
    }
  }
  templ.vertices_m = make_array<double>(vertices_m);
  templ.flat_px = make_array<double>(flat_px);
  templ.faces =
      make_array<std::int32_t>(value_or_throw(rectangular_grid_faces(spec.columns, spec.rows)));
  templ.m_per_px = make_array<double>(pitch);
  templ.texture = Array<std::uint8_t>({spec.height_px, spec.width_px});
  templ.mask = Array<std::uint8_t>({spec.height_px, spec.width_px});
  std::fill_n(templ.texture.data(), templ.texture.size(), std::uint8_t{128});
  std::fill_n(templ.mask.data(), templ.mask.size(), std::uint8_t{1});
  return templ;
}

Eigen::Isometry3d make_pose(const SheetSpec& sheet, const PoseSpec& pose) {
  return flat_pose(sheet_centre_m(sheet), turn_zyx(pose.tilt_x_rad, pose.tilt_y_rad, pose.roll_rad),
                   {pose.x_m, pose.y_m, pose.distance_m});
}

DevelopableSheet make_bent_sheet(const SheetSpec& sheet, const SheetBend& bend,
                                 const PoseSpec& pose) {
  const double reach_m = 0.5 * std::hypot(sheet.width_m, sheet.height_m);
  return value_or_throw(
      DevelopableSheet::create(sheet_centre_m(sheet), reach_m, bend, make_pose(sheet, pose)));
}

DevelopableSheet make_cylinder(const SheetSpec& sheet, double radius_m, double ruling_angle_rad,
                               const PoseSpec& pose) {
  return make_bent_sheet(sheet, {ruling_angle_rad, 1.0 / radius_m, {}}, pose);
}

Points3 bent_vertices(const Template& templ, const DevelopableSheet& sheet) {
  Points3 vertices_m = templ.vertices_m.matrix<3>();
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    vertices_m.row(v) = sheet.at(vertices_m(v, 0), vertices_m(v, 1)).transpose();
  }
  return vertices_m;
}

bool all_in_image(const Camera& camera, const Points3View& points_m) {
  for (Eigen::Index i = 0; i < points_m.rows(); ++i) {
    if (!in_image(camera, project(pinhole(camera), points_m.row(i)))) return false;
  }
  return true;
}

LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const Points3View& vertices_m, const MatchSpec& spec, Rng& rng) {
  const Faces faces = templ.faces.matrix<3>();
  const auto on_mesh = [&](const Eigen::Vector2d&, const FaceLocation& location) {
    return Eigen::Vector3d(interpolate(vertices_m, faces, location.face, location.weights));
  };
  return draw_with(templ, camera, on_mesh, spec, rng);
}

LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const DevelopableSheet& sheet, const MatchSpec& spec, Rng& rng) {
  const Eigen::Vector2d pitch = templ.m_per_px.matrix<1>();
  const auto on_sheet = [&](const Eigen::Vector2d& px, const FaceLocation&) {
    return sheet.at(pitch.x() * px.x(), pitch.y() * px.y());
  };
  return draw_with(templ, camera, on_sheet, spec, rng);
}

Result<RandomDeformation> draw_deformation(const SheetSpec& sheet, const Camera& camera, Rng& rng,
                                           const RandomDeformationSpec& spec) {
  const Template templ = make_template(sheet);
  const Faces faces = templ.faces.matrix<3>();
  const Points3 rest_m = templ.vertices_m.matrix<3>();
  const MeshTopology topology = value_or_throw(build_topology(faces, rest_m.rows()));
  const auto edges = value_or_throw(distance_constraints(topology.edges, rest_m));
  const auto bending = value_or_throw(distance_constraints(topology.bending_pairs, rest_m));
  const auto left = handle_cell(sheet, 0), right = handle_cell(sheet, sheet.columns - 2);
  std::vector<double> mobility(static_cast<std::size_t>(rest_m.rows()), 1.0);
  for (const Eigen::Index v : left) mobility[static_cast<std::size_t>(v)] = 0.0;
  for (const Eigen::Index v : right) mobility[static_cast<std::size_t>(v)] = 0.0;
  PoseSpec pose;
  pose.distance_m = spec.distance_m;
  const Points3 start_m = rest_m.rowwise() + make_pose(sheet, pose).translation().transpose();
  for (int draw = 1; draw <= spec.max_draws; ++draw) {
    RandomDeformation drawn{start_m, 0.0, draw};
    move_cell(left, 1.0, spec, rng, drawn.vertices_m);
    move_cell(right, -1.0, spec, rng, drawn.vertices_m);
    for (int sweep = 0; sweep < spec.sweeps; ++sweep) {
      relax(edges, 1.0, mobility, drawn.vertices_m);
      relax(bending, spec.bend_stiffness, mobility, drawn.vertices_m);
    }
    drawn.max_strain = strain_statistics(edges, drawn.vertices_m).max;
    if (drawn.max_strain <= spec.max_strain && all_in_image(camera, drawn.vertices_m)) return drawn;
  }
  return no_result("no deformation within the limits in " + std::to_string(spec.max_draws) +
                   " draws");
}

}  // namespace weft::testing
