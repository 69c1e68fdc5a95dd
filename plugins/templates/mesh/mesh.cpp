// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/surface_size.hpp>
#include <weft/geometry/texture_metric.hpp>
#include <weft/sdk/template_builder.hpp>

#include "coincidence.hpp"
#include "common/images/texture_file.hpp"
#include "flattening.hpp"
#include "remeshing.hpp"
#include "surface.hpp"

namespace weft::mesh {
namespace {

/// Where texture coordinates come from.
enum class Coordinates { file, flattened };
/// The place of coordinate 0: the outer edge or the centre of the image's first texel.
enum class TexelOrigin { edge, centre };
/// The axis by which a mirrored mesh is turned back.
enum class Flip { none, u, v, both, space };

/// A surface of any shape from a mesh file, with its texture: flat, curved or closed. It is cut
/// where its texture is.
class MeshTemplate final : public TemplateBuilder {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Shetab-Bushehri et al., ROBUSfT, arXiv:2301.04037 (2023); Liu et al., A "
          "local/global approach to mesh parameterization, SGP 2008; Shewchuk, Delaunay "
          "refinement algorithms for triangular mesh generation, Computational Geometry 22 "
          "(2002)",
      .licence = "GPL-3.0-or-later"};  // CGAL's parameterization and meshes

  explicit MeshTemplate(Params& p) {
    p.input_path("mesh", mesh_path_, "mesh file of the object at rest, OBJ or PLY", Need::required);
    p.input_path("texture", texture_path_, "image of the object's surface", Need::required);
    p.read("unit_m", unit_m_, "m", {1e-9, 1e6},
           "length of one unit of the mesh file; 0.001: millimetres");
    p.choice("coordinates", coordinates_,
             {{"file", Coordinates::file}, {"flattened", Coordinates::flattened}},
             "source of the texture coordinates; file: the mesh file; flattened: the surface laid "
             "flat, which the texture covers from edge to edge");
    p.choice("texel_origin", texel_origin_,
             {{"edge", TexelOrigin::edge}, {"centre", TexelOrigin::centre}},
             "position of texture coordinate 0; edge: outer edge of the first texel; centre: "
             "centre of the first texel");
    p.choice("flip", flip_,
             {{"none", Flip::none},
              {"u", Flip::u},
              {"v", Flip::v},
              {"both", Flip::both},
              {"space", Flip::space}},
             "correction of a mirrored mesh; u: texture coordinates left to right; v: texture "
             "coordinates upside down; both: u and v; space: x axis");
    p.read("vertices", vertices_, "", {0, 250000},
           "approximate number of vertices after remeshing; 0: mesh of the file");
  }

  /// The surface is not flattened here, which may take long.
  void check(Mistakes& mistakes) const {
    mistakes.expect("texture", image_files::check_texture_file("texture", texture_path_));
    auto file = read_mesh_file(mesh_path_);
    if (!mistakes.expect("mesh", file)) return;
    if (const auto legal = check_coordinates(*file); !legal) {
      const bool asked = legal.error().code == Errc::invalid_value;
      mistakes.expect(asked ? "coordinates" : "mesh", legal);
    }
    const auto surface = weld(*file);
    if (!mistakes.expect("mesh", surface)) return;
    const Points3 vertices_m = unit_m_ * surface->vertices;
    if (mistakes.expect("unit_m", check_size(vertices_m))) {
      mistakes.doubt("unit_m", size_doubt(largest_side(vertices_m), "unit_m"));
    }
    for (const std::string& note : file->notes) mistakes.doubt("mesh", mesh_path_ + ": " + note);
  }

  Result<Template> build(const Call& call) override {
    auto texture = image_files::read_texture_file("texture", texture_path_);
    if (!texture) return texture.error();
    image_files::report_orientation(call, texture_path_, texture->orientation);
    auto file = read_mesh_file(mesh_path_);
    if (!file) return file.error();
    auto surface = weld(*file);
    if (!surface) return surface.error();
    Points3 vertices_m = unit_m_ * surface->vertices;
    if (flip_ == Flip::space) vertices_m.col(0) *= -1.0;
    if (auto legal = check_size(vertices_m); !legal) return legal.error();
    if (auto found = find_coordinates(*file, *surface); !found) return found.error();
    const Points2 flat_px = to_px(surface->texture, texture->pixels.size());
    if (auto done = orient(*file, flat_px, surface->faces); !done) return done.error();
    if (auto legal = check_overlap(*file, flat_px, surface->faces); !legal) {
      return with_notes(legal.error(), *file);
    }
    const auto m_per_px = texel_pitch(vertices_m, flat_px, surface->faces).m_per_px;
    TexturedMesh mesh{vertices_m, flat_px, std::move(surface->faces)};
    if (vertices_ > 0) {
      auto fewer = remeshed(mesh_path_, mesh, vertices_);
      if (!fewer) return fewer.error();
      mesh = *std::move(fewer);
    }
    keep_covered(mesh.flat_px, mesh.faces, texture->mask);
    Template templ = assemble(mesh, m_per_px);
    image_files::store(*texture, templ);
    const std::string note = note_of(surface->parts, mesh.vertices_m.rows());
    if (!note.empty()) file->notes.push_back(note);
    if (file->notes.empty()) return templ;
    return degenerate(std::move(templ), with_notes({Errc::no_result, mesh_path_}, *file).message);
  }

 private:
  static double largest_side(const Points3& vertices_m) {
    return (vertices_m.colwise().maxCoeff() - vertices_m.colwise().minCoeff()).maxCoeff();
  }

