// SPDX-License-Identifier: Apache-2.0
// Draws the prints of the repository: make_texture FILE.png [map|weak|sole|insole [WIDTH HEIGHT
// SEED]]
#include <cstdlib>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "insole_photo.hpp"
#include "sheet_map.hpp"
#include "sole_print.hpp"
#include "weak_print.hpp"

int main(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[2] : "map";
  const auto draw = kind == "weak"     ? weft::texture::draw_weak_print
                    : kind == "insole" ? weft::texture::draw_insole_photo
                    : kind == "sole"   ? weft::texture::draw_sole_print
                    : kind == "map"    ? weft::texture::draw_map
                                       : nullptr;
  if ((argc != 2 && argc != 3 && argc != 6) || draw == nullptr) {
    std::cerr << "usage: make_texture FILE.png [map|weak|sole|insole [WIDTH HEIGHT SEED]]\n";
    return 2;
  }
  const int width = argc == 6 ? std::atoi(argv[3]) : 842;
  const int height = argc == 6 ? std::atoi(argv[4]) : 595;
  const auto seed = argc == 6 ? std::strtoull(argv[5], nullptr, 10) : 21;
  if (width < 400 || height < 280 || width > 10000 || height > 10000) {
    std::cerr << "make_texture: the texture must have 400 x 280 to 10000 x 10000 px\n";
    return 2;
  }
  auto pixels = draw(width, height, seed).pixels();
  const cv::Mat image(height, width, CV_8U, pixels.data());
  if (!cv::imwrite(argv[1], image, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
    std::cerr << "make_texture: cannot write " << argv[1] << "\n";
    return 3;
  }
  return 0;
}
