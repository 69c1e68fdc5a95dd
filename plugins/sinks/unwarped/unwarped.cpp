// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>
#include <weft/core/whole_file.hpp>
#include <weft/sdk/sink.hpp>

#include "common/output_folder/output_folder.hpp"
#include "common/unwarping/unwarping.hpp"

namespace weft::unwarped {
namespace {

enum class Format { png, jpg };

/// The image of each frame with a shape, mapped back onto the flat texture.
class Unwarped final : public Sink {
 public:
  static constexpr About kAbout{.needs = "image camera template shape"};

  explicit Unwarped(Params& p) {
    p.output_path("path", path_, "folder of the images");
    p.choice("format", format_, {{"png", Format::png}, {"jpg", Format::jpg}},
             "file format of the images");
  }

  Result<void> open(const Call&) override { return output_folder::make(path_); }

  Result<void> write(const SinkInput& in) override {
    // A shape that this frame did not show would distort the image at random.
    const ShapeState state = in.shape->shape_state();
    if (state != ShapeState::estimated && state != ShapeState::weak) return {};
    const Template& templ = *in.templ;
    if (auto fits = unwarping::check_unwarping(templ, *in.image, *in.shape); !fits) return fits;
    const cv::Mat texels =
        unwarping::unwarped(unwarping::matrix_of(in.image->pixels), templ, *in.camera, *in.shape);
    const char* extension = format_ == Format::png ? "png" : "jpg";
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(std::string(".") + extension, texels, bytes)) {
      return Error{Errc::unsupported, "the image cannot be encoded: choose another 'format'"};
    }
    return write_whole(std::string(bytes.begin(), bytes.end()),
                       output_folder::file_of(path_, in.call.frame(), extension),
                       Durability::unsynced);
  }

  Result<void> finish(const Call&) override { return output_folder::sync(path_); }

 private:
  std::string path_ = "unwarped";
  Format format_ = Format::png;
};

}  // namespace
}  // namespace weft::unwarped

using weft::unwarped::Unwarped;
WEFT_PLUGIN(Unwarped, "sinks/unwarped", "1.0.0",
            "Writes each image unwarped, as if the object were flat.")
