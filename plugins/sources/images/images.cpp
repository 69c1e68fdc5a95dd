// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <weft/core/image_file.hpp>
#include <weft/core/suggest.hpp>
#include <weft/sdk/source.hpp>

#include "common/calibrated_camera.hpp"
#include "depth_files.hpp"
#include "frame_files.hpp"
#include "image_file.hpp"
#include "truth_archive.hpp"
#include "truth_file.hpp"

namespace weft::images {
namespace {

/// One frame of the folder.
struct Frame {
  std::string path;
  std::string stem;
  std::optional<GroundTruth> truth;  ///< of a CSV file
  std::string truth_path;
  std::string kind;   ///< what follows the stem in the name of the truth file
  std::string apart;  ///< why it is reported apart, if it is

  bool has_archive() const { return truth_path.ends_with(".npz"); }
};

/// Image files of a calibrated camera, in bytewise order of their paths.
class Images final : public Source {
 public:
  static constexpr About kAbout{.produces = "image time ground_truth"};

  explicit Images(Params& p) {
    p.input_path("path", path_, "image files; * ? and [ ] work in the file name and in folders",
                 Need::required);
    p.input_path("camera", camera_path_,
                 "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info",
                 Need::required);
    p.input_path("truth", truth_path_,
                 "CSV files of true points or npz files of truth records; STEM_KIND.csv or .npz "
                 "belongs to the frame STEM");
    p.labels("apart", apart_, "frames that are reported apart: stem and reason");
    depth_.declare(p);
    p.read("fps", fps_, "1/s", {1e-3, 1e6}, "frames a second; gives each frame its time");
  }

  void check(Mistakes& mistakes) const {
    const auto camera = sources::CalibratedCamera::read_sizes(camera_path_);
    const bool calibrated = mistakes.expect("camera", camera);
    Images found = *this;
    if (!mistakes.expect("path", found.list_frames())) return;
    mistakes.expect("path", found.check_readable());
    if (calibrated) mistakes.expect("camera", found.check_sizes(*camera));
    mistakes.expect("truth", found.attach_truth());
    mistakes.expect("depth", found.attach_depth());
    mistakes.expect("apart", found.mark_apart());
  }

  Result<Camera> open(const Call&) override {
    frames_.clear();
    frame_of_.clear();
    auto camera = sources::CalibratedCamera::read(camera_path_);
    if (!camera) return camera.error();
    camera_ = *std::move(camera);
    if (auto listed = list_frames(); !listed) return listed.error();
    if (auto readable = check_readable(); !readable) return readable.error();
    if (auto fit = check_sizes(camera_); !fit) return fit.error();
    if (auto attached = attach_truth(); !attached) return attached.error();
    if (auto attached = attach_depth(); !attached) return attached.error();
    if (auto marked = mark_apart(); !marked) return marked.error();
    return camera_.pinhole();
  }

  std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }

  Result<SourceFrame> read(std::int64_t index, const Call&) override {
    if (index < 0 || index >= count()) {
      return Error{Errc::invalid_value,
                   "there is no frame " + std::to_string(index) + ": the source has " +
                       std::to_string(count()) + ", counted from 0",
                   {}};
    }
    const Frame& frame = frames_[static_cast<std::size_t>(index)];
    const auto stored = read_image_file(frame.path, camera_);
    if (!stored) return stored.error();
    auto image = camera_.undistorted(*stored, frame.path, frame.stem);
    if (!image) return image.error();
    SourceFrame result;
    result.image = *std::move(image);
    result.time = Time{static_cast<double>(index) / fps_};
    auto truth = truth_of(frame);
    if (!truth) return truth.error();
    result.ground_truth = *std::move(truth);
    const auto added = depth_.add_to(result.ground_truth, frame.stem, camera_);
    if (!added) return added.error();
    return result;
  }

 private:
  Result<void> list_frames() {
    auto paths = matching_files(path_);
    if (!paths) return paths.error();
    for (std::string& path : *paths) {
      std::string stem = stem_of(path);
      const auto [twin, is_new] = frame_of_.try_emplace(stem, frames_.size());
      // Stems are the names by which truth and `apart` refer to frames.
      if (!is_new && !(truth_path_.empty() && apart_.empty())) {
        return Error{Errc::invalid_value,
                     "the frames " + frames_[twin->second].path + " and " + path +
                         " have the same stem, so that truth and 'apart' are ambiguous: narrow "
                         "'path' or rename one",
                     {}};
      }
      frames_.push_back({std::move(path), std::move(stem), {}, {}, {}, {}});
    }
    return {};
  }

