// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "unit/metrics/test_run.hpp"

namespace weft::lab {

inline constexpr int kRunFrames = 8;

inline std::string u32(std::size_t value) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(value >> (8 * i) & 0xFFU);
  return text;
}

inline std::string chunk(const std::string& id, const std::string& bytes) {
  return id + u32(bytes.size()) + bytes + std::string(bytes.size() % 2, '\0');
}

/// An AVI file whose n-th image is the given one, or the JPEG marker and n times the letter p.
inline std::string video(int pictures, const std::string& picture = "") {
  std::string movi = "movi";
  for (int i = 0; i < pictures; ++i) {
    const std::string fake = "\xFF\xD8" + std::string(static_cast<std::size_t>(i), 'p');
    movi += chunk("00dc", picture.empty() ? fake : picture);
  }
  return chunk("RIFF", "AVI " + chunk("LIST", "hdrl" + chunk("avih", std::string(56, '\0'))) +
                           chunk("LIST", movi) + chunk("idx1", std::string(16, '\0')));
}

/// A run of eight frames: frame t is off by t mm along the axis and `more_mm`, the last has no
/// shape, because its filter found too little. The stage `solvers` takes 5 ms, `filters` 1 ms.
inline void write_eight_frames(TestRun& run, bool real_pictures = false, double more_mm = 0.0) {
  for (int t = 0; t + 1 < kRunFrames; ++t) run.solved(t + more_mm, TestRun::truth("grid"));
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

/// Eight texture patches in each frame with a shape. In frame t, t of them are displaced by 2.5 mm
/// and the others by 0.5 mm; the last one is not found. Frame 6 has an unwarped image as PNG, frame
/// 3 as JPEG.
inline void compare_with_print(TestRun& run) {
  constexpr int kPatches = 8;
  std::map<std::uint64_t, Registration> frames;
  for (int t = 0; t + 1 < kRunFrames; ++t) {
    Registration& made = frames[static_cast<std::uint64_t>(t)];
    made.place_px = Array<double>({kPatches, 2}, 25.0);
    made.displacement_mm = Array<double>({kPatches, 2}, 0.0);
    made.correlation = Array<double>({kPatches}, 0.9);
    made.found = Array<std::uint8_t>({kPatches}, std::uint8_t{1});
    for (int i = 0; i < kPatches; ++i) {
      made.place_px(i, 0) = 5.0 + 6.0 * i;
      made.displacement_mm(i, 1) = i < t ? 2.5 : 0.5;
    }
    made.found(kPatches - 1) = 0;
    made.displacement_mm(kPatches - 1, 0) = made.displacement_mm(kPatches - 1, 1) = kUnknown;
  }
  run.measure(frames);
  run.write_text("pipeline.yaml",
                 "weft: 1\nsinks:\n  - {use: sinks/unwarped, as: flat, params: {path: flat}}\n");
  std::filesystem::create_directories(run.folder() + "/flat");
  for (const char* name : {"000006.png", "000003.jpg"}) {
    cv::imwrite(run.folder() + "/flat/" + name, cv::Mat(50, 60, CV_8UC3, cv::Scalar(200, 90, 60)));
  }
}

}  // namespace weft::lab
