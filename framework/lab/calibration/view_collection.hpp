// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/calibration/board_finder.hpp"
#include "lab/calibration/frame_reader.hpp"
#include "lab/calibration/view.hpp"

namespace weft::calibration {

/// A frame without a view, and why.
struct NoView {
  std::string name, reason;
};

/// The views of frames, which must all have one size.
class ViewCollection {
 public:
  explicit ViewCollection(const Board& board) : finder_(board) {}

  /// Looks for the board. Errc::invalid_data for a frame of another size.
  Result<void> add(const Frame& frame);

  /// The same for a camera that continues to give frames. Keeps a view only if the board has not
  /// moved since the previous frame, and if it differs from all views that are kept. Returns true
  /// if it was kept.
  Result<bool> add_if_new(const Frame& frame);

  std::size_t frames() const { return frames_; }
  const ImageSize& size() const { return size_; }
  const std::vector<View>& views() const { return views_; }
  /// The view of the last frame given to `add_if_new`, and why it has none.
  const std::optional<View>& last() const { return before_; }
  const std::string& last_fault() const { return last_fault_; }
  /// Only of frames given to `add`.
  const std::vector<NoView>& without() const { return without_; }
  /// Some of the images in which the board was not found, spread over all.
  const std::vector<cv::Mat>& unexplained() const { return unexplained_; }

 private:
  Result<void> check_size(const Frame& frame);
  void keep_unexplained(const Frame& frame);

  BoardFinder finder_;
  std::size_t frames_ = 0;
  std::string first_;  ///< name of the first frame
  ImageSize size_;
  std::vector<View> views_;
  std::vector<NoView> without_;
  std::size_t frames_without_ = 0;
  std::vector<cv::Mat> unexplained_;
  std::optional<View> before_;  ///< view of the last frame, where it had one
  std::string last_fault_;
};

}  // namespace weft::calibration
