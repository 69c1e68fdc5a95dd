// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <opencv2/core.hpp>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/sink.hpp>

#include "common/images/opencv_codecs.hpp"
#include "common/output_folder/output_folder.hpp"
#include "mesh_text.hpp"

namespace weft::meshes {
namespace {

namespace fs = std::filesystem;

enum class Format { ply, obj, both };

constexpr const char* kTextureName = "texture.png";
constexpr const char* kMaterialName = "texture.mtl";

/// One mesh file for each frame with a shape, in metres in the camera frame.
class Meshes final : public Sink {
 public:
  static constexpr About kAbout{.needs = "shape"};

  explicit Meshes(Params& p) {
    p.output_path("path", path_, "folder of the mesh files");
    p.choice("format", format_,
             {{"ply", Format::ply}, {"obj", Format::obj}, {"both", Format::both}},
             "file format of the meshes; both: one PLY and one OBJ file per frame");
    p.read("texture", texture_, "texture coordinates and the template's texture in OBJ files");
  }

  Result<void> prepare(const PrepareInput& in) override {
    faces_ = in.templ.faces.matrix<3>();
    vertex_count_ = in.templ.vertices_m.rows();
    texture_uv_.resize(0, 2);
    if (!texture_ || format_ == Format::ply) return {};
    const Array<std::uint8_t>& texture = in.templ.texture;
    const auto height = static_cast<double>(texture.dim(0));
    const auto width = static_cast<double>(texture.dim(1));
    // Texture coordinates of OBJ span the image from edge to edge and grow upwards.
    texture_uv_.resize(vertex_count_, 2);
    texture_uv_.col(0) = (in.templ.flat_px.matrix<2>().col(0).array() + 0.5) / width;
    texture_uv_.col(1) = 1.0 - (in.templ.flat_px.matrix<2>().col(1).array() + 0.5) / height;
    const cv::Mat pixels(static_cast<int>(texture.dim(0)), static_cast<int>(texture.dim(1)),
                         texture.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                         const_cast<std::uint8_t*>(texture.data()), to_index(texture.row_stride()));
    const std::vector<std::uint8_t> png = image_files::encode_by_opencv(".png", pixels);
    if (png.empty()) {
      return Error{Errc::unsupported, "the template's texture cannot be written as PNG"};
    }
    texture_png_.assign(png.begin(), png.end());
    return {};
  }

  Result<void> open(const Call&) override {
    if (auto made = output_folder::make(path_); !made) return made;
    if (texture_uv_.rows() == 0) return {};
    const fs::path folder(path_);
    if (auto done = write_whole(texture_png_, folder / kTextureName); !done) return done;
    return write_whole(to_mtl(kTextureName), folder / kMaterialName);
  }

  Result<void> write(const SinkInput& in) override {
    const Shape& shape = *in.shape;
    if (shape.vertices_m.rows() != vertex_count_) {
      return Error{Errc::invalid_data, "the shape has " + std::to_string(shape.vertices_m.rows()) +
                                           " vertices, the template " +
                                           std::to_string(vertex_count_)};
    }
    const auto vertices = shape.vertices_m.matrix<3>();
    if (!vertices.allFinite()) {
      return Error{Errc::invalid_data, "the shape has a vertex that is not finite"};
    }
    const Mesh mesh{vertices, faces_, description(shape, in.call.frame())};
    if (format_ != Format::obj) {
      auto done = write_now(to_ply(mesh), in.call.frame(), "ply");
      if (!done) return done;
    }
    if (format_ == Format::ply) return {};
    return write_now(to_obj(mesh, texture_uv_, kMaterialName), in.call.frame(), "obj");
  }

  Result<void> finish(const Call&) override { return output_folder::sync(path_); }

 private:
  /// Without waiting for the disk.
  Result<void> write_now(const std::string& text, std::uint64_t frame,
                         const char* extension) const {
    return write_whole(text, output_folder::file_of(path_, frame, extension), Durability::unsynced);
  }

  static std::string description(const Shape& shape, std::uint64_t frame) {
    return "frame " + std::to_string(frame) + "\nstate " + to_string(shape.shape_state()) +
           "\nage " + std::to_string(shape.age_frames) +
           " frames\nmetres, camera frame: x right, y down, z forward\n";
  }

  std::string path_ = "meshes";
  Format format_ = Format::ply;
  bool texture_ = true;

  Faces faces_;
  Eigen::Index vertex_count_ = 0;
  Points2 texture_uv_;       // [V,2], empty when no texture is written
  std::string texture_png_;  // the file's bytes
};

}  // namespace
}  // namespace weft::meshes

using weft::meshes::Meshes;
WEFT_PLUGIN(Meshes, "sinks/meshes", "1.0.0", "Writes one mesh file for each frame with a shape.")
