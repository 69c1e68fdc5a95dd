// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <weft/core/index.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/sink.hpp>

#include "common/images/opencv_codecs.hpp"
#include "gltf.hpp"

namespace weft::animation {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1}
                                   << 30U;   ///< size of a file; the format ends at 4 GiB
constexpr std::size_t kVertexBytes = 24;     ///< position and normal
constexpr std::size_t kShareUnwritten = 16;  ///< 1/16 of the shapes

/// One textured mesh that moves: a glTF file that 3D programs and browsers play.
class Animation final : public Sink {
 public:
  static constexpr About kAbout{.needs = "", .reads = "shape"};

  explicit Animation(Params& p) {
    p.output_path("path", path_, "path of the animation, .glb");
    p.read("fps", scene_.fps, "1/s", {0.1, 1000.0}, "frame rate of the animation");
    p.read("frames_per_file", frames_per_file_, "", {2, 10'000},
           "number of shapes in a file; a longer run continues in a further file");
  }

  void check(Mistakes& mistakes) const {
    if (fs::path(path_).extension() == ".glb") return;
    mistakes.expect("path",
                    Result<void>(Error{Errc::invalid_value,
                                       "'path' must end in .glb, the binary form of glTF"}));
  }

  Result<void> prepare(const PrepareInput& in) override {
    const Array<std::uint8_t>& texture = in.templ.texture;
    const cv::Mat pixels(static_cast<int>(texture.dim(0)), static_cast<int>(texture.dim(1)),
                         texture.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                         const_cast<std::uint8_t*>(texture.data()), to_index(texture.row_stride()));
    scene_.texture_png = image_files::encode_by_opencv(".png", pixels);
    if (scene_.texture_png.empty()) {
      return Error{Errc::unsupported, "the template's texture cannot be written as PNG"};
    }
    scene_.faces = in.templ.faces.matrix<3>();
    scene_.camera = in.camera;
    scene_.texture_uv.clear();
    const auto flat_px = in.templ.flat_px.matrix<2>();
    for (Eigen::Index v = 0; v < flat_px.rows(); ++v) {
      scene_.texture_uv.push_back(static_cast<float>((flat_px(v, 0) + 0.5) / pixels.cols));
      scene_.texture_uv.push_back(static_cast<float>((flat_px(v, 1) + 0.5) / pixels.rows));
    }
    return {};
  }

  Result<void> open(const Call&) override {
    std::error_code ignored;
    if (const fs::path folder = fs::path(path_).parent_path(); !folder.empty()) {
      fs::create_directories(folder, ignored);  // writing reports why it cannot
    }
    file_ = path_;
    frames_.clear();
    shapes_ = unwritten_ = files_ = 0;
    return {};
  }

  Result<void> write(const SinkInput& in) override {
    auto frame = frame_of(in);
    if (!frame) return frame.error();
    if (is_full()) {
      if (auto done = write_file(Durability::unsynced); !done) return done;
      begin_next_file();
    }
    const bool has_shape = !frame->vertices_m.empty();
    // The first of several frames without a shape is enough.
    if (has_shape || frames_.empty() || !frames_.back().vertices_m.empty()) {
      frames_.push_back(*std::move(frame));
    }
    if (!has_shape) return {};
    ++shapes_;
    ++unwritten_;
    // A file is written anew as it grows, so that what a killed run leaves can be opened.
    if (unwritten_ * kShareUnwritten < shapes_) return {};
    return write_file(Durability::unsynced);
  }

  Result<void> finish(const Call&) override { return write_file(Durability::synced); }

 private:
  Result<Frame> frame_of(const SinkInput& in) const {
    Frame frame{in.call.frame(), "", {}, {}};
    if (!in.shape) return frame;
    const auto vertices = in.shape->vertices_m.matrix<3>();
    const std::size_t expected = scene_.texture_uv.size() / 2;
    if (to_index(vertices.rows()) != expected) {
      return Error{Errc::invalid_data, "the shape has " + std::to_string(vertices.rows()) +
                                           " vertices, the template " + std::to_string(expected)};
    }
    if (!vertices.allFinite()) {
      return Error{Errc::invalid_data, "the shape has a vertex that is not finite"};
    }
    char number[24];
    std::snprintf(number, sizeof number, "%06llu", static_cast<unsigned long long>(frame.number));
    frame.name = std::string(number) + " " + to_string(in.shape->shape_state());
    frame.vertices_m.reserve(3 * expected);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
      for (int k = 0; k < 3; ++k) frame.vertices_m.push_back(static_cast<float>(vertices(v, k)));
    }
    frame.normals = normals_of(frame.vertices_m, scene_.faces);
    return frame;
  }

  bool is_full() const {
    const std::size_t shape_bytes = kVertexBytes * scene_.texture_uv.size() / 2;
    return shapes_ == static_cast<std::size_t>(frames_per_file_) ||
           (shapes_ + 1) * shape_bytes > kMostBytes;
  }

  /// animation_2.glb, or the first such name that is free.
  void begin_next_file() {
    const fs::path first(path_);
    std::error_code ignored;
    do {
      ++files_;
      file_ = (first.parent_path() /
               (first.stem().string() + "_" + std::to_string(files_ + 1) + ".glb"))
                  .string();
    } while (fs::exists(file_, ignored));
    frames_.clear();
    shapes_ = unwritten_ = 0;
  }

  /// A run without any shape has no file.
  Result<void> write_file(Durability durability) {
    if (shapes_ == 0) return {};
    unwritten_ = 0;
    return write_whole(to_glb(scene_, frames_), file_, durability);
  }

  std::string path_ = "animation.glb";
  int frames_per_file_ = 600;

  Scene scene_;
  std::string file_;           ///< current file
  std::vector<Frame> frames_;  ///< frames of this file
  std::size_t shapes_ = 0;     ///< number of its frames with a shape
  std::size_t unwritten_ = 0;  ///< number of shapes that the file does not contain yet
  std::size_t files_ = 0;      ///< number of earlier files
};

}  // namespace
}  // namespace weft::animation

using weft::animation::Animation;
WEFT_PLUGIN(Animation, "sinks/animation", "1.0.0",
            "Writes the moving textured mesh as one glTF file.")
