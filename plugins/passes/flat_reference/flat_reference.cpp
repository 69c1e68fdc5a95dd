// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/pass.hpp>

#include "common/unwarping/unwarping.hpp"
#include "patch_search.hpp"
#include "patches.hpp"

namespace weft::flat_reference {
namespace {

constexpr double kMmPerM = 1000.0;
constexpr double kNear_mm = 1.0;  // further away a patch is at another place

/// Where each patch of the flat print is in the image that is unwarped through the shape.
class FlatReference final : public Pass {
 public:
  static constexpr About kAbout{.needs = "image shape", .produces = "registration"};

  explicit FlatReference(Params& p) {
    p.input_path("words", words_path_,
                 "JSON list of {text, top, left, height, width} in pixels of the texture, one box "
                 "per word; without it, the cells of a grid are searched");
    p.read("margin_px", margin_px_, "px", {0, 1000}, "width that is added to each side of a box");
    p.read("range_mm", range_mm_, "mm", {0.0, 1000.0},
           "maximum displacement that is searched along each axis of the texture");
    p.read("threshold", threshold_, "", {0.0, 1.0},
           "minimum normalised cross-correlation of a found patch");
    p.read("cell_mm", cell_mm_, "mm", {0.1, 1000.0}, "side of the grid cells, without words");
    p.read("min_contrast", min_contrast_, "grey levels", {1.0, 128.0},
           "standard deviation below which a patch is blank and not counted");
  }

  void check(Mistakes& mistakes) const {
    if (!words_path_.empty()) mistakes.expect("words", read_words(words_path_));
  }

  Result<void> prepare(const PrepareInput& /*in*/) override {
    if (words_path_.empty()) return {};
    auto words = read_words(words_path_);
    if (!words) return words.error();
    words_ = *std::move(words);
    return {};
  }

  Result<PassOutput> run(const PassInput& in) override {
    if (auto fits = check_inputs(in); !fits) return fits.error();
    const cv::Mat print = unwarping::grey_levels(in.templ.texture);
    const double mm_per_px[] = {kMmPerM * in.templ.m_per_px(0), kMmPerM * in.templ.m_per_px(1)};
    const cv::Size range_px(in_texels(range_mm_, mm_per_px[0], print.cols),
                            in_texels(range_mm_, mm_per_px[1], print.rows));
    auto patches = patches_of(print, mm_per_px, range_px);
    if (!patches) return patches.error();
    const cv::Mat seen = unwarping::unwarped(unwarping::grey_levels(in.image->pixels), in.templ,
                                             in.camera, *in.shape);
    PassOutput out;
    Registration& made = out.registration.emplace();
    const auto count = static_cast<std::int64_t>(patches->size());
    made.place_px = Array<double>({count, 2});
    made.displacement_mm = Array<double>({count, 2}, std::nan(""));
    made.correlation = Array<double>({count});
    made.found = Array<std::uint8_t>({count}, 0);
    int found = 0;
    for (std::int64_t i = 0; i < count; ++i) {
      ask_to_go_on();
      const cv::Rect& patch = (*patches)[to_index(i)];
      const Peak peak = find_patch(print, seen, patch, range_px);
      made.place_px(i, 0) = patch.x + 0.5 * (patch.width - 1);
      made.place_px(i, 1) = patch.y + 0.5 * (patch.height - 1);
      made.correlation(i) = peak.correlation;
      if (peak.correlation < threshold_) continue;
      ++found;
      made.found(i) = 1;
      made.displacement_mm(i, 0) = mm_per_px[0] * peak.shift_px.x;
      made.displacement_mm(i, 1) = mm_per_px[1] * peak.shift_px.y;
    }
    made.diag.set("patches", static_cast<double>(count));
    made.diag.set("found", found);
    return out;
  }

 private:
  static Result<void> check_inputs(const PassInput& in) {
    if (!in.image || !in.shape) {
      return Error{Errc::invalid_data, "needs 'image' and 'shape'", {}};
    }
    if (auto fits = unwarping::check_unwarping(in.templ, *in.image, *in.shape); !fits) return fits;
    if (in.templ.m_per_px.present()) return {};
    return Error{Errc::invalid_data,
                 "the template has no texel pitch (m_per_px), so that no distance is known in mm; "
                 "give the template its width",
                 {}};
  }

  /// Whole texels within a length, at least `least` and at most all of the texture.
  static int in_texels(double mm, double mm_per_px, int most, int least = 0) {
    return static_cast<int>(std::clamp(std::floor(mm / mm_per_px), static_cast<double>(least),
                                       static_cast<double>(most)));
  }

  /// Boxes with their margin, as far as they are on the texture, without the blank ones. In a grid
  /// it also omits boxes that the texture repeats nearby, such as pieces of a line: their places
  /// are ambiguous by more than a millimetre.
  Result<std::vector<cv::Rect>> patches_of(const cv::Mat& print, const double* mm_per_px,
                                           cv::Size range_px) const {
    const cv::Size near_px(in_texels(kNear_mm, mm_per_px[0], print.cols),
                           in_texels(kNear_mm, mm_per_px[1], print.rows));
    const cv::Size cell_px(in_texels(cell_mm_, mm_per_px[0], print.cols, 1),
                           in_texels(cell_mm_, mm_per_px[1], print.rows, 1));
    auto boxes = words_.empty() ? Result<std::vector<cv::Rect>>(grid_of(print.size(), cell_px))
                                : boxes_of(words_, print.size());
    if (!boxes) return Error{boxes.error().code, boxes.error().message, words_path_};
    std::vector<cv::Rect> patches;
    for (const cv::Rect& box : *boxes) {
      const cv::Rect grown(box.x - margin_px_, box.y - margin_px_, box.width + 2 * margin_px_,
                           box.height + 2 * margin_px_);
      const cv::Rect patch = grown & cv::Rect({}, print.size());
      if (contrast(print(patch)) < min_contrast_) continue;
      ask_to_go_on();
      if (words_.empty() && likeness_elsewhere(print, patch, range_px, near_px) >= threshold_) {
        continue;
      }
      patches.push_back(patch);
    }
    if (!patches.empty()) return patches;
    return no_result(
        words_.empty()
            ? "no cell of the texture has contrast and is unique in its surroundings: it cannot be "
              "compared"
            : "the texture has no contrast at any word: these belong to another texture");
  }

  std::string words_path_;
  std::vector<Word> words_;
  int margin_px_ = 8;
  double range_mm_ = 12.0;
  double threshold_ = 0.55;
  double cell_mm_ = 10.0;
  double min_contrast_ = 5.0;
};

}  // namespace
}  // namespace weft::flat_reference

using weft::flat_reference::FlatReference;
WEFT_PLUGIN(
    FlatReference, "passes/flat_reference", "1.0.0",
    "Measures registration by a search for patches of the flat texture in the unwarped image.")
