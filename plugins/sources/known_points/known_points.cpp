// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/sdk/source.hpp>

#include "row_feed.hpp"

namespace weft::known_points {
namespace {

/// Adds known points, of a file or a named pipe, to the frames of another source.
class KnownPointSource final : public Source {
 public:
  static constexpr About kAbout{
      .reference = "own: Shetab-Bushehri et al. 2023, ROBUSfT (known 3D points of grippers)",
      .produces = "image time known_points ground_truth region"};

  explicit KnownPointSource(Params& p) {
    p.component("frames", frames_, "source of the frames");
    p.input_path(
        "path", feed_options_.path,
        "rows of known points: a CSV file, a file of JSON lines, or a named pipe of JSON lines",
        Need::required);
    p.read("tolerance_s", feed_options_.tolerance_s, "s", {0.0, 1e6},
           "maximum time difference between a row and its frame");
    p.read("clock_offset_s", clock_offset_s_, "s", {-1e12, 1e12},
           "time of the rows when the time of the frames is 0");
    p.read("wait_ms", feed_options_.wait_ms, "ms", {0, 3600000},
           "maximum time for which a frame waits for the rows of a pipe");
    p.read("camera_from_robot", camera_from_robot_, "m", {-1e6, 1e6},
           "rotation and translation [R t] from the frame of the rows to the camera frame, 12 "
           "numbers row by row; empty: camera frame");
  }

  /// A pipe is not opened: its writer would lose what it has written to it so far.
  void check(Mistakes& mistakes) const {
    FeedOptions options = feed_options_;
    const bool posed = mistakes.expect("camera_from_robot", read_pose(options));
    if (posed && !is_pipe(options.path)) mistakes.expect("path", RowFeed::open(options));
  }

  Result<Camera> open(const Call& call) override {
    feed_.reset();
    if (auto posed = read_pose(feed_options_); !posed) return posed.error();
    auto feed = RowFeed::open(feed_options_);
    if (!feed) return feed.error();
    auto camera = frames_.open(call);
    if (!camera) return camera.error();
    const auto count = frames_.count(call);
    if (!count) return count.error();
    count_ = *count;
    feed_ = *std::move(feed);
    return camera;
  }

  std::int64_t count() const override { return count_.frames; }
  bool live() const override { return count_.live != 0; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (!feed_) return Error{Errc::invalid_value, "the source is not open: open it first"};
    auto given = frames_.read(call);
    if (!given) return given.error();
    Moment moment{static_cast<double>(index), {}};
    if (given->time) moment.time_s = given->time->t_s + clock_offset_s_;
    auto known = feed_->at(moment, [&] { return call.cancelled(); });
    if (!known) return known.error();
    std::string reason = given.degenerate_reason();
    if (const std::string& late = known.degenerate_reason(); !late.empty()) {
      reason += (reason.empty() ? "" : "; ") + late;
    }
    SourceFrame frame = *std::move(given);
    frame.known_points = *std::move(known);
    if (!reason.empty()) return degenerate(std::move(frame), reason);
    return frame;
  }

 private:
  Result<void> read_pose(FeedOptions& options) const {
    if (camera_from_robot_.empty()) return {};
    constexpr double kLargestError = 1e-3;
    const auto mistake = [](const char* what) {
      return Error{Errc::invalid_value, std::string("'camera_from_robot' ") + what};
    };
    if (camera_from_robot_.size() != 12) return mistake("must have 12 numbers: [R t], row by row");
    using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
    const Eigen::Map<const Rows> pose(camera_from_robot_.data());
    const Eigen::Matrix3d rotation = pose.leftCols<3>();
    const Eigen::Matrix3d error = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
    if (error.cwiseAbs().maxCoeff() > kLargestError || rotation.determinant() < 0.0) {
      return mistake("must begin with a rotation: orthonormal, with determinant 1");
    }
    options.camera_from_rows.matrix().topRows<3>() = pose;
    return {};
  }

  SourceComponent frames_{"sources/images"};
  FeedOptions feed_options_;
  double clock_offset_s_ = 0.0;
  std::vector<double> camera_from_robot_;
  Count count_;
  std::optional<RowFeed> feed_;
};

}  // namespace
}  // namespace weft::known_points

using weft::known_points::KnownPointSource;
WEFT_PLUGIN(KnownPointSource, "sources/known_points", "1.0.0",
            "Adds known 3D points from a file or a pipe to the frames of another source.")
