// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/data/camera.hpp>

#include "common/scene/lit_mesh.hpp"
#include "common/scene/mip_texture.hpp"
#include "common/scene/ray_caster.hpp"

namespace weft::scene {

/// An object in front of the surface, with colours at its vertices.
struct Solid {
  TriangleMesh mesh;
  std::vector<Colour> colours;  ///< [V]
};

/// Paper that bears no print.
struct Paper {
  float back = 208.0F;            ///< [] grey level of the side without the texture
  std::optional<float> margin{};  ///< [] grey level around the texture; without it, the texture's
                                  ///< border continues
};

/// The image that the camera sees, and its ground truth.
struct View {
  Picture image;                         ///< [H,W] grey levels 0 to 255, without noise
  Array<float> coverage;                 ///< [H,W] 0 to 1, share of it that is no background
  std::vector<RayHit> hits;              ///< [H*W] at the pixel centres; mesh 0 is the surface
  Array<float> depth_m;                  ///< [H,W] m along the optical axis, 0 on the background
  Array<float> uv_px;                    ///< [H,W,2] px of the texture, NaN where it is not seen
  std::vector<std::uint8_t> is_visible;  ///< [V] 1 where the textured side is visible; only with
                                         ///< Scope::pixels_and_vertices
};

/// Renders a textured surface over a background as a pinhole camera sees it, by ray casting. Pixel
/// (i,j) is the mean over [i-1/2,i+1/2] x [j-1/2,j+1/2] of 3 x 3 samples. Inside the surface these
/// sample only the texture. They are rays where an outline, a fold or a solid crosses the pixel.
/// Texture coordinates and depths are exact for the mesh.
class SheetRenderer {
 public:
  /// `uv_px` [V,2] px of the texture and `faces`, counter-clockwise from its textured side, belong
  /// to all surfaces that will be rendered. `background` has the size of the image.
  static Result<SheetRenderer> create(const Camera& camera, MipTexture print, const Points2& uv_px,
                                      const Faces& faces, Picture background,
                                      const Paper& paper = {});

  const MipTexture& print() const { return print_; }

  /// The outputs that a frame needs: each vertex costs a ray.
  enum class Scope { pixels, pixels_and_vertices };

  /// The surface with the vertices [V,3] m in the camera frame, and a solid in front of it.
  View render(const Points3View& vertices_m, const Light& light,
              std::optional<Solid> solid = std::nullopt, Scope scope = Scope::pixels_and_vertices);
  /// The background alone.
  View render_nothing() const;

 private:
  struct Window {
    int x0, y0, x1, y1;
  };
  /// The scene of one frame.
  struct Scene {
    LitMesh sheet;
    std::optional<LitMesh> solid{};
    std::vector<Colour> solid_colours{};
    std::vector<float> light{};  ///< [H*W] on what is seen at the pixel centres
  };

  SheetRenderer(const Camera& camera, MipTexture print, const Points2& uv_px, const Faces& faces,
                Picture background, const Paper& paper, RayCaster caster);
  Window covered(const Scene& scene) const;
  void trace_centres(const Window& window, View& view) const;
  void fill_maps(Scene& scene, const Window& window, View& view) const;
  void draw(const Scene& scene, const Window& window, View& view) const;
  void find_visible(const Scene& scene, View& view) const;
  /// [H*W] pixels through which an outline, a fold or the border of a solid runs.
  std::vector<std::uint8_t> find_edges(const Scene& scene, const Window& window,
                                       const View& view) const;
  Colour inner_colour(const Scene& scene, const View& view, int x, int y) const;
  void draw_edge(const Scene& scene, std::span<const RayHit> hits, int x, int y, View& view) const;
  Colour sheet_colour(const LitMesh& sheet, std::int32_t face, double x, double y) const;
  Colour solid_colour(const Scene& scene, std::int32_t face, double x, double y) const;
  Colour print_colour(float u, float v, const MipTexture::Sampler& print) const;
  bool is_on_print(float u, float v) const;
  void forget_margins(const Window& window, View& view) const;
  Eigen::Vector3f ray(double x, double y) const;
  std::size_t index(int x, int y) const;

  Pinhole pinhole_;
  int width_, height_;
  MipTexture print_;
  Points2 uv_px_;
  Faces faces_;
  double cell_px_;  ///< longest side of a triangle on the texture
  Picture background_;
  Paper paper_;
  RayCaster caster_;
};

}  // namespace weft::scene
