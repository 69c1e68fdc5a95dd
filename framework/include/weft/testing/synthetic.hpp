// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/generators/developable.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

/// Small scenes with exact truth for tests: everything follows from the arguments and the Rng.
namespace weft::testing {

/// 640x480, focal length 820 px, principal point at the centre of the image (319.5, 239.5).
Camera make_camera();

inline Pinhole pinhole(const Camera& camera) {
  return {camera.fx, camera.fy, camera.cx, camera.cy};
}

/// A rectangular sheet with square cells; `columns` and `rows` count vertices.
struct SheetSpec {
  int columns = 10;
  int rows = 6;
  double width_m = 0.297;   ///< [] m
  double height_m = 0.178;  ///< [] m
  int width_px = 960;       ///< [] px of the texture
  int height_px = 575;      ///< [] px of the texture
};

/// The flat template: vertex (i,j) at u = i * width_px / (columns - 1) - 0.5, v alike, in metres
/// pitch * (u, v, 0). The texture is grey 128 throughout, the mask is 1. `revision` is 0.
Template make_template(const SheetSpec& spec = {});

/// Where the middle of the sheet is and how it is turned: about z, then y, then x.
struct PoseSpec {
  double distance_m = 0.65;  ///< [] m
  double x_m = 0.0;          ///< [] m, camera frame
  double y_m = 0.0;          ///< [] m, camera frame
  double tilt_x_rad = 0.0;   ///< [] rad
  double tilt_y_rad = 0.0;   ///< [] rad
  double roll_rad = 0.0;     ///< [] rad
};

/// camera_from_template of a flat sheet in this pose.
Eigen::Isometry3d make_pose(const SheetSpec& sheet, const PoseSpec& pose);

/// The sheet bent in this pose. Throws std::invalid_argument if the bend is not legal.
DevelopableSheet make_bent_sheet(const SheetSpec& sheet, const SheetBend& bend,
                                 const PoseSpec& pose = {});

/// A circular cylinder; a negative radius turns the hollow to the camera.
DevelopableSheet make_cylinder(const SheetSpec& sheet, double radius_m, double ruling_angle_rad,
                               const PoseSpec& pose = {});

/// The template's vertices on the bent sheet, [V,3] m, camera frame.
Points3 bent_vertices(const Template& templ, const DevelopableSheet& sheet);

/// Whether all points [N,3] (camera frame) project into the image.
bool all_in_image(const Camera& camera, const Points3View& points_m);

/// How matches are drawn.
struct MatchSpec {
  int count = 200;
  double correct_rate = 1.0;       ///< [] the first round((1 - rate) * count) are mismatches
  double noise_px = 0.0;           ///< [] px, sigma along u and v, of the correct ones
  double label_distance_px = 2.0;  ///< [] px, a match within this of its true place is correct
};

/// Matches of which the truth is known.
struct LabelledMatches {
  Correspondences matches;            ///< with face and barycentrics, all kept
  Points2 true_px;                    ///< [N,2] px, where the matches belong
  std::vector<std::uint8_t> correct;  ///< [N] 1 within the label distance of its true place
};

/// Template points uniform over the mesh, carried by the deformed mesh [V,3] m (barycentric
/// transfer in 3D) and projected; mismatches are uniform in the image. Ratio and distance are
/// absent.
LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const Points3View& vertices_m, const MatchSpec& spec, Rng& rng);

/// The same with truth from the smooth sheet instead of from its mesh.
LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const DevelopableSheet& sheet, const MatchSpec& spec, Rng& rng);

}  // namespace weft::testing
