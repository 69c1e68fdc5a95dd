// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/suggest.hpp>
#include <weft/images/image_file.hpp>
#include <weft/sdk/source.hpp>

#include "camera_images.hpp"
#include "common/frame_files.hpp"
#include "common/truth_files.hpp"
#include "depth_files.hpp"
#include "growing_folder.hpp"
#include "region_files.hpp"

namespace weft::images {
namespace {

/// One frame of the folder.
struct Frame {
  std::string path;
  std::string stem;
  std::string exclusion;  ///< why it is reported separately, if it is
};

/// Image files of one camera, in the natural order of their paths: those that are there,
/// or those that come into a folder.
class Images final : public Source {
 public:
  static constexpr About kAbout{.produces = "image time ground_truth region"};

  explicit Images(Params& p) {
    p.input_path("path", path_, "image files; * ? and [ ] are wildcards in file and folder names",
                 Need::required);
    images_.declare(p);
    p.input_path("truth", truth_path_,
                 "ground truth files: true points as CSV, truth records as npz, clouds as PLY, CSV "
                 "or npz; STEM_KIND.csv belongs to the frame with the longest matching STEM");
    truth_.declare(p);
    p.formerly("apart").labels("excluded", exclusions_,
                               "frames that are reported separately: stem and reason");
    depth_.declare(p);
    region_.declare(p);
    p.read("fps", fps_, "1/s", {1e-3, 1e6}, "frame rate that determines the time of each frame");
    p.read("wait_s", wait_s_, "s", {0.0, 86'400.0},
           "time to wait for the next file of a growing folder; 0: the folder is complete");
  }

  void check(Mistakes& mistakes) const {
    Images found = *this;
    mistakes.expect("focal_by_side", images_.check());
    const bool has_camera = mistakes.expect("camera", found.images_.read_camera(true));
    if (!mistakes.expect("path", found.list_frames())) return;
    mistakes.expect("path", found.check_readable());
    if (has_camera) {
      const auto fits = found.fit_camera(found.first_paths());
      const bool wrong_size = !fits && fits.error().code == Errc::invalid_data;
      mistakes.expect(wrong_size ? "camera" : "path", fits);
    }
    mistakes.expect("truth", found.attach_truth());
    mistakes.expect("depth", found.attach_depth());
    mistakes.expect("region", found.attach_region());
    mistakes.expect("excluded", found.mark_excluded());
  }

  Result<Camera> open(const Call& call) override {
    frames_.clear();
    frame_of_.clear();
    ending_.reset();
    if (auto read = images_.read_camera(false); !read) return read.error();
    if (auto listed = list_frames(); !listed) return listed.error();
    if (auto readable = check_readable(); !readable) return readable.error();
    if (auto fits = fit_camera(images_.is_assumed() ? paths() : first_paths()); !fits) {
      return fits.error();
    }
    if (auto attached = attach_truth(); !attached) return attached.error();
    if (auto attached = attach_depth(); !attached) return attached.error();
    if (auto attached = attach_region(); !attached) return attached.error();
    if (auto marked = mark_excluded(); !marked) return marked.error();
    images_.report(call, path_);
    report_order(call);
    return images_.camera().pinhole();
  }

  std::int64_t count() const override { return live() ? -1 : known_count(); }

  bool live() const override { return wait_s_ > 0.0; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (auto there = wait_for(index, call); !there) return there.error();
    const Frame& frame = frames_[to_index(index)];
    auto read = images_.read(frame.path, frame.stem);
    if (!read) return read.error();
    SourceFrame result;
    result.image = std::move(read->image);
    result.time = Time{static_cast<double>(index) / fps_};
    auto truth = truth_of(frame);
    if (!truth) return truth.error();
    result.ground_truth = *std::move(truth);
    const auto added = depth_.add_to(result.ground_truth, frame.stem, images_.camera());
    if (!added) return added.error();
    auto region = region_.read(frame.stem, images_.camera());
    if (!region) return region.error();
    result.region = read->region ? std::move(read->region) : *std::move(region);
    if (read->damage.empty()) return result;
    return degenerate(std::move(result), frame.path + ": is damaged: " + read->damage);
  }

 private:
  std::int64_t known_count() const { return static_cast<std::int64_t>(frames_.size()); }

  /// Until the frame is known; those of a folder that grows can be read again.
  Result<void> wait_for(std::int64_t index, const Call& call) {
    if (index < 0 || (index >= known_count() && !folder_)) {
      return Error{Errc::invalid_value, "there is no frame " + std::to_string(index) +
                                            ": the source has " + std::to_string(known_count()) +
                                            ", counted from 0"};
    }
    while (index >= known_count()) {
      if (ending_) return index == known_count() ? *ending_ : no_more_frames(path_ + ": has ended");
      auto path = folder_->next(call);
      if (path) {
        std::string stem = sources::stem_of(*path);
        frames_.push_back({*std::move(path), std::move(stem), {}});
      } else if (path.error().code == Errc::cancelled) {
        return path.error();
      } else {
        ending_ = path.error();
      }
    }
    return {};
  }

  Result<void> list_frames() {
    if (live()) {
      auto folder = GrowingFolder::open(path_, wait_s_);
      if (!folder) return folder.error();
      folder_ = *std::move(folder);
      return {};
    }
    auto paths = sources::matching_files(path_);
    if (!paths) return paths.error();
    for (std::string& path : *paths) {
      std::string stem = sources::stem_of(path);
      const auto [twin, is_new] = frame_of_.try_emplace(stem, frames_.size());
      // Stems are the names by which truth and `excluded` refer to frames.
      if (!is_new && !(truth_path_.empty() && exclusions_.empty())) {
        return Error{Errc::invalid_value,
                     "the frames " + frames_[twin->second].path + " and " + path +
                         " have the same stem, so that truth and 'excluded' are ambiguous: narrow "
                         "'path' or rename one"};
      }
      frames_.push_back({std::move(path), std::move(stem), {}});
    }
    return {};
  }

  static constexpr std::size_t kMostTries = 100;  ///< frames, before the rest is believed

  std::vector<std::string> paths() const {
    std::vector<std::string> paths;
    for (const Frame& frame : frames_) paths.push_back(frame.path);
    return paths;
  }

  /// Files of frames that are there; of a folder that grows perhaps none.
  std::vector<std::string> first_paths() const {
    std::vector<std::string> paths = this->paths();
    if (live()) {
      if (auto there = sources::matching_files(path_)) paths = *std::move(there);
    }
    paths.resize(std::min(paths.size(), kMostTries));
    return paths;
  }

  /// A frame that cannot be read is an error of that frame; if none can, the path is wrong. One
  /// that is still being written cannot yet.
  Result<void> check_readable() const {
    Result<void> first;
    if (live()) return first;
    for (const std::string& path : first_paths()) {
      const auto file = read_image_bytes(path);
      if (file) return {};
      if (first) first = file.error();
    }
    return first;
  }

  Result<void> fit_camera(const std::vector<std::string>& paths) {
    if (auto fits = check_fixed("camera: auto", live() && images_.is_assumed()); !fits) return fits;
    return images_.fit(paths);
  }

  /// Where numbers without leading zeros make a difference.
  void report_order(const Call& call) const {
    for (std::size_t i = 1; i < frames_.size(); ++i) {
      if (frames_[i - 1].path <= frames_[i].path) continue;
      return call.log_info(
          "files are read in the order of the numbers in their names: " + frames_[i - 1].stem +
          " before " + frames_[i].stem + "; bytewise the order would be another");
    }
  }

  std::vector<std::string> stems() const {
    std::vector<std::string> stems;
    for (const Frame& frame : frames_) stems.push_back(frame.stem);
    return stems;
  }

  /// An error where a parameter needs all frames at the start or images of one size. Files that
  /// belong to frames by their stems are found before the first frame is read. Files that belong to
  /// pixels have the size of all frames.
  Result<void> check_fixed(const std::string& parameter, bool is_given) const {
    if (!is_given) return {};
    if (live()) {
      return Error{Errc::unsupported,
                   "'" + parameter +
                       "' belongs to frames that are all there: leave it out while the folder "
                       "grows, or read the whole folder, without 'wait_s'"};
    }
    if (!images_.have_canvas()) return {};
    return Error{Errc::unsupported, "'" + parameter +
                                        "' belongs to images of one size, but these have several: "
                                        "leave it out, or narrow 'path'"};
  }

  Result<void> attach_depth() {
    if (auto whole = check_fixed("depth", depth_.is_given()); !whole) return whole;
    return depth_.open(stems());
  }

  Result<void> attach_region() {
    if (auto whole = check_fixed("region", region_.is_given()); !whole) return whole;
    return region_.open(stems());
  }

  Result<void> attach_truth() {
    if (auto whole = check_fixed("truth", !truth_path_.empty()); !whole) return whole;
    if (images_.camera().is_rotated() && !truth_path_.empty()) {
      return Error{Errc::unsupported,
                   "'truth' fits the camera file, but the images and the camera are turned "
                   "upright: save the images without orientation, or omit 'truth'"};
    }
    return truth_.open(truth_path_, stems());
  }

  Result<void> mark_excluded() {
    if (auto whole = check_fixed("excluded", live() && !exclusions_.empty()); !whole) return whole;
    for (const auto& [stem, reason] : exclusions_) {
      Frame* frame = find(stem);
      if (frame == nullptr) {
        return Error{Errc::not_found, "'excluded' names the frame '" + stem +
                                          "', but no image has this stem" +
                                          did_you_mean(stem, stems())};
      }
      frame->exclusion = reason;
    }
    return {};
  }

  Result<std::optional<GroundTruth>> truth_of(const Frame& frame) {
    auto truth = truth_.read(frame.stem);
    const bool has_pixels = truth && *truth &&
                            ((*truth)->depth_m.present() || (*truth)->uv_m.present() ||
                             (*truth)->match_xy_px.present());
    if (has_pixels && images_.camera().scales()) {
      return Error{Errc::unsupported, "the truth of '" + frame.stem +
                                          "' has places or values of pixels, which are not scaled: "
                                          "leave 'longest_px' out"};
    }
    if (truth && *truth && !frame.exclusion.empty()) (*truth)->exclusion = frame.exclusion;
    return truth;
  }

  Frame* find(const std::string& stem) {
    const auto found = frame_of_.find(stem);
    return found == frame_of_.end() ? nullptr : &frames_[found->second];
  }

  std::string path_;
  CameraImages images_;
  std::string truth_path_;
  std::vector<std::pair<std::string, std::string>> exclusions_;
  double fps_ = 30.0;
  double wait_s_ = 0.0;

  DepthFiles depth_;
  RegionFiles region_;
  std::vector<Frame> frames_;
  sources::TruthFiles truth_;
  std::map<std::string, std::size_t> frame_of_;  // index of each stem
  std::optional<GrowingFolder> folder_;          // that grows, once it is open
  std::optional<Error> ending_;                  // why it gives no more frames, once known
};

}  // namespace
}  // namespace weft::images

using weft::images::Images;
WEFT_PLUGIN(Images, "sources/images", "1.3.0",
            "Reads image files of one camera, undistorted, with any ground truth and region masks.")
