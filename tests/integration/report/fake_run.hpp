// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "unit/metrics/test_run.hpp"

namespace weft::evaluation {

inline constexpr int kRunFrames = 8;

inline std::string u32(std::size_t value) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(value >> (8 * i) & 0xFFU);
  return text;
}

inline std::string chunk(const std::string& id, const std::string& bytes) {
  return id + u32(bytes.size()) + bytes + std::string(bytes.size() % 2, '\0');
}

/// An AVI file whose n-th picture is the given one, or the JPEG marker and n times the letter p.
inline std::string video(int pictures, const std::string& picture = "") {
  std::string movi = "movi";
  for (int i = 0; i < pictures; ++i) {
    const std::string fake = "\xFF\xD8" + std::string(static_cast<std::size_t>(i), 'p');
    movi += chunk("00dc", picture.empty() ? fake : picture);
  }
  return chunk("RIFF", "AVI " + chunk("LIST", "hdrl" + chunk("avih", std::string(56, '\0'))) +
                           chunk("LIST", movi) + chunk("idx1", std::string(16, '\0')));
}

/// A run of eight frames: frame t is off by t mm along the axis, the last has no shape, because its
/// filter found too little. The stage `solvers` takes 5 ms, `filters` 1 ms.
inline void write_eight_frames(TestRun& run, bool real_pictures = false) {
  for (int t = 0; t + 1 < kRunFrames; ++t) run.solved(t, TestRun::truth("grid"));
  run.add(ShapeState::none, std::nullopt, TestRun::truth("grid"));
  std::string lines;
  for (int t = 0; t < kRunFrames; ++t) {
    const bool none = t + 1 == kRunFrames;
    nlohmann::ordered_json filter{{"stage", "filters"}, {"status", none ? "no_result" : "ok"}};
    if (none) filter["reason"] = "3 matches <are> too few";
    filter["ms"] = 1.0;
    nlohmann::ordered_json line{
        {"frame", t},
        {"stem", ""},
        {"state", none ? "none" : "estimated"},
        {"confidence", none ? nlohmann::json() : nlohmann::json(0.9)},
        {"failed", false},
        {"stages",
         {filter,
          {{"stage", "solvers"}, {"status", none ? "skipped" : "ok"}, {"ms", none ? 0.0 : 5.0}}}}};
    if (t == 2) line["warnings"] = {"setup: the focal length seems wrong"};
    lines += line.dump() + "\n";
  }
  run.write_text("frames.jsonl", lines);
  run.write_text("end.json", nlohmann::ordered_json{{"frames", kRunFrames}}.dump());
  std::vector<std::uint8_t> jpeg;
  if (real_pictures) cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(90, 100, 110)), jpeg);
  run.write_text("overlay.avi", video(kRunFrames, {jpeg.begin(), jpeg.end()}));
  run.write_text("pipeline.yaml", "weft: 1\n");
}

}  // namespace weft::evaluation
