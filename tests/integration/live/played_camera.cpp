// SPDX-License-Identifier: Apache-2.0
// Simulates printer, camera and hands of the reader of docs/tutorials/my-poster-live.md.
// `played_camera BOARD.pdf PRINT.png` writes images of an uncalibrated camera into the working
// folder. They show the printed board (board.avi), the printed poster on a table (poster.jpg), and
// the poster bent by two hands (film.avi). The program also writes the truth about all three
// (truth.json).
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "support/page_camera.hpp"

namespace weft::testing {
namespace {

constexpr std::uint64_t kSeed = 31;
constexpr double kPosterWidth_m = 0.297;
constexpr int kRaysASide = 2;

/// That of the tests of calibration, with more pixels.
Lens played_lens() {
  constexpr double kFiner = 1.5;
  Lens lens = usual_lens();
  lens.fx *= kFiner;
  lens.fy *= kFiner;
  lens.cx = kFiner * (lens.cx + 0.5) - 0.5;
  lens.cy = kFiner * (lens.cy + 0.5) - 0.5;
  lens.width_px = 960;
  lens.height_px = 720;
  return lens;
}

class Film {
 public:
  Film(const std::string& path, const Lens& lens, double fps)
      : writer_(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps,
                {lens.width_px, lens.height_px}) {
    if (!writer_.isOpened()) throw std::runtime_error("cannot write " + path);
  }
  void add(const cv::Mat& image) { writer_.write(image); }

 private:
  cv::VideoWriter writer_;
};

/// The board as a careful user holds it.
void film_board(const std::string& pdf_file, Rng& rng) {
  constexpr int kPxPerMm = 8, kViews = 24;
  constexpr double kFps = 5.0, kDistance_m = 0.4;
  std::ifstream stream(pdf_file, std::ios::binary);
  const std::string pdf{std::istreambuf_iterator<char>(stream), {}};
  if (pdf.empty()) throw std::runtime_error("cannot read " + pdf_file);
  cv::Mat page;
  cv::cvtColor(picture_of_page(pdf, kPxPerMm), page, cv::COLOR_GRAY2BGR);
  const PageCamera camera(played_lens(), page, kPxPerMm, kRaysASide);
  const Eigen::Vector2d middle_m = 5e-4 * Eigen::Vector2d(kPageWidth_mm, kPageHeight_mm);
  Film film("board.avi", played_lens(), kFps);
  for (int i = 0; i < kViews; ++i) {
    film.add(camera.image(good_pose(played_lens(), middle_m, kDistance_m, i, rng), rng));
  }
}

/// One frame of the film: rows of the pose, 3 x 4.
std::string truth_of(const BoardPose& camera_from_poster, double bend_per_m) {
  std::ostringstream text;
  text << std::setprecision(17) << "{\"bend_per_m\": " << bend_per_m
       << ", \"camera_from_poster\": [";
  for (int i = 0; i < 12; ++i) {
    text << (i == 0 ? "" : ", ") << camera_from_poster.matrix()(i / 4, i % 4);
  }
  text << "]}";
  return text.str();
}

/// The poster on a table, and then bent more and more; the truth of the film's frames.
std::string take_poster(const std::string& print_file, Rng& rng) {
  constexpr int kFrames = 30, kQuality = 92;
  constexpr double kFps = 10.0, kMostBend_per_m = 4.0;
  const cv::Mat print = cv::imread(print_file, cv::IMREAD_COLOR);
  if (print.empty()) throw std::runtime_error("cannot read " + print_file);
  const Lens lens = played_lens();
  const PageCamera camera(lens, print, 1e-3 * print.cols / kPosterWidth_m, kRaysASide);
  const Eigen::Vector2d middle_m(0.5 * kPosterWidth_m,
                                 0.5 * kPosterWidth_m * print.rows / print.cols);
  const BoardPose on_table = board_pose(lens, middle_m, {0.5, 0.5}, 0.45, {0.15, -0.25}, 0.06);
  if (!cv::imwrite("poster.jpg", camera.image(on_table, rng),
                   {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    throw std::runtime_error("cannot write poster.jpg");
  }
  Film film("film.avi", lens, kFps);
  std::string frames;
  for (int i = 0; i < kFrames; ++i) {
    const double share = static_cast<double>(i) / (kFrames - 1);
    const double bend_per_m = kMostBend_per_m * share;
    const Eigen::Vector2d place(0.5 + 0.04 * std::sin(2.0 * std::numbers::pi * share), 0.5);
    const BoardPose pose =
        board_pose(lens, middle_m, place, 0.46 - 0.03 * share, {0.2 * share, 0.1}, 0.05 * share);
    film.add(camera.image(pose, rng, bend_per_m));
    frames += (frames.empty() ? "" : ",\n") + truth_of(pose, bend_per_m);
  }
  std::ostringstream truth;
  truth << "{\"fx\": " << lens.fx << ", \"width_m\": " << kPosterWidth_m
        << ", \"height_m\": " << 2.0 * middle_m.y() << ",\n\"frames\": [\n"
        << frames << "]}\n";
  return truth.str();
}

void play(const std::string& board_file, const std::string& print_file) {
  Rng rng(kSeed);
  film_board(board_file, rng);
  std::ofstream truth("truth.json");
  if (!(truth << take_poster(print_file, rng) << std::flush)) {
    throw std::runtime_error("cannot write truth.json");
  }
}

}  // namespace
}  // namespace weft::testing

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: played_camera BOARD.pdf PRINT.png\n";
    return 2;
  }
  try {
    weft::testing::play(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "played_camera: " << error.what() << "\n";
    return 3;
  }
  std::cout << "board.avi\nposter.jpg\nfilm.avi\n";
  return 0;
}
