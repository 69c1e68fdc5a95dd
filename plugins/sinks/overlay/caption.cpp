// SPDX-License-Identifier: Apache-2.0
#include "caption.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "palette.hpp"
#include "text.hpp"

namespace weft::overlay {
namespace {

std::string counted(std::int64_t count, const std::string& noun, const std::string& ending) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : ending);
}

std::int64_t kept_matches(const SinkInput& in) {
  std::int64_t kept = 0;
  if (!in.correspondences) return kept;
  for (std::int64_t i = 0; i < in.correspondences->count(); ++i) {
    kept += in.correspondences->kept(i) != 0 ? 1 : 0;
  }
  return kept;
}

/// "563 of 580 matches agree", where the solver counted them.
std::string agreement_of(const SinkInput& in) {
  const double kept = in.shape->diag.value("kept_matches", 0.0);
  const double agreeing = in.shape->diag.value("agreeing_matches", -1.0);
  if (kept > 0.0 && agreeing >= 0.0) {
    return std::to_string(std::llround(agreeing)) + " of " +
           counted(std::llround(kept), "match", "es") + (agreeing == 1.0 ? " agrees" : " agree") +
           " with it";
  }
  return in.correspondences ? counted(kept_matches(in), "match", "es") + " kept" : "";
}

std::string why_not_measured(const SinkInput& in) {
  const std::int64_t kept = kept_matches(in);
  return kept == 0 ? "no match was kept"
                   : counted(kept, "match", "es") + " kept, but no shape was found for them";
}

std::string joined(const std::string& one, const std::string& other) {
  return one.empty() || other.empty() ? one + other : one + "; " + other;
}

std::string reason_of(const SinkInput& in) {
  if (!in.shape) return why_not_measured(in);
  switch (in.shape->shape_state()) {
    case ShapeState::estimated:
      return agreement_of(in);
    case ShapeState::weak:
      return joined("it may be wrong", agreement_of(in));
    case ShapeState::predicted:
    case ShapeState::lost:
    case ShapeState::none:
      break;
  }
  return joined("as it was " + counted(in.shape->age_frames, "frame", "s") + " ago",
                why_not_measured(in));
}

std::string decimal(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// The colours from 0 to 1, and a mark at the value.
void draw_scale(cv::Mat& strip, const cv::Rect& bar, const std::optional<double>& confidence) {
  for (int x = 0; x < bar.width; ++x) {
    const cv::Scalar colour = colour_of_confidence((x + 0.5) / bar.width);
    cv::line(strip, {bar.x + x, bar.y}, {bar.x + x, bar.y + bar.height - 1}, colour);
  }
  if (!confidence) return;
  const int x = bar.x + cvRound(std::clamp(*confidence, 0.0, 1.0) * (bar.width - 1));
  const int half = std::max(1, bar.height / 8);
  const cv::Rect mark(x - half, bar.y - bar.height / 3, 2 * half + 1,
                      bar.height + 2 * (bar.height / 3));
  cv::rectangle(strip, mark, kInk, cv::FILLED);
}

}  // namespace

Caption caption_of(const SinkInput& in) {
  Caption caption;
  caption.state = in.shape ? to_string(in.shape->shape_state()) : "no result";
  caption.reason = reason_of(in);
  caption.place =
      "frame " + (in.image->stem.empty() ? std::to_string(in.call.frame()) : in.image->stem);
  if (in.time) caption.place += decimal("   %.2f s", in.time->t_s);
  if (in.shape) caption.confidence = in.shape->confidence;
  return caption;
}

int caption_height_px(cv::Size image) {
  const int wanted = cvRound(0.15 * std::min(image.width, image.height));
  return std::max(8, wanted + wanted % 2);
}

void draw_caption(cv::Mat strip, const Caption& caption) {
  strip.setTo(kPaper);
  const double height = strip.rows, width = strip.cols, margin = 0.22 * height;
  const double upper = 0.43 * height, lower = 0.82 * height;  // base lines
  TextStyle large{0.2 * height, kInk, true, 0.4 * width};
  TextStyle small{0.165 * height, kFaintInk, false, 0.3 * width};

  const int swatch = std::max(2, cvRound(large.capital_px));
  cv::rectangle(strip, cv::Rect(cvRound(margin), cvRound(upper) - swatch, swatch, swatch),
                colour_of_confidence(caption.confidence.value_or(0.0)),
                caption.confidence ? cv::FILLED : 1);
  draw_text(strip, caption.state, {margin + 1.6 * swatch, upper}, Anchor::left, large);
  draw_text(strip, caption.place, {width - margin, lower}, Anchor::right, small);
  const double place = text_width_px(caption.place, small);
  TextStyle plain = small;
  plain.colour = kInk;
  plain.most_px = width - place - 4.0 * margin;
  draw_text(strip, caption.reason, {margin, lower}, Anchor::left, plain);

  const int bar_width = std::max(2, cvRound(std::min(0.2 * width, 2.6 * height)));
  const int bar_height = std::max(1, cvRound(0.75 * small.capital_px));
  const cv::Rect bar(cvRound(width - margin) - bar_width,
                     cvRound(upper - 0.5 * (small.capital_px + bar_height)), bar_width, bar_height);
  draw_scale(strip, bar, caption.confidence);
  plain.most_px = 0.35 * width;
  draw_text(strip,
            caption.confidence ? decimal("confidence %.2f", *caption.confidence) : "no confidence",
            {bar.x - 0.5 * margin, upper}, Anchor::right, plain);
}

}  // namespace weft::overlay
