// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/generators/random_matches.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {
namespace {

/// The value of a Result that fails only through an error in a test.
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

template <class TruePlace>
LabelledMatches draw_with(const Template& templ, const Camera& camera, const TruePlace& true_place,
                          const MatchSpec& spec, Rng& rng) {
  const Points2 flat_px = templ.flat_px.matrix<2>();
  const auto locator = value_or_throw(FaceLocator::create(flat_px, templ.faces.matrix<3>()));
  auto [matches, true_px] = draw_random_matches(
      flat_px, locator, camera, true_place, {spec.count, spec.correct_rate, spec.noise_px}, rng);
  std::vector<std::uint8_t> correct;
  for (Eigen::Index i = 0; i < spec.count; ++i) {
    const double error_px = (matches.image_px.template matrix<2>().row(i) - true_px.row(i)).norm();
    correct.push_back(error_px < spec.label_distance_px ? 1 : 0);
  }
  return {std::move(matches), std::move(true_px), std::move(correct)};
}

}  // namespace

Camera make_camera() { return {820.0, 820.0, 319.5, 239.5, 640, 480}; }

Template make_template(const SheetSpec& spec) {
  Template templ;
  const Eigen::Vector2d pitch(spec.width_m / spec.width_px, spec.height_m / spec.height_px);
  const Points2 flat_px =
      rectangular_grid_px(spec.columns, spec.rows, spec.width_px, spec.height_px);
  Points3 vertices_m = Points3::Zero(flat_px.rows(), 3);
  vertices_m.leftCols<2>() = flat_px * pitch.asDiagonal();
  templ.vertices_m = make_array<double>(vertices_m);
  templ.flat_px = make_array<double>(flat_px);
  templ.faces =
      make_array<std::int32_t>(value_or_throw(rectangular_grid_faces(spec.columns, spec.rows)));
  templ.m_per_px = make_array<double>(pitch);
  templ.texture = Array<std::uint8_t>({spec.height_px, spec.width_px}, 0);
  templ.mask = Array<std::uint8_t>({spec.height_px, spec.width_px}, 0);
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
    const Eigen::Vector2d pixel = project(pinhole(camera), points_m.row(i));
    if (!camera.shows(pixel.x(), pixel.y())) return false;
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

}  // namespace weft::testing
