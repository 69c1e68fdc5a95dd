// SPDX-License-Identifier: Apache-2.0
#include "description.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace weft::dataset {
namespace {

/// The shortest text that reads back as the same number, whatever the locale.
std::string number(double value) {
  std::array<char, 32> buffer{};
  const auto [end, code] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

/// Width and height in m of what a flat texture shows.
std::array<double, 2> size_m(const Template& templ) {
  return {templ.m_per_px(0) * static_cast<double>(templ.texture.dim(1)),
          templ.m_per_px(1) * static_cast<double>(templ.texture.dim(0))};
}

double frames_per_second(const Contents& contents) {
  const double duration_s = contents.last_s - contents.first_s;
  if (contents.frames < 2 || !(duration_s > 0.0)) return 30.0;
  const double fps = static_cast<double>(contents.frames - 1) / duration_s;
  return std::round(1e6 * fps) / 1e6;  // times are rounded
}

/// Vertices along the width of a grid: as many as the first has in its row.
std::int64_t columns_of(const Template& templ) {
  std::int64_t columns = 1;
  while (columns < templ.flat_px.rows() && templ.flat_px(columns, 1) == templ.flat_px(0, 1)) {
    ++columns;
  }
  return columns;
}

}  // namespace

std::string camera_text(const Camera& camera) {
  return "# Pinhole without distortion; pixel centres at integers.\nfx: " + number(camera.fx) +
         "\nfy: " + number(camera.fy) + "\ncx: " + number(camera.cx) +
         "\ncy: " + number(camera.cy) + "\nwidth: " + std::to_string(camera.width_px) +
         "\nheight: " + std::to_string(camera.height_px) + "\ndistortion: null\n";
}

std::string meta_text(const Camera& camera, const Template& templ, const Contents& contents) {
  std::string text =
      "# A sequence with its truth, written by sinks/dataset.\nformat: weft.sequence/1\nframes: " +
      std::to_string(contents.frames) + "\nfps: " + number(frames_per_second(contents)) +
      "\nimage_px: [" + std::to_string(camera.width_px) + ", " + std::to_string(camera.height_px) +
      "]\ncamera: camera.yaml\ntruth:\n  frames: " + std::to_string(contents.frames_with_truth) +
      "\n  kind: \"" + contents.truth_kind + "\"\n  files: gt/*.npz\n" +
      "  units: metres in the camera frame (x right, y down, z forward)\n" +
      "template:\n  texture: template/texture.png\n  mesh: template/template.npz\n";
  if (!templ.m_per_px.present()) return text;
  const auto [width_m, height_m] = size_m(templ);
  return text + "  size_m: [" + number(width_m) + ", " + number(height_m) + "]\n";
}

std::string sequence_text(const Template& templ, const Contents& contents) {
  std::string text =
      "# The beginning of a pipeline: `extends:` this file and add stages.\nweft: 1\nsource:\n"
      "  use: sources/images\n  params:\n    path: frames/*.png\n    camera: camera.yaml\n";
  if (contents.frames_with_truth > 0) text += "    truth: gt/*.npz\n";
  text += "    fps: " + number(frames_per_second(contents)) + "\n";
  const std::int64_t columns = columns_of(templ);
  const bool is_grid = columns > 1 && templ.flat_px.rows() % columns == 0;
  if (!templ.m_per_px.present() || !is_grid) return text;
  const auto [width_m, height_m] = size_m(templ);
  return text +
         "template:\n  use: templates/rectangular\n  params:\n"
         "    texture: template/texture.png\n    width_m: " +
         number(width_m) + "\n    height_m: " + number(height_m) +
         "\n    columns: " + std::to_string(columns) +
         "\n    rows: " + std::to_string(templ.flat_px.rows() / columns) + "\n";
}

}  // namespace weft::dataset
