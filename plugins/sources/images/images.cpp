// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/suggest.hpp>
#include <weft/images/image_file.hpp>
#include <weft/sdk/source.hpp>

#include "common/cameras/calibrated_camera.hpp"
#include "common/frame_files.hpp"
#include "common/truth_files.hpp"
#include "depth_files.hpp"
#include "growing_folder.hpp"
#include "image_file.hpp"
#include "region_files.hpp"

namespace weft::images {
namespace {

/// One frame of the folder.
struct Frame {
  std::string path;
  std::string stem;
  std::string apart;  ///< why it is reported apart, if it is
};

/// Image files of a calibrated camera, in the natural order of their paths: those that are there,
/// or those that come into a folder.
class Images final : public Source {
 public:
  static constexpr About kAbout{.produces = "image time ground_truth region"};

  explicit Images(Params& p) {
    p.input_path("path", path_, "image files; * ? and [ ] work in the file name and in folders",
                 Need::required);
    p.input_path("camera", camera_path_,
                 "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info",
                 Need::required);
    p.input_path("truth", truth_path_,
                 "CSV files of true points, npz files of truth records, clouds as PLY, CSV or npz; "
                 "STEM_KIND.csv belongs to the frame STEM, the longest that fits");
    truth_.declare(p);
    p.labels("apart", apart_, "frames that are reported apart: stem and reason");
    depth_.declare(p);
    region_.declare(p);
    p.read("fps", fps_, "1/s", {1e-3, 1e6}, "frames a second; gives each frame its time");
    p.read("wait_s", wait_s_, "s", {0.0, 86'400.0},
           "wait so long for the next file of a folder that grows; 0: the folder is whole");
  }

  void check(Mistakes& mistakes) const {
    auto camera = cameras::CalibratedCamera::read_sizes(camera_path_);
    const bool calibrated = mistakes.expect("camera", camera);
    Images found = *this;
    if (!mistakes.expect("path", found.list_frames())) return;
    mistakes.expect("path", found.check_readable());
    if (calibrated) {
      found.camera_ = *std::move(camera);
      const auto fits = found.fit_camera();
      const bool wrong_size = !fits && fits.error().code == Errc::invalid_data;
      mistakes.expect(wrong_size ? "camera" : "path", fits);
    }
    mistakes.expect("truth", found.attach_truth());
    mistakes.expect("depth", found.attach_depth());
    mistakes.expect("region", found.attach_region());
    mistakes.expect("apart", found.mark_apart());
  }

  Result<Camera> open(const Call& call) override {
    frames_.clear();
    frame_of_.clear();
    ending_.reset();
    auto camera = cameras::CalibratedCamera::read(camera_path_);
    if (!camera) return camera.error();
    camera_ = *std::move(camera);
    if (auto listed = list_frames(); !listed) return listed.error();
    if (auto readable = check_readable(); !readable) return readable.error();
    if (auto fits = fit_camera(); !fits) return fits.error();
    if (auto attached = attach_truth(); !attached) return attached.error();
    if (auto attached = attach_depth(); !attached) return attached.error();
    if (auto attached = attach_region(); !attached) return attached.error();
    if (auto marked = mark_apart(); !marked) return marked.error();
    camera_.report_orientation(call, path_);
    report_order(call);
    return camera_.pinhole();
  }

  std::int64_t count() const override { return live() ? -1 : known_count(); }

  bool live() const override { return wait_s_ > 0.0; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (auto there = wait_for(index, call); !there) return there.error();
    const Frame& frame = frames_[to_index(index)];
    const auto stored = read_image_file(frame.path, camera_);
    if (!stored) return stored.error();
    auto image = camera_.undistorted(stored->pixels, frame.path, frame.stem);
    if (!image) return image.error();
    SourceFrame result;
    result.image = *std::move(image);
    result.time = Time{static_cast<double>(index) / fps_};
    auto truth = truth_of(frame);
    if (!truth) return truth.error();
    result.ground_truth = *std::move(truth);
    const auto added = depth_.add_to(result.ground_truth, frame.stem, camera_);
    if (!added) return added.error();
    auto region = region_.read(frame.stem, camera_);
    if (!region) return region.error();
    result.region = *std::move(region);
    if (stored->damage.empty()) return result;
    return degenerate(std::move(result), frame.path + ": is damaged: " + stored->damage);
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
      // Stems are the names by which truth and `apart` refer to frames.
      if (!is_new && !(truth_path_.empty() && apart_.empty())) {
        return Error{Errc::invalid_value,
                     "the frames " + frames_[twin->second].path + " and " + path +
                         " have the same stem, so that truth and 'apart' are ambiguous: narrow "
                         "'path' or rename one"};
      }
      frames_.push_back({std::move(path), std::move(stem), {}});
    }
    return {};
  }

  static constexpr std::size_t kMostTries = 100;  ///< frames, before the rest is believed

  /// Files of frames that are there; of a folder that grows perhaps none.
  std::vector<std::string> first_paths() const {
    std::vector<std::string> paths;
    for (const Frame& frame : frames_) paths.push_back(frame.path);
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

  Result<void> fit_camera() {
    auto camera = camera_of_files(first_paths(), camera_);
    if (!camera) return camera.error();
    camera_ = *std::move(camera);
    return {};
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

  /// What belongs to frames by their stems is found before the first one is read.
  Result<void> check_whole(const std::string& parameter, bool is_given) const {
    if (!live() || !is_given) return {};
    return Error{Errc::unsupported,
                 "'" + parameter +
                     "' belongs to frames that are all there: leave it out while the folder grows, "
                     "or read the whole folder, without 'wait_s'"};
  }

  Result<void> attach_depth() {
    if (auto whole = check_whole("depth", depth_.is_given()); !whole) return whole;
    return depth_.open(stems());
  }

  Result<void> attach_region() {
    if (auto whole = check_whole("region", region_.is_given()); !whole) return whole;
    return region_.open(stems());
  }

  Result<void> attach_truth() {
    if (auto whole = check_whole("truth", !truth_path_.empty()); !whole) return whole;
    if (camera_.is_rotated() && !truth_path_.empty()) {
      return Error{Errc::unsupported,
                   "'truth' is that of the camera as its file describes it, but the images are "
                   "turned to be upright, and the camera with them: save the images without "
                   "orientation, or leave 'truth' out"};
    }
    return truth_.open(truth_path_, stems());
  }

  Result<void> mark_apart() {
    if (auto whole = check_whole("apart", !apart_.empty()); !whole) return whole;
    for (const auto& [stem, reason] : apart_) {
      Frame* frame = find(stem);
      if (frame == nullptr) {
        return Error{Errc::not_found, "'apart' names the frame '" + stem +
                                          "', but no image has this stem" +
                                          did_you_mean(stem, stems())};
      }
      frame->apart = reason;
    }
    return {};
  }

  Result<std::optional<GroundTruth>> truth_of(const Frame& frame) {
    auto truth = truth_.read(frame.stem);
    if (truth && *truth && !frame.apart.empty()) (*truth)->apart = frame.apart;
    return truth;
  }

  Frame* find(const std::string& stem) {
    const auto found = frame_of_.find(stem);
    return found == frame_of_.end() ? nullptr : &frames_[found->second];
  }

  std::string path_;
  std::string camera_path_;
  std::string truth_path_;
  std::vector<std::pair<std::string, std::string>> apart_;
  double fps_ = 30.0;
  double wait_s_ = 0.0;

  cameras::CalibratedCamera camera_;
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
WEFT_PLUGIN(Images, "sources/images", "1.2.0",
            "Reads image files of a calibrated camera, undistorted, with truth and regions where "
            "there are any.")
