// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>
#include <weft/core/whole_file.hpp>
#include <weft/sdk/sink.hpp>

#include "match_picture.hpp"
#include "picture.hpp"
#include "twin_picture.hpp"

namespace weft::drawing {
namespace {

enum class Content { mesh, texture, matches, twins };

/// An image of the template, which is the same in all frames, or of the first frame with a shape.
class Drawing final : public Sink {
 public:
  static constexpr About kAbout{.needs = "template", .reads = "image camera correspondences shape"};

  explicit Drawing(Params& p) {
    p.output_path("path", path_, "path of the PNG file");
    p.choice("content", content_,
             {{"mesh", Content::mesh},
              {"texture", Content::texture},
              {"matches", Content::matches},
              {"twins", Content::twins}},
             "content of the image; mesh: mesh over the texture, and a curved object at rest; "
             "texture: texture only; matches: first image with mesh and match residuals; twins: "
             "similar keypoints");
  }

  Result<void> open(const Call&) override {
    is_written_ = false;
    return {};
  }

  Result<void> write(const SinkInput& in) override {
    if (is_written_) return {};
    const bool has_all = in.image && in.camera && in.correspondences && in.shape;
    if (content_ == Content::matches && !has_all) return {};
    if (content_ == Content::twins && !in.correspondences) return {};
    std::vector<std::uint8_t> png;
    const cv::Mat picture = picture_of(in);
    const std::vector<int> small{cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY,
                                 cv::IMWRITE_PNG_STRATEGY_DEFAULT};
    if (!cv::imencode(".png", picture, png, small)) {
      return Error{Errc::unsupported, "the image is too large for PNG", path_};
    }
    const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
    if (auto written = write_whole(bytes, path_); !written) return written;
    is_written_ = true;
    return {};
  }

  Result<void> finish(const Call&) override { return {}; }

 private:
  cv::Mat picture_of(const SinkInput& in) const {
    if (content_ == Content::matches) return draw_matches(in);
    if (content_ == Content::twins) return draw_twins(*in.templ, *in.correspondences);
    return content_ == Content::mesh ? draw_mesh(*in.templ) : texture_of(*in.templ);
  }

  std::string path_ = "template.png";
  Content content_ = Content::mesh;
  bool is_written_ = false;
};

}  // namespace
}  // namespace weft::drawing

using weft::drawing::Drawing;
WEFT_PLUGIN(Drawing, "sinks/drawing", "1.2.0", "Renders the template and its mesh as a PNG file.")
