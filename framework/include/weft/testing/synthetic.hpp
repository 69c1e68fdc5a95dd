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

/// Small scenes with exact ground truth for tests. They depend only on the arguments and the Rng.
namespace weft::testing {

/// 640x480, focal length 820 px, principal point at the centre of the image (319.5, 239.5).
Camera make_camera();

inline Pinhole pinhole(const Camera& camera) {
  return {camera.fx, camera.fy, camera.cx, camera.cy};
}

/// A rectangular surface with square cells; `columns` and `rows` are numbers of vertices.
struct SheetSpec {
  int columns = 10;         ///< [] vertices along the width
  int rows = 6;             ///< [] vertices along the height
  double width_m = 0.297;   ///< [] m, width of the surface
  double height_m = 0.178;  ///< [] m, height of the surface
  int width_px = 960;       ///< [] px of the texture, width
  int height_px = 575;      ///< [] px of the texture, height
};

/// The flat template: vertex (i,j) at u = i * width_px / (columns - 1) - 0.5, v likewise; in m,
/// pitch * (u, v, 0). The texture is grey level 128, the mask is 1 and `revision` is 0.
Template make_template(const SheetSpec& spec = {});

/// Pose of the surface's centre; rotations about z, then y, then x.
struct PoseSpec {
  double distance_m = 0.65;  ///< [] m, distance from the camera
  double x_m = 0.0;          ///< [] m, x in the camera frame
  double y_m = 0.0;          ///< [] m, y in the camera frame
  double tilt_x_rad = 0.0;   ///< [] rad, rotation about x
  double tilt_y_rad = 0.0;   ///< [] rad, rotation about y
  double roll_rad = 0.0;     ///< [] rad, rotation about z
};

/// camera_from_template of a flat surface in this pose.
Eigen::Isometry3d make_pose(const SheetSpec& sheet, const PoseSpec& pose);

/// The bent surface in this pose. Throws std::invalid_argument for an illegal bend.
DevelopableSheet make_bent_sheet(const SheetSpec& sheet, const SheetBend& bend,
                                 const PoseSpec& pose = {});

/// A circular cylinder; a negative radius turns the hollow side to the camera.
DevelopableSheet make_cylinder(const SheetSpec& sheet, double radius_m, double ruling_angle_rad,
                               const PoseSpec& pose = {});

/// The template's vertices on the bent surface, [V,3] m, camera frame.
Points3 bent_vertices(const Template& templ, const DevelopableSheet& sheet);

/// Returns whether all points [N,3] m, camera frame, project into the image.
bool all_in_image(const Camera& camera, const Points3View& points_m);

/// Settings for randomly generated matches.
struct MatchSpec {
  int count = 200;                 ///< [] number of matches
  double correct_rate = 1.0;       ///< [] the first round((1 - rate) * count) matches are outliers
  double noise_px = 0.0;           ///< [] px, standard deviation of inliers along u and v
  double label_distance_px = 2.0;  ///< [] px, maximum distance of an inlier from its true image
};

/// Matches with ground truth.
struct LabelledMatches {
  Correspondences matches;            ///< matches with face and barycentrics, all kept
  Points2 true_px;                    ///< [N,2] px, true image of each match
  std::vector<std::uint8_t> correct;  ///< [N] 1 within the label distance of the true image, else 0
};

/// Draws template points uniformly over the mesh, moves them with the deformed mesh [V,3] m
/// (barycentric transfer in 3D) and projects them. Outliers are uniform in the image. Ratio and
/// distance are absent.
LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const Points3View& vertices_m, const MatchSpec& spec, Rng& rng);

/// The same with ground truth from the smooth surface instead of its mesh.
LabelledMatches draw_matches(const Template& templ, const Camera& camera,
                             const DevelopableSheet& sheet, const MatchSpec& spec, Rng& rng);

}  // namespace weft::testing
