// SPDX-License-Identifier: Apache-2.0
// `weft calibrate`: the printed page, filmed by a camera that is known.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/videoio.hpp>
#include <optional>
#include <vector>

#include "common/cameras/camera_file.hpp"
#include "common/cameras/tests/frame_folder.hpp"
#include "support/child.hpp"
#include "support/lens.hpp"
#include "support/page_camera.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kViews = 20;

Ended weft(std::vector<std::string> words, const std::string& scratch) {
  words.insert(words.begin(), {WEFT_PROGRAM, "calibrate"});
  return Child(std::move(words), scratch).wait();
}

/// Images of the page, rendered once for all tests.
class CalibrateCommand : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 20;

  static void SetUpTestSuite() {
    folder_.emplace();
    const Ended printed = weft({"board", "--out", path("board.pdf")}, path("said"));
    ASSERT_EQ(printed.exit_code, 0) << printed.err;
    std::ifstream stream(path("board.pdf"), std::ios::binary);
    const std::string pdf{std::istreambuf_iterator<char>(stream), {}};
    constexpr int kPxPerMm = 8;  // so that all edges lie between pixels
    const PageCamera camera(lens(), picture_of_page(pdf, kPxPerMm), kPxPerMm);
    Rng rng(kSeed);
    const Eigen::Vector2d middle_m = 5e-4 * Eigen::Vector2d(kPageWidth_mm, kPageHeight_mm);
    for (int i = 0; i < kViews; ++i) {
      const cv::Mat image = camera.image(good_pose(lens(), middle_m, 0.4, i, rng), rng);
      folder_->write_image("good/" + std::to_string(10 + i) + ".png", image);
    }
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector2d place(0.25 + 0.25 * (i % 3), 0.25 + 0.25 * (i / 3));
      const BoardPose pose = board_pose(lens(), middle_m, place, 0.45, {0.01, 0.02}, 0.03 * i);
      folder_->write_image("parallel/" + std::to_string(i) + ".png", camera.image(pose, rng));
    }
    const cv::Mat plain(480, 640, CV_8U, cv::Scalar(128));
    for (int i = 0; i < 12; ++i) {
      folder_->write_image("plain/" + std::to_string(10 + i) + ".png", plain);
    }
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Lens lens() { return usual_lens(); }
  static std::string path(const std::string& name) { return folder_->path(name); }
  static std::vector<std::string> images(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator(path(folder))) names.push_back(file.path());
    std::sort(names.begin(), names.end());
    return names;
  }
  static Ended calibrate(std::vector<std::string> words, const std::string& out) {
    words.insert(words.end(), {"--out", path(out)});
    return weft(std::move(words), path("said"));
  }
  static void expect_refusal(std::vector<std::string> words, int exit_code,
                             const std::string& reason) {
    const Ended ended = calibrate(std::move(words), "refused.yaml");
    EXPECT_EQ(ended.exit_code, exit_code) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("error: "), HasSubstr(reason)));
    EXPECT_FALSE(fs::exists(path("refused.yaml")));
    EXPECT_FALSE(fs::exists(path("refused_residuals.png")));
  }
  static void expect_camera(const std::string& file, double focal_share, double centre_px) {
    const auto read = cameras::read_camera_file(path(file));
    ASSERT_TRUE(read) << read.error().message;
    const Lens truth = lens();
    EXPECT_NEAR(read->camera.fx, truth.fx, focal_share * truth.fx) << "seed " << kSeed;
    EXPECT_NEAR(read->camera.fy, truth.fy, focal_share * truth.fy) << "seed " << kSeed;
    EXPECT_NEAR(read->camera.cx, truth.cx, centre_px) << "seed " << kSeed;
    EXPECT_NEAR(read->camera.cy, truth.cy, centre_px) << "seed " << kSeed;
    EXPECT_EQ(read->camera.width_px, truth.width_px);
    EXPECT_EQ(read->camera.height_px, truth.height_px);
  }

  static std::optional<FrameFolder> folder_;
};

std::optional<FrameFolder> CalibrateCommand::folder_;

TEST_F(CalibrateCommand, FindsTheCameraThatTookTheImages) {
  const Ended ended = calibrate(images("good"), "camera.yaml");
  ASSERT_EQ(ended.exit_code, 0) << ended.err << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("20 of 20 images show the board"), HasSubstr("  fx "),
                               HasSubstr("+-"), HasSubstr("good/10.png")));
  expect_camera("camera.yaml", 0.002, 0.5);
  EXPECT_GT(fs::file_size(path("camera_residuals.png")), 1000U);
  EXPECT_EQ(calibrate(images("good"), "camera.yaml").exit_code, 3);  // it is there
}

