// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/pass.hpp>

#include "common/images/picture_file.hpp"
#include "common/unwarping/unwarping.hpp"
#include "cut.hpp"
#include "prediction.hpp"
#include "seeds.hpp"

namespace weft::mask {
namespace {

constexpr double kLeakReach_px = 10.0;  // beyond the band, in which a cut may leak
constexpr int kLeastSide_px = 24;       // smallest reduced crop

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

ObjectMask empty_mask(std::int64_t height, std::int64_t width) {
  ObjectMask mask;
  mask.foreground = Array<std::uint8_t>({height, width}, 0);
  mask.known = Array<std::uint8_t>({height, width}, 0);
  return mask;
}

bool is_found(const std::optional<Shape>& shape, const Template& templ) {
  if (!shape || shape->vertices_m.rows() != templ.vertices_m.rows()) return false;
  const ShapeState state = shape->shape_state();
  return state == ShapeState::estimated || state == ShapeState::weak;
}

/// Which pixels show the object: from files, or by colours that the texture and the surroundings
/// of a shape have.
class Mask final : public Pass {
 public:
  static constexpr About kAbout{
      .reference =
          "own: Rother, Kolmogorov, Blake, GrabCut, SIGGRAPH (2004); He, Sun, Tang, "
          "Guided image filtering, TPAMI 35 (2013)",
      .needs = "image",
      .reads = "shape previous.shape correspondences",
      .produces = "object_mask"};

  explicit Mask(Params& p) {
    p.input_path("folder", folder_,
                 "folder with the masks as grey images, STEM.png for each frame; without it, the "
                 "masks are computed");
    p.read("scale", scale_, "", {0.1, 1.0}, "size of the cut image, relative to the frame");
    p.read("margin", margin_, "", {0.02, 2.0},
           "width of the background around the object, relative to the longer side of its box");
    p.read("band_px", seeds_.band_px, "px", {1.0, 500.0},
           "distance from the predicted outline within which the cut decides");
    p.read("agreement", seeds_.agreement, "grey levels", {1.0, 255.0},
           "maximum difference between image and rendered template where the object is visible");
    p.read("iterations", iterations_, "", {1, 20}, "number of cuts, with colours learned anew");
    p.read("smoothing_px", smoothing_px_, "px", {0.0, 200.0},
           "radius of the disc that rolls along both sides of the outline; what it does not touch "
           "is unknown");
    p.read("max_overlap", most_overlap_, "", {0.0, 1.0},
           "Bhattacharyya coefficient of the colours of object and background above which there "
           "is no mask");
    p.read("min_edge", least_edge_, "grey levels", {0.0, 255.0},
           "least slope per pixel of the cut image where the outline counts as known");
  }

  Result<PassOutput> run(const PassInput& in) override {
    const Array<std::uint8_t>& pixels = in.image->pixels;
    if (!folder_.empty()) return read_file(in.image->stem, pixels.dim(0), pixels.dim(1));
    const auto prediction = predict(in);
    if (!prediction) {
      return no_result("neither a shape nor ten matches show where the object is");
    }
    const cv::Mat image = unwarping::matrix_of(pixels);
    const Crop crop{box_around(*prediction, margin_, image.cols, image.rows), scale_};
    const cv::Size size = crop.size();
    if (crop.area.empty() || std::min(size.width, size.height) < kLeastSide_px) {
      return no_result("the object is outside of the image or too small for a cut");
    }
    return cut(in, *prediction, crop, image(crop.area), pixels);
  }

 private:
  Result<PassOutput> read_file(const std::string& stem, std::int64_t height, std::int64_t width) {
    const std::string path = folder_ + "/" + stem + ".png";
    const auto stored = image_files::read_pixels("folder", path, image_files::Channels::grey);
    if (!stored) return stored.error();
    if (stored->rows != height || stored->cols != width) {
      return about("folder", Error{Errc::invalid_data,
                                   path + " has " + std::to_string(stored->cols) + " x " +
                                       std::to_string(stored->rows) + " pixels, the frame " +
                                       std::to_string(width) + " x " + std::to_string(height) +
                                       ": give masks of the undistorted frames"});
    }
    PassOutput out;
    ObjectMask& mask = out.object_mask.emplace(empty_mask(height, width));
    for (std::int64_t y = 0; y < height; ++y) {
      const std::uint8_t* row = stored->ptr<std::uint8_t>(static_cast<int>(y));
      std::copy_n(row, width, mask.foreground.row(y));
      std::fill_n(mask.known.row(y), width, std::uint8_t{1});
    }
    return out;
  }

