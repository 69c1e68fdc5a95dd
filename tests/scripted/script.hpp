// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>
#include <weft/core/mistakes.hpp>
#include <weft/core/params.hpp>
#include <weft/sdk/call.hpp>

namespace scripted {

/// Indices of frames.
using Frames = std::vector<double>;

inline void read_frames(weft::Params& p, const char* name, Frames& frames, const char* help) {
  p.read(name, frames, "", {0, 1e9}, help);
}

inline bool has(const Frames& frames, const weft::Call& call) {
  return std::find(frames.begin(), frames.end(), static_cast<double>(call.frame())) != frames.end();
}

/// Scripted actions that replace a component's work, frame by frame; every list is a parameter.
class Script {
 public:
  explicit Script(weft::Params& p) {
    read_frames(p, "no_result_at", no_result_, "frames with no result");
    read_frames(p, "degenerate_at", degenerate_, "frames whose result is flagged");
    read_frames(p, "error_at", error_, "frames with an error");
    read_frames(p, "throw_at", throw_, "frames with an exception");
    read_frames(p, "nan_at", nan_, "frames whose result holds NaN");
    read_frames(p, "wrong_length_at", wrong_length_, "frames whose result has a wrong length");
    read_frames(p, "no_memory_at", no_memory_, "frames in which memory is short");
    read_frames(p, "gone_at", lost_, "frames whose file is gone");
    read_frames(p, "cancelled_at", cancelled_, "frames whose call says that it was cancelled");
    p.read("refuse", refuse_, "fail in prepare");
    p.read("absent", absent_, "fail in prepare for a file that is gone");
    p.text("doubt", doubt_, "what check() says of this parameter, where there is one");
  }

  void check(weft::Mistakes& mistakes) const {
    if (doubt_ == "throw") throw std::runtime_error("scripted exception");
    if (!doubt_.empty()) mistakes.add("doubt", doubt_);
  }

  weft::Result<void> prepare() const {
    if (absent_) return weft::Error{weft::Errc::not_found, "its file is gone, as scripted", ""};
    if (!refuse_) return {};
    return weft::about("refuse", {weft::Errc::invalid_value, "refuses as scripted", ""});
  }

  /// The failure that is due in this call, if one is.
  std::optional<weft::Error> failure(const weft::Call& call) const {
    if (has(throw_, call)) throw std::runtime_error("scripted exception");
    if (has(no_memory_, call)) throw std::bad_alloc();
    if (has(lost_, call)) return weft::Error{weft::Errc::io, "scripted loss", ""};
    if (has(no_result_, call)) return weft::no_result("scripted no result");
    if (has(cancelled_, call)) return weft::Error{weft::Errc::cancelled, "scripted stop", ""};
    if (has(error_, call)) return weft::Error{weft::Errc::invalid_data, "scripted error", ""};
    return std::nullopt;
  }

  /// The value, flagged in the frames that the script lists.
  template <class RecordType>
  weft::Result<RecordType> answer(const weft::Call& call, RecordType typed) const {
    if (has(degenerate_, call)) {
      call.log_warning("scripted warning");
      return weft::degenerate(std::move(typed), "scripted degeneracy");
    }
    return typed;
  }

  /// A number that is NaN in the frames that the script lists.
  double number(const weft::Call& call, double value) const {
    return has(nan_, call) ? std::numeric_limits<double>::quiet_NaN() : value;
  }

  /// A length that is one too long in the frames that the script lists.
  std::int64_t length(const weft::Call& call, std::int64_t value) const {
    return value + (has(wrong_length_, call) ? 1 : 0);
  }

 private:
  Frames no_result_, degenerate_, error_, throw_, nan_, wrong_length_, no_memory_, lost_,
      cancelled_;
  bool refuse_ = false, absent_ = false;
  std::string doubt_;
};

/// The scene: texel (u, v) is seen at `kScale` * (u, v) + `kShift_px`, on a surface that faces the
/// camera.
inline constexpr double kFocal_px = 100.0;
inline constexpr double kPitch_m = 0.001;
inline constexpr double kDistance_m = 0.2;
inline constexpr double kScale = kFocal_px * kPitch_m / kDistance_m;
inline constexpr double kShift_px = 20.0;

inline double to_image(double texel) { return kScale * texel + kShift_px; }

}  // namespace scripted
