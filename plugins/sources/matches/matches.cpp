// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/source.hpp>

#include "common/cameras/camera_file.hpp"
#include "common/cameras/lens_points.hpp"
#include "common/frame_files.hpp"
#include "common/truth_files.hpp"
#include "match_files.hpp"

namespace weft::matches {
namespace {

/// Matches from files, found by another program.
class Matches final : public Source {
 public:
  static constexpr About kAbout{.produces = "time correspondences ground_truth"};

  explicit Matches(Params& p) {
    p.input_path("path", path_,
                 "files of matches, CSV or npz: one per frame, or one with the column frame; * ? "
                 "and [ ] are wildcards",
                 Need::required);
    p.input_path("camera", camera_path_,
                 "camera file: Weft's own (YAML or JSON), OpenCV's YAML or ROS camera_info",
                 Need::required);
    p.input_path("truth", truth_path_,
                 "ground truth files: true points as CSV or truth records as npz; STEM_KIND.csv or "
                 ".npz belongs to the frame STEM, 000012 in a file with the column frame");
    p.read("fps", fps_, "1/s", {1e-3, 1e6}, "frame rate that determines the time of each frame");
  }

  void check(Mistakes& mistakes) const {
    Matches found = *this;
    mistakes.expect("camera", cameras::read_camera_file(camera_path_));
    if (!mistakes.expect("path", found.list_frames())) return;
    mistakes.expect("truth", found.truth_.open(truth_path_, found.stems()));
  }

  Result<Camera> open(const Call&) override {
    auto camera = cameras::read_camera_file(camera_path_);
    if (!camera) return camera.error();
    camera_ = *std::move(camera);
    if (auto listed = list_frames(); !listed) return listed.error();
    if (auto paired = truth_.open(truth_path_, stems()); !paired) return paired.error();
    return camera_.camera;
  }

  std::int64_t count() const override {
    return static_cast<std::int64_t>(whole_ ? rows_.size() : files_.size());
  }

  Result<SourceFrame> read(std::int64_t index, const Call&) override {
    if (index < 0 || index >= count()) {
      return Error{Errc::invalid_value, "there is no frame " + std::to_string(index) +
                                            ": the source has " + std::to_string(count()) +
                                            ", counted from 0"};
    }
    const auto number = to_index(index);
    if (whole_) return frame_of(*whole_, rows_[number], files_.front(), index);
    const std::string& path = files_[number];
    const auto table = read_file(path);
    if (!table) return table.error();
    if (table->has(Column::frame)) return several_frames_in(path);
    return frame_of(*table, table->rows_by_frame().front(), path, index);
  }

 private:
  static Result<MatchTable> read_file(const std::string& path) {
    return path.ends_with(".npz") ? read_match_npz(path) : read_match_csv(path);
  }

  /// In a large set, files behind this many bytes are read only with their frames.
  static constexpr std::uintmax_t kMostBytesTried = 1U << 26U;

  Result<void> list_frames() {
    whole_.reset();
    auto files = sources::matching_files(path_);
    if (!files) return files.error();
    files_ = *std::move(files);
    std::uintmax_t bytes = 0;
    for (const std::string& file : files_) {
      std::error_code code;
      const std::uintmax_t size = std::filesystem::file_size(file, code);
      bytes += code ? 0 : size;
      if (bytes > kMostBytesTried && &file != &files_.front()) break;
      auto table = read_file(file);
      if (!table) return table.error();
      if (!table->has(Column::frame)) continue;
      if (files_.size() > 1) return several_frames_in(file);
      whole_ = *std::move(table);
      rows_ = whole_->rows_by_frame();
    }
    return {};
  }

  Error several_frames_in(const std::string& file) const {
    return {Errc::invalid_data,
            file + ": has the column frame, and " + std::to_string(files_.size()) +
                " files match: give one file with all frames, or one file a frame without it",
            {}};
  }

  std::string stem(std::int64_t index) const {
    if (!whole_) return sources::stem_of(files_[to_index(index)]);
    const std::string number = std::to_string(index);
    return std::string(number.size() < 6 ? 6 - number.size() : 0, '0') + number;
  }

  std::vector<std::string> stems() const {
    std::vector<std::string> stems;
    for (std::int64_t i = 0; i < count(); ++i) stems.push_back(stem(i));
    return stems;
  }

  Result<SourceFrame> frame_of(const MatchTable& table, const std::vector<std::size_t>& rows,
                               const std::string& path, std::int64_t index) {
    SourceFrame frame;
    frame.time = Time{static_cast<double>(index) / fps_};
    frame.correspondences = table.matches(rows);
    auto straight = cameras::undistort_points(camera_, path + ": the match at",
                                              frame.correspondences->image_px.matrix<2>());
    if (!straight) return straight.error();
    auto truth = truth_.read(stem(index));
    if (!truth) return truth.error();
    frame.ground_truth = *std::move(truth);
    if (!table.has_truth()) return frame;
    if (!frame.ground_truth) {
      frame.ground_truth = GroundTruth{Array<double>({0, 2}), Array<double>({0, 3}), "matches", ""};
    }
    table.add_truth(rows, *frame.ground_truth);
    if (!frame.ground_truth->match_xy_px.present()) return frame;
    straight = cameras::undistort_points(camera_, path + ": the true image at",
                                         frame.ground_truth->match_xy_px.matrix<2>());
    if (!straight) return straight.error();
    return frame;
  }

  std::string path_, camera_path_, truth_path_;
  double fps_ = 30.0;
  cameras::CameraFile camera_;
  std::vector<std::string> files_;
  std::optional<MatchTable> whole_;             ///< table of the one file with all frames
  std::vector<std::vector<std::size_t>> rows_;  ///< rows of each of its frames
  sources::TruthFiles truth_;
};

}  // namespace
}  // namespace weft::matches

using weft::matches::Matches;
WEFT_PLUGIN(Matches, "sources/matches", "1.0.0",
            "Reads matches from CSV and npz files, with any ground truth.")