  static constexpr std::size_t kMostTries = 100;  ///< frames, before the rest is believed

  /// A frame that cannot be read is an error of that frame; if none can, the path is wrong.
  Result<void> check_readable() const {
    Result<void> first;
    for (std::size_t i = 0; i < std::min(frames_.size(), kMostTries); ++i) {
      const auto file = read_image_bytes(frames_[i].path);
      if (file) return {};
      if (first) first = file.error();
    }
    return first;
  }

  /// A frame of another size than the camera's is an error of that frame; if none has it, the
  /// camera file is that of other images.
  Result<void> check_sizes(const sources::CalibratedCamera& camera) const {
    Result<void> first;
    for (std::size_t i = 0; i < std::min(frames_.size(), kMostTries); ++i) {
      const auto file = read_image_bytes(frames_[i].path);
      if (!file || file->header.width_px == 0) continue;
      const cv::Size size(static_cast<int>(file->header.width_px),
                          static_cast<int>(file->header.height_px));
      const auto fits = camera.check_size(size, frames_[i].path);
      if (fits) return {};
      if (first) first = fits;
    }
    return first;
  }

  Result<void> attach_depth() {
    std::vector<std::string> stems;
    for (const Frame& frame : frames_) stems.push_back(frame.stem);
    return depth_.open(stems);
  }

  Result<void> attach_truth() {
    if (truth_path_.empty()) return {};
    auto paths = matching_files(truth_path_);
    if (!paths) return Error{paths.error().code, "truth: " + paths.error().message, {}};
    for (const std::string& path : *paths) {
      const std::string stem = stem_of(path);
      const std::size_t end = stem.find('_');
      Frame* frame = find(stem.substr(0, end));
      if (frame == nullptr) {
        return Error{Errc::invalid_data,
                     path + ": belongs to no frame: no image has the stem '" + stem.substr(0, end) +
                         "', which is the name up to the first '_'",
                     {}};
      }
      if (!frame->truth_path.empty()) {
        return Error{Errc::invalid_data,
                     path + ": belongs to the frame '" + frame->stem + "', which already has " +
                         frame->truth_path + ": remove one",
                     {}};
      }
      frame->truth_path = path;
      frame->kind = end == stem.npos ? "" : stem.substr(end + 1);
      if (frame->has_archive()) continue;
      auto truth = read_truth_file(path);
      if (!truth) return truth.error();
      frame->truth = *std::move(truth);
    }
    return {};
  }

  Result<void> mark_apart() {
    for (const auto& [stem, reason] : apart_) {
      Frame* frame = find(stem);
      if (frame == nullptr) {
        std::vector<std::string> stems;
        for (const Frame& known : frames_) stems.push_back(known.stem);
        const std::string meant = nearest(stem, stems);
        return Error{Errc::not_found,
                     "'apart' names the frame '" + stem + "', but no image has this stem" +
                         (meant.empty() ? "" : "; did you mean '" + meant + "'?"),
                     {}};
      }
      frame->apart = reason;
    }
    return {};
  }

  /// Archives may hold much, so that they are read with their frames.
  Result<std::optional<GroundTruth>> truth_of(const Frame& frame) {
    std::optional<GroundTruth> truth = frame.truth;
    if (frame.has_archive()) {
      auto archive = TruthArchive::read(frame.truth_path);
      if (!archive) return archive.error();
      archive_.emplace(*std::move(archive));
      auto read = archive_->truth();
      if (!read) return read.error();
      truth = *std::move(read);
    }
    if (!truth) return truth;
    if (!frame.kind.empty()) truth->kind = frame.kind;
    if (!frame.apart.empty()) truth->apart = frame.apart;
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

  sources::CalibratedCamera camera_;
  DepthFiles depth_;
  std::vector<Frame> frames_;
  std::optional<TruthArchive> archive_;          ///< from which the last frame's truth borrows
  std::map<std::string, std::size_t> frame_of_;  // index of each stem
};

}  // namespace
}  // namespace weft::images

using weft::images::Images;
WEFT_PLUGIN(Images, "sources/images", "1.0.0",
            "Reads image files of a calibrated camera, undistorted, with truth where there is any.")