  std::optional<Prediction> predict(const PassInput& in) const {
    if (is_found(in.shape, in.templ)) return from_shape(*in.shape, in.camera);
    if (is_found(in.previous_shape, in.templ)) return from_shape(*in.previous_shape, in.camera);
    if (in.correspondences) return from_matches(*in.correspondences, in.templ);
    return std::nullopt;
  }

  Result<PassOutput> cut(const PassInput& in, const Prediction& prediction, const Crop& crop,
                         const cv::Mat& part, const Array<std::uint8_t>& pixels) const {
    cv::Mat reduced, bgr, grey, full_grey = part;
    cv::resize(part, reduced, crop.size(), 0.0, 0.0, cv::INTER_AREA);
    const bool is_grey = part.channels() == 1;
    if (!is_grey) cv::cvtColor(part, full_grey, cv::COLOR_BGR2GRAY);
    cv::cvtColor(reduced, is_grey ? bgr : grey, is_grey ? cv::COLOR_GRAY2BGR : cv::COLOR_BGR2GRAY);
    (is_grey ? grey : bgr) = reduced;
    const Rendering rendering = render(prediction, in.templ, crop);
    const Seeds seeds = prediction.is_exact
                            ? seeds_of_shape(rendering, in.templ, grey, crop.scale, seeds_)
                            : seeds_of_matches(rendering, *in.correspondences, crop, seeds_);
    if (seeds.agreement < kLeastAgreement) {
      return no_result("only " + percent(seeds.agreement) +
                       " of the image agrees with the rendered template");
    }
    const int object = cv::countNonZero(seeds.labels == cv::GC_FGD);
    const int background = cv::countNonZero(seeds.labels == cv::GC_BGD);
    if (std::min(object, background) < kFewestSeeds) {
      return no_result(object < background ? "no inner part of the object is visible"
                                           : "no background is visible around the object");
    }
    Cut made = cut_out(bgr, seeds, iterations_);
    if (made.overlap > most_overlap_) {
      return no_result("object and background have the same colours: overlap " +
                       percent(made.overlap));
    }
    const int radius = std::max(1, static_cast<int>(std::lround(smoothing_px_ * crop.scale)));
    const cv::Mat rough = smooth_out(radius, made.object);
    const double reach = (seeds_.band_px + kLeakReach_px) * crop.scale;
    const cv::Mat alike = near_marked(made.alike, reach);
    double edge_share = 0.0;
    const cv::Mat vague = without_edge(made.object, grey, least_edge_, edge_share);
    if (edge_share < kLeastEdgeShare) {
      return no_result("only " + percent(edge_share) + " of the outline is at an image edge");
    }
    PassOutput out;
    ObjectMask& mask = out.object_mask.emplace(empty_mask(pixels.dim(0), pixels.dim(1)));
    fill(crop, certainty(made.object, full_grey), seeds.occluded | vague | rough | alike, mask);
    mask.diag.set("overlap", made.overlap);
    mask.diag.set("edge_share", edge_share);
    mask.diag.set("agreement", seeds.agreement);
    return out;
  }

  static void fill(const Crop& crop, const cv::Mat& certain, const cv::Mat& unknown,
                   ObjectMask& mask) {
    cv::Mat unknown_px;
    cv::resize(unknown, unknown_px, certain.size(), 0.0, 0.0, cv::INTER_NEAREST);
    for (int y = 0; y < certain.rows; ++y) {
      std::uint8_t* foreground = mask.foreground.row(crop.area.y + y) + crop.area.x;
      std::uint8_t* known = mask.known.row(crop.area.y + y) + crop.area.x;
      std::copy_n(certain.ptr<std::uint8_t>(y), certain.cols, foreground);
      const std::uint8_t* hidden = unknown_px.ptr<std::uint8_t>(y);
      for (int x = 0; x < certain.cols; ++x) known[x] = hidden[x] == 0 ? 1 : 0;
    }
  }

  static constexpr double kLeastAgreement = 0.5;
  static constexpr double kLeastEdgeShare = 0.5;
  static constexpr int kFewestSeeds = 50;

  std::string folder_;
  double scale_ = 0.5;
  double margin_ = 0.15;
  SeedOptions seeds_;
  int iterations_ = 2;
  double smoothing_px_ = 12.0;
  double most_overlap_ = 0.8;
  double least_edge_ = 4.0;
};

}  // namespace
}  // namespace weft::mask

using weft::mask::Mask;
WEFT_PLUGIN(
    Mask, "passes/mask", "1.0.0",
    "Finds the pixels that show the object, by a graph cut between its colours and those of "
    "the background.")
