// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fstream>
#include <thread>
#include <weft/data/matrix.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/sdk/source.hpp>
#include <weft/sdk/template_builder.hpp>

#include "gate.hpp"
#include "script.hpp"

namespace scripted {

/// Grey frames, with optional ground truth and an optional known point.
class FrameSource final : public weft::Source {
 public:
  static constexpr weft::About kAbout{.produces = "image time known_points ground_truth"};

  explicit FrameSource(weft::Params& p) : script_(p), gate_(p) {
    p.read("frames", frames_, "", {0, 1e6}, "how many");
    p.read("unknown_count", unknown_count_, "end with no_result instead of a count");
    p.read("live", live_, "say that frames come by themselves");
    p.read("focal_px", focal_px_, "px", {-1e6, 1e6}, "of the camera");
    p.read("sleep_ms", sleep_ms_, "ms", {0, 10'000}, "time that each frame takes");
    p.read("known_vertex", known_vertex_, "", {-1, 1e6}, "vertex that is known, -1 for none");
    p.read("truth", truth_, "give ground truth");
    read_frames(p, "wrong_size_at", wrong_size_, "frames larger than the camera says");
    p.input_path("path", path_, "not used, but must exist");
    p.text("note", note_, "add a line to 'path': a line in it for each check; else not used");
  }

  void check(weft::Mistakes& mistakes) const {
    script_.check(mistakes);
    if (note_ == "odd") mistakes.add("note", "'note' is odd");
    if (note_ == "nameless") mistakes.add("no such parameter", "everything is odd");
    if (note_ == "add a line to 'path'") std::ofstream(path_, std::ios::app) << "checked\n";
  }

  weft::Result<weft::Camera> open(const weft::Call& call) override {
    if (auto cancelled = gate_.pass(call)) return *cancelled;
    if (auto ready = script_.prepare(); !ready) return ready.error();
    is_open_ = true;
    return weft::Camera{focal_px_, kFocal_px, 79.5, 59.5, 160, 120};
  }

  std::int64_t count() const override { return unknown_count_ ? -1 : frames_; }
  bool live() const override { return live_; }

  weft::Result<weft::SourceFrame> read(std::int64_t index, const weft::Call& call) override {
    if (!is_open_) return weft::Error{weft::Errc::plugin_failure, "was not opened", ""};
    if (index >= frames_) return weft::no_more_frames("the end");
    if (auto cancelled = gate_.pass(call)) return *cancelled;
    if (auto failure = script_.failure(call)) return *failure;
    std::this_thread::sleep_for(std::chrono::milliseconds(sleep_ms_));
    weft::SourceFrame frame;
    frame.time = weft::Time{script_.number(call, 0.04 * static_cast<double>(index))};
    frame.image.emplace();
    frame.image->pixels = weft::Array<std::uint8_t>({120, has(wrong_size_, call) ? 200 : 160}, 0);
    frame.image->stem = "f" + std::to_string(index);
    if (known_vertex_ >= 0) {
      frame.known_points = {weft::Array<std::int32_t>({1}, 0), weft::Array<double>({1, 3}, 0.0),
                            weft::Array<double>({1}, 0.0)};
      frame.known_points->vertex(0) = known_vertex_;
    }
    if (truth_) {
      frame.ground_truth = {weft::Array<double>({1, 2}, 0.0), weft::Array<double>({1, 3}, 0.0),
                            "made", ""};
      frame.ground_truth->points_m(0, 2) = kDistance_m;
    }
    return frame;
  }

 private:
  Script script_;
  Gate gate_;
  int frames_ = 3;
  bool unknown_count_ = false;
  bool live_ = false;
  double focal_px_ = kFocal_px;
  int sleep_ms_ = 0;
  int known_vertex_ = -1;
  bool truth_ = false;
  Frames wrong_size_;
  std::string path_, note_;
  bool is_open_ = false;
};

/// A flat surface with cells of 20 texels, with optional faults.
class Sheet final : public weft::TemplateBuilder {
 public:
  explicit Sheet(weft::Params& p) : gate_(p) {
    p.read("columns", columns_, "", {2, 100}, "vertices in a row");
    p.read("rows", rows_, "", {2, 100}, "vertices in a column");
    p.choice("defect", defect_,
             {{"none", Defect::none},
              {"index", Defect::index},
              {"flipped", Defect::flipped},
              {"mask_size", Defect::mask_size},
              {"no_faces", Defect::no_faces},
              {"nan", Defect::nan}},
             "what is wrong");
  }

  weft::Result<weft::Template> build(const weft::Call& call) override {
    if (auto cancelled = gate_.pass(call)) return *cancelled;
    constexpr int kCell_px = 20;
    const int width = (columns_ - 1) * kCell_px + 1, height = (rows_ - 1) * kCell_px + 1;
    const std::int64_t count = std::int64_t{columns_} * rows_;
    weft::Template sheet;
    sheet.vertices_m = weft::Array<double>({count, 3}, 0.0);
    sheet.flat_px = weft::Array<double>({count, 2}, 0.0);
    for (std::int64_t v = 0; v < count; ++v) {
      sheet.flat_px(v, 0) = static_cast<double>(kCell_px * (v % columns_));
      sheet.flat_px(v, 1) = static_cast<double>(kCell_px * (v / columns_));
      sheet.vertices_m(v, 0) = kPitch_m * sheet.flat_px(v, 0);
      sheet.vertices_m(v, 1) = kPitch_m * sheet.flat_px(v, 1);
    }
    sheet.faces = weft::make_array<std::int32_t>(*weft::rectangular_grid_faces(columns_, rows_));
    sheet.m_per_px = weft::Array<double>({2}, 0.0);
    sheet.m_per_px(0) = sheet.m_per_px(1) = kPitch_m;
    sheet.texture = weft::Array<std::uint8_t>({height, width}, 0);
    sheet.mask = weft::Array<std::uint8_t>({height, width}, 0);
    std::fill_n(sheet.mask.data(), sheet.mask.size(), std::uint8_t{1});
    spoil(sheet);
    return sheet;
  }

 private:
  enum class Defect { none, index, flipped, mask_size, no_faces, nan };

  void spoil(weft::Template& sheet) const {
    if (defect_ == Defect::index) sheet.faces(0, 0) = 1'000'000;
    if (defect_ == Defect::flipped) std::swap(sheet.faces(0, 0), sheet.faces(0, 1));
    if (defect_ == Defect::mask_size) sheet.mask = weft::Array<std::uint8_t>({2, 2}, 0);
    if (defect_ == Defect::no_faces) sheet.faces = weft::Array<std::int32_t>({0, 3}, 0);
    if (defect_ == Defect::nan) {
      sheet.vertices_m(0, 0) = std::numeric_limits<double>::quiet_NaN();
    }
  }

  Gate gate_;
  int columns_ = 6;
  int rows_ = 5;
  Defect defect_ = Defect::none;
};

}  // namespace scripted