TEST_F(CalibrateCommand, FindsTheCameraThatTookAVideo) {
  cv::VideoWriter film(path("film.avi"), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5.0,
                       {640, 480});
  for (const std::string& name : images("good")) film.write(cv::imread(name));
  film.release();
  const Ended ended = calibrate({path("film.avi")}, "filmed.yaml");
  ASSERT_EQ(ended.exit_code, 0) << ended.err << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("film.avi frame 19"));
  expect_camera("filmed.yaml", 0.004, 1.0);
}

TEST_F(CalibrateCommand, SaysWhatIsMissingWhereViewsDoNotDetermineACamera) {
  expect_refusal(images("parallel"), 1, "nearly parallel to the image");
  EXPECT_THAT(calibrate(images("parallel"), "refused.yaml").out,
              HasSubstr("missing: no view with the left side of the board farther away"));
  expect_refusal({path("good/10.png")}, 1, "1 image shows the board, and at least 8");
  expect_refusal(images("plain"), 1, "0 images show the board");
  EXPECT_THAT(
      calibrate(images("plain"), "refused.yaml").out,
      AllOf(HasSubstr("plain/10.png: no marker of the board is seen"), HasSubstr("and 2 more")));
}

TEST_F(CalibrateCommand, RefusesTheBoardThatIsNotTheOneOnTheImages) {
  auto words = images("good");
  words.insert(words.end(), {"--squares", "9x6"});
  expect_refusal(std::move(words), 1, "");
}

TEST_F(CalibrateCommand, RefusesFilesThatAreNoImagesOfOneCamera) {
  folder_->write("empty.png", "");
  folder_->write("text.png", "no image");
  folder_->write_image("small.png", cv::Mat(240, 320, CV_8U, cv::Scalar(128)));
  expect_refusal({path("good/10.png"), path("empty.png")}, 2, "empty.png");
  expect_refusal({path("good/10.png"), path("text.png")}, 2, "text.png: is no image");
  expect_refusal({path("good/10.png"), path("small.png")}, 2, "has 320 x 240 px, and ");
  expect_refusal({path("text.png")}, 2, "neither an image nor a video");
  expect_refusal({path("none.png")}, 3, "none.png");
  expect_refusal({"--camera", "4321"}, 3, "there is no such camera");
}

TEST_F(CalibrateCommand, RefusesArgumentsThatDoNotGoTogether) {
  expect_refusal({}, 2, "give images, a video or --camera N");
  expect_refusal({path("good/10.png"), "--camera", "0"}, 2, "give images, a video or --camera N");
  expect_refusal({path("good/10.png"), "--distortion", "3"}, 2, "--distortion: is 3");
  expect_refusal({path("good/10.png"), "--squares", "7"}, 2, "such as 7x5");
  const Ended without = weft({path("good/10.png")}, path("said"));
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("--out: is missing"));
  const Ended lost =
      Child({"/bin/sh", "-c", R"("$0" calibrate --help > /dev/full)", WEFT_PROGRAM}, path("said"))
          .wait();
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.err, HasSubstr("the standard output cannot be written"));
  const Ended help = weft({"--help"}, path("said"));
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("weft calibrate"));
}

TEST_F(CalibrateCommand, RefusesAPageThatCannotBePrinted) {
  const auto board = [](std::vector<std::string> words) {
    words.insert(words.begin(), "board");
    return weft(std::move(words), path("said"));
  };
  EXPECT_THAT(board({"--out", path("b.pdf"), "--square", "0.05"}).err, HasSubstr("--square 0.037"));
  EXPECT_THAT(board({"--out", path("b.png")}).err, HasSubstr("end with .pdf"));
  EXPECT_THAT(board({"--out", path("b.pdf"), "--paper", "a9"}).err, HasSubstr("a4, a3"));
  EXPECT_FALSE(fs::exists(path("b.pdf")));
  EXPECT_EQ(board({"--out", path("board.pdf")}).exit_code, 3);
  EXPECT_EQ(board({"--out", path("board.pdf"), "--overwrite"}).exit_code, 0);
}

}  // namespace
}  // namespace weft::testing
