// SPDX-License-Identifier: Apache-2.0
// Draws the printed sheet of the demonstration: make_texture FILE.png [WIDTH HEIGHT SEED]
#include <cstdlib>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "sheet_map.hpp"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 5) {
    std::cerr << "usage: make_texture FILE.png [WIDTH HEIGHT SEED]\n";
    return 2;
  }
  const int width = argc == 5 ? std::atoi(argv[2]) : 842;
  const int height = argc == 5 ? std::atoi(argv[3]) : 595;
  const auto seed = argc == 5 ? std::strtoull(argv[4], nullptr, 10) : 21;
  if (width < 400 || height < 280 || width > 10000 || height > 10000) {
    std::cerr << "make_texture: the sheet must have 400 x 280 to 10000 x 10000 px\n";
    return 2;
  }
  auto pixels = weft::texture::draw_map(width, height, seed).pixels();
  const cv::Mat image(height, width, CV_8U, pixels.data());
  if (!cv::imwrite(argv[1], image, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
    std::cerr << "make_texture: cannot write " << argv[1] << "\n";
    return 3;
  }
  return 0;
}
