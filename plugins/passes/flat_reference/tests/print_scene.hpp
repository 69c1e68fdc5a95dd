// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>
#include <weft/core/rng.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/visibility.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::flat_reference {

constexpr int kPrintWidthPx = 600, kPrintHeightPx = 400, kBorderPx = 40;
constexpr double kMmPerPx = 0.5;
constexpr std::uint64_t kSeed = 20261129;

struct Box {
  int left, top, width, height;
};

/// A texture that faces the camera at a distance where a texel is as large as a pixel. The image is
/// the texture with a border, and a mesh moved by one texel is 0.5 mm off exactly.
class PrintScene : public ::testing::Test {
 protected:
  PrintScene()
      : templ(testing::make_template({.columns = 7,
                                      .rows = 5,
                                      .width_m = 1e-3 * kMmPerPx * kPrintWidthPx,
                                      .height_m = 1e-3 * kMmPerPx * kPrintHeightPx,
                                      .width_px = kPrintWidthPx,
                                      .height_px = kPrintHeightPx})) {
    RecordProperty("seed", std::to_string(kSeed));
    camera = {1200.0,
              1200.0,
              kBorderPx,
              kBorderPx,
              kPrintWidthPx + 2 * kBorderPx,
              kPrintHeightPx + 2 * kBorderPx};
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 5; ++column) {
        words.push_back({30 + 115 * column, 25 + 62 * row, 70, 22});
      }
    }
    templ.texture = print_of(words, kSeed);
    photograph(templ.texture);
  }
  ~PrintScene() override {
    for (const std::string& file : files_) std::filesystem::remove(file);
  }

  /// Blocks of 4 px, black or white at random, in each box of a white print.
  static Array<std::uint8_t> print_of(const std::vector<Box>& boxes, std::uint64_t seed) {
    Array<std::uint8_t> print({kPrintHeightPx, kPrintWidthPx}, 0);
    std::fill_n(print.data(), print.size(), std::uint8_t{255});
    Rng rng(seed);
    for (const Box& box : boxes) {
      for (int y = 0; y < box.height; y += 4) {
        for (int x = 0; x < box.width; x += 4) {
          const std::uint8_t level = rng.uniform() < 0.5 ? 0 : 255;
          for (int v = y; v < std::min(y + 4, box.height); ++v) {
            for (int u = x; u < std::min(x + 4, box.width); ++u) {
              print(box.top + v, box.left + u) = level;
            }
          }
        }
      }
    }
    return print;
  }

  void photograph(const Array<std::uint8_t>& print) {
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 0);
    std::fill_n(image.pixels.data(), image.pixels.size(), std::uint8_t{90});
    for (std::int64_t v = 0; v < kPrintHeightPx; ++v) {
      std::copy_n(print.row(v), kPrintWidthPx, image.pixels.row(v + kBorderPx) + kBorderPx);
    }
  }

  /// The true mesh, moved by this many texels.
  Shape mesh(double right_px = 0.0, double down_px = 0.0) const {
    Shape shape;
    const auto flat_px = templ.flat_px.matrix<2>();
    shape.vertices_m = Array<double>({flat_px.rows(), 3});
    shape.source = Array<std::uint8_t>({flat_px.rows()}, 0);
    for (Eigen::Index v = 0; v < flat_px.rows(); ++v) {
      shape.vertices_m(v, 0) = 1e-3 * kMmPerPx * (flat_px(v, 0) + right_px);
      shape.vertices_m(v, 1) = 1e-3 * kMmPerPx * (flat_px(v, 1) + down_px);
      shape.vertices_m(v, 2) = 0.6;
    }
    return shape;
  }

  std::string write(const std::string& text) {
    files_.push_back(::testing::TempDir() + "weft_words_" + std::to_string(getpid()) + "_" +
                     std::to_string(files_.size()) + ".json");
    std::ofstream(files_.back(), std::ios::binary) << text;
    return files_.back();
  }

  static std::string json_of(const std::vector<Box>& boxes) {
    std::string text;
    for (const Box& box : boxes) {
      text += std::string(text.empty() ? "[" : ", ") +
              "{\"text\": \"w\", \"top\": " + std::to_string(box.top) +
              ", \"left\": " + std::to_string(box.left) +
              ", \"height\": " + std::to_string(box.height) +
              ", \"width\": " + std::to_string(box.width) + "}";
    }
    return text + "]";
  }

  /// More parameters begin with a comma.
  std::string with_words(const std::string& more = "") {
    return "{words: \"" + write(json_of(words)) + "\"" + more + "}";
  }

  testing::PluginAnswer answer(const Shape& shape, const std::string& params) {
    plugins_.push_back(std::make_unique<testing::PluginUnderTest>("passes/flat_reference", params));
    if (auto prepared = plugins_.back()->prepare(templ, camera); !prepared) {
      return {
          WEFT_ERROR, prepared.error().code, prepared.error().message, prepared.error().where, {}};
    }
    return plugins_.back()->process(
        0, {testing::input("template", templ), testing::input("camera", camera),
            testing::input("image", image), testing::input("shape", shape)});
  }

  Registration measured(const Shape& shape, const std::string& params) {
    const testing::PluginAnswer out = answer(shape, params);
    EXPECT_EQ(out.status, WEFT_OK) << out.message;
    return out.get<Registration>().value_or(Registration{});
  }

  static int found_in(const Registration& made) {
    return static_cast<int>(std::count(made.found.data(), made.found.data() + made.count(), 1));
  }

  Template templ;
  Camera camera;
  Image image;
  std::vector<Box> words;

 private:
  std::vector<std::string> files_;
  std::vector<std::unique_ptr<testing::PluginUnderTest>> plugins_;  ///< answers live as long
};

}  // namespace weft::flat_reference
