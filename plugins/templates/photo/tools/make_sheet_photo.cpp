// SPDX-License-Identifier: Apache-2.0
// Takes the photograph of pipelines/photo.yaml: make_sheet_photo PRINT.png PHOTO.jpg CAMERA.yaml
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "photographed.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: make_sheet_photo PRINT.png PHOTO.jpg CAMERA.yaml\n";
    return 2;
  }
  weft::photo::Still still;
  still.print = cv::imread(argv[1], cv::IMREAD_COLOR);
  if (still.print.empty()) {
    std::cerr << "make_sheet_photo: cannot read " << argv[1] << "\n";
    return 3;
  }
  still.height_m = still.width_m * still.print.rows / still.print.cols;
  still.camera = weft::photo::make_camera(1280, 960, true);
  still.table = weft::photo::Table::wood;
  still.table_grey = 120.0;
  still.distance_m = 0.42;
  still.tilt_rad = 0.35;
  still.turn_rad = -0.15;
  still.roll_rad = 0.08;
  still.aside_m = {0.01, -0.005};
  std::ofstream file(argv[3]);
  const weft::Camera& camera = still.camera.camera;
  file << "fx: " << camera.fx << "\nfy: " << camera.fy << "\ncx: " << camera.cx
       << "\ncy: " << camera.cy << "\nwidth: " << camera.width_px
       << "\nheight: " << camera.height_px << "\ndistortion: [";
  const char* separator = "";
  for (const double k : still.camera.coefficients) {
    file << separator << k;
    separator = ", ";
  }
  file << "]\n";
  const bool written =
      cv::imwrite(argv[2], weft::photo::photographed(still), {cv::IMWRITE_JPEG_QUALITY, 88});
  if (!file || !written) {
    std::cerr << "make_sheet_photo: cannot write " << argv[2] << " or " << argv[3] << "\n";
    return 3;
  }
  return 0;
}
