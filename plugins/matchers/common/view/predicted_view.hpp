// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

#include "common/view/picture.hpp"

namespace weft::view {

/// A part of the image at one level: its origin, its rendered pixels and their mask.
struct ViewLevel {
  int x0 = 0, y0 = 0;                 ///< [] px of this level, of the first pixel
  Picture grey{};                     ///< undefined where nothing is rendered
  std::vector<std::uint8_t> drawn{};  ///< [height * width] 1 where the texture is seen
  std::vector<std::int32_t> face{};   ///< [height * width] nearest one, -1: none; finest level only

  const std::uint8_t* drawn_row(int y) const {
    return drawn.data() + to_index(y) * to_index(grey.width);
  }
};

/// Grey levels at a lattice of places, row by row.
struct Samples {
  static constexpr int kColumns = 16, kRows = 14;
  alignas(64) std::array<float, kRows * kColumns> values;
};

/// Where the samples are taken, in px of the image at full size: `origin` and the steps from one
/// column, or row, to the next.
struct Lattice {
  Eigen::Vector2d origin_px, along_row_px, along_column_px;
};

/// The template's texture as the camera would see it on a shape, without light and noise. All of it
/// is rendered at the size of its finest level and below. Each face is rendered with perspective
/// from the halved copy of the texture that has about one texel a pixel. A depth buffer hides
/// surfaces behind, and a face seen from its back shows nothing. At finer levels pieces are
/// rendered on demand, as if the face there continued.
class PredictedView {
 public:
  /// Renders levels from `finest` on, with the faces seen at that one if `with_faces`.
  explicit PredictedView(int finest, bool with_faces = false)
      : finest_(finest), with_faces_(with_faces) {}

  int finest() const { return finest_; }

  /// Loads the data that are the same in all frames: keeps the texture's pyramid and the mesh. The
  /// texture has at least two pixels along each side.
  void load(const Template& templ);

  /// False where no texture falls on the image. `vertices_m` [V,3] m, camera frame.
  bool draw(const Camera& camera, const Points3View& vertices_m);

  /// Blurs the rendered pixels of all levels, as a lens out of focus does: with a normal kernel of
  /// this standard deviation in px of the image. Pixels where nothing is rendered do not count.
  void blur(double sigma_px);

  /// From the finest on.
  const ViewLevel& level(int k) const { return levels_[to_index(k)]; }

  /// True if all pixels within `radius_px` of the place, along both axes, are rendered, to the
  /// nearest pixel of the finest rendered level.
  bool is_drawn(const Eigen::Vector2d& place_px, double radius_px) const;

  /// The texture of a face at the places of a lattice, for pixels of a level.
  void sample(std::int32_t face, int level, const Lattice& lattice, Samples& samples) const;

  /// The place in px of the point with these weights in the face, by the last rendered shape. NaN
  /// where a corner is not in front of the camera.
  Eigen::Vector2d place_px(std::int32_t face, const Eigen::Vector3d& weights) const;
  /// d(x,y)/d(u,v) of a face, px/px; the mean over its perspective.
  Eigen::Matrix2d jacobian(std::int32_t face) const;
  /// The weights of the corners at the point of a face that is seen at a place of the image; the
  /// face is in front of the camera.
  Eigen::Vector3d weights_at(std::int32_t face, const Eigen::Vector2d& place_px) const;
  /// The homography from places of the image to texels, in px, of a face in front of the camera.
  Eigen::Matrix3d texel_map(std::int32_t face) const;

 private:
  /// A vertex before the camera: pixel, and what is linear in it once divided by depth.
  struct Vertex {
    double x, y, nearness;  ///< [px] [px] [1/m]
    bool is_in_front;
  };
  /// A quantity that is linear in the image: its value at (0,0) and its slopes.
  struct Linear {
    double at_origin = 0.0, along_x = 0.0, along_y = 0.0;
    double at(double x, double y) const { return at_origin + along_x * x + along_y * y; }
  };
  /// A face in a level of the image: the weights of its corners, 1/z, u/z and v/z.
  struct FaceMap {
    std::array<Linear, 3> weights{};
    Linear nearness{}, u{}, v{};       ///< u and v in px of `texture`
    const Picture* texture = nullptr;  ///< null where the face has no area, or is not in front
    double scale = 1.0;                ///< from `texture` to the template's
    bool shows_print = false;
    Eigen::Vector2d low, high;  ///< [px] its box
  };

  void project(const Camera& camera, const Points3View& vertices_m);
  bool open_window(const Camera& camera);
  FaceMap map_of(std::int32_t face, int level, const Eigen::Vector2d& origin_px) const;
  void halve_from_finest();
  void draw_face(std::int32_t face);
  void draw_row(const FaceMap& map, std::int32_t face, int y, int x_begin, int x_end);
  bool is_object(float u, float v, double scale) const;

  std::vector<Picture> textures_;  ///< each half the one before
  Points2 flat_px_;
  Faces faces_;
  Array<std::uint8_t> mask_;  ///< a copy; absent where the texture has no holes
  std::vector<Vertex> vertices_;
  std::vector<float> nearness_;            ///< [1/m] of the nearest rendered surface, by pixel
  std::array<ViewLevel, kLevels> levels_;  ///< from finest_ on
  int finest_;
  bool with_faces_;
};

}  // namespace weft::view