  /// The message with what is doubtful about the file behind it.
  static Error with_notes(Error error, const MeshFile& file) {
    const char* before = ": ";
    for (const std::string& note : file.notes) {
      error.message += std::exchange(before, "; ") + note;
    }
    return error;
  }

  Result<void> check_size(const Points3& vertices_m) const {
    constexpr double kLeast_m = 0.001, kMost_m = 100.0;
    const double size_m = largest_side(vertices_m);
    if (size_m >= kLeast_m && size_m <= kMost_m) return {};
    return Error{Errc::invalid_value,
                 mesh_path_ + ": the object would be " + std::to_string(size_m) +
                     " m large, legal is 0.001 to 100: give the file's unit as 'unit_m', 0.001 for "
                     "millimetres"};
  }

  Result<void> find_coordinates(const MeshFile& file, Surface& surface) const {
    if (auto legal = check_coordinates(file); !legal) return legal;
    if (coordinates_ == Coordinates::file) return {};
    auto found = flattened(file, surface);
    if (!found) return found.error();
    surface.texture = *std::move(found);
    return {};
  }

  Result<void> check_coordinates(const MeshFile& file) const {
    const bool has_own = file.faces.front().corners.front().texture >= 0;
    if (coordinates_ == Coordinates::flattened) {
      if (!has_own) return {};
      return Error{Errc::invalid_value,
                   file.path +
                       ": has texture coordinates: leave 'coordinates: flattened' out, or "
                       "export the mesh without them"};
    }
    if (!has_own) {
      return Error{Errc::invalid_data,
                   file.path +
                       ": has no texture coordinates: export it with them, or give 'coordinates: "
                       "flattened' to spread the image over the surface"};
    }
    return check_within(file);
  }

  /// Checks that coordinates are within the image, to a thousandth.
  static Result<void> check_within(const MeshFile& file) {
    constexpr double kSlack = 1e-3;
    for (const MeshFile::Face& face : file.faces) {
      for (const MeshFile::Corner& corner : face.corners) {
        const Eigen::Vector2d& uv = file.texture_uv[to_index(corner.texture)];
        if (uv.minCoeff() >= -kSlack && uv.maxCoeff() <= 1.0 + kSlack) continue;
        return file.mistake(face, "has the texture coordinates " + std::to_string(uv.x()) + " " +
                                      std::to_string(uv.y()) +
                                      ", outside the image (0 to 1): an image that repeats cannot "
                                      "be tracked; unfold the mesh into one image");
      }
    }
    return {};
  }

  Points2 to_px(const Points2& texture, cv::Size size) const {
    const double origin_px = texel_origin_ == TexelOrigin::edge ? -0.5 : 0.0;
    const bool in_u = flip_ == Flip::u || flip_ == Flip::both;
    const bool in_v = flip_ == Flip::v || flip_ == Flip::both;
    Eigen::ArrayXd along_u = texture.col(0), along_v = texture.col(1);
    if (in_u) along_u = 1.0 - along_u;
    if (in_v) along_v = 1.0 - along_v;
    Points2 flat_px(texture.rows(), 2);
    flat_px.col(0) = along_u * size.width + origin_px;
    flat_px.col(1) = (1.0 - along_v) * size.height + origin_px;
    return flat_px;
  }

  /// Only the part of the image that faces cover belongs to the object.
  static void keep_covered(const Points2& flat_px, const Faces& faces, cv::Mat& mask) {
    constexpr int kShift = 8;
    cv::Mat covered = cv::Mat::zeros(mask.size(), CV_8U);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      cv::Point corners[3];
      for (int k = 0; k < 3; ++k) {
        const Eigen::RowVector2d at = flat_px.row(faces(f, k)) * (1 << kShift);
        corners[k] = {static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))};
      }
      cv::fillConvexPoly(covered, corners, 3, cv::Scalar(1), cv::LINE_8, kShift);
    }
    cv::bitwise_and(mask, covered, mask);
  }

  static Template assemble(const TexturedMesh& mesh, const Eigen::Vector2d& m_per_px) {
    Template templ;
    templ.vertices_m = make_array<double>(mesh.vertices_m);
    templ.flat_px = make_array<double>(mesh.flat_px);
    templ.faces = make_array<std::int32_t>(mesh.faces);
    templ.m_per_px = make_array<double>(m_per_px);
    templ.welded_vertex = welded_vertices(mesh.vertices_m);
    return templ;
  }

  std::string note_of(int parts, Eigen::Index made) const {
    constexpr double kClose = 0.2;
    if (parts > 1) {
      return "the surface has " + std::to_string(parts) +
             " parts that do not touch; solvers use the largest";
    }
    if (vertices_ == 0 || std::abs(static_cast<double>(made) / vertices_ - 1.0) <= kClose)
      return {};
    return "meshed anew it has " + std::to_string(made) + " vertices instead of " +
           std::to_string(vertices_) + ": its pieces and borders in the texture need this number";
  }

  std::string mesh_path_, texture_path_;
  double unit_m_ = 1.0;
  Flip flip_ = Flip::none;
  int vertices_ = 0;
  Coordinates coordinates_ = Coordinates::file;
  TexelOrigin texel_origin_ = TexelOrigin::edge;
};

}  // namespace
}  // namespace weft::mesh

using weft::mesh::MeshTemplate;
WEFT_PLUGIN(MeshTemplate, "templates/mesh", "1.1.0",
            "Reads a surface of any shape from an OBJ or PLY file and its texture image.")
