// SPDX-License-Identifier: Apache-2.0
// Runs `weft data make frex` from the marker sheet of paper to the sequence, as a user calls it.
#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/videoio.hpp>

#include "filmed_sheet.hpp"
#include "support/child.hpp"

namespace weft::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class FrexCommand : public ::testing::Test {
 protected:
  Ended weft(std::vector<std::string> words) const {
    words.insert(words.begin(), {WEFT_PROGRAM, "--plugin-path", WEFT_REAL_PLUGINS});
    return Child(std::move(words), folder_.path("said")).wait();
  }
  Ended print_sheet(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"data", "make", "frex", "--sheet", folder_.path(name)};
    words.insert(words.end(), more.begin(), more.end());
    return weft(std::move(words));
  }
  /// A film of the printed paper `name`.png, and its camera.
  void film(const std::string& name) const {
    PluginUnderTest source("sources/synthetic", "{texture: '" + folder_.path(name + ".png") +
                                                    "', width_m: 0.297, frames: 3}");
    static_cast<void>(source.process(kOpen, {}));
    cv::VideoWriter writer(folder_.path("film.avi"), cv::CAP_OPENCV_MJPEG,
                           cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30.0, {640, 480});
    for (std::uint64_t index = 0; index < 3; ++index) {
      cv::Mat picture;
      const auto image = source.process(kRead, {}, index).get<Image>();
      cv::cvtColor(view(image->pixels), picture, cv::COLOR_GRAY2BGR);
      writer.write(picture);
    }
    folder_.write("camera.yaml",
                  "{fx: 820, fy: 820, cx: 319.5, cy: 239.5, width: 640, height: 480}");
  }
  /// Textures the film; paths are names in the folder.
  Ended texture_film(const std::string& layout, const std::string& texture,
                     const std::string& camera = "camera.yaml") const {
    return weft({"data", "make", "frex", "--video", folder_.path("film.avi"), "--camera",
                 folder_.path(camera), "--layout", folder_.path(layout), "--texture",
                 folder_.path(texture), "--out", folder_.path("made")});
  }
  bool exists(const std::string& name) const { return fs::exists(folder_.path(name)); }

  FrameFolder folder_;
};

TEST_F(FrexCommand, TexturesAFilmOfThePrintedSheet) {
  const Ended printed = print_sheet("sheet.pdf", {"--seed", "3"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_TRUE(exists("sheet.pdf") && exists("sheet.yaml") && exists("sheet.png"));
  film("sheet");
  folder_.write_image("poster.png", cv::Mat(200, 400, CV_8UC3, cv::Scalar(20, 160, 240)));
  const Ended made = texture_film("sheet.yaml", "poster.png");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("3 frames, 0 failed"));
  const Ended info = weft({"data", "info", folder_.path("made")});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out, AllOf(HasSubstr("surface: 3 frames"), HasSubstr("all frames can be read")));

  // The layout of other markers: no frame has them, and nothing is left.
  fs::remove_all(folder_.path("made"));
  ASSERT_EQ(print_sheet("other.pdf", {"--seed", "4"}).exit_code, 0);
  const Ended strange = texture_film("other.yaml", "poster.png");
  EXPECT_EQ(strange.exit_code, 1);
  EXPECT_THAT(strange.err, AllOf(HasSubstr("film.avi"), HasSubstr("layout")));
  EXPECT_EQ(strange.out, "") << "nothing was made";
  EXPECT_FALSE(exists("made"));
}

TEST_F(FrexCommand, SaysWhatIsWrongAndLeavesNothing) {
  ASSERT_EQ(print_sheet("sheet.pdf").exit_code, 0);
  film("sheet");
  folder_.write_image("poster.png", cv::Mat(20, 40, CV_8UC1, cv::Scalar(20)));
  folder_.write("text.png", "no image");
  folder_.write("wrong.yaml",
                "marker_sheet: 1\nwidth_mm: 297\nheight_mm: 210\ndictionary: 5x5_250\n"
                "markers: [{id: 3}]\n");
  fs::create_directories(folder_.path("folder"));
  const auto refused = [&](const Ended& ended, const std::string& place, const std::string& fix) {
    EXPECT_EQ(ended.exit_code, 2) << place;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(place), HasSubstr(fix)));
    EXPECT_FALSE(exists("made")) << place;
  };
  refused(texture_film("none.yaml", "poster.png"), "none.yaml", "correct --layout");
  refused(texture_film("folder", "poster.png"), "folder", "correct --layout");
  refused(texture_film("camera.yaml", "poster.png"), "camera.yaml", "'width_mm'");
  refused(texture_film("wrong.yaml", "poster.png"), "wrong.yaml:5:", "'corners_mm'");
  refused(texture_film("sheet.yaml", "none.png"), "none.png", "correct --texture");
  refused(texture_film("sheet.yaml", "text.png"), "text.png", "image");
  refused(texture_film("sheet.yaml", "poster.png", "none.yaml"), "none.yaml", "'camera'");
  refused(print_sheet("more.txt"), "--sheet", ".pdf");
  refused(print_sheet("more.pdf", {"--out", folder_.path("made")}), "--sheet", "--out");
  refused(print_sheet("more.pdf", {"--frames", "3"}), "--sheet", "--frames");
  EXPECT_FALSE(exists("more.pdf"));
  EXPECT_EQ(print_sheet("none/more.pdf").exit_code, 3);
  fs::create_directories(folder_.path("more.pdf"));
  EXPECT_EQ(print_sheet("more.pdf").exit_code, 3);
  EXPECT_FALSE(exists("more.pdf.part") || exists("more.yaml"));
}

}  // namespace
}  // namespace weft::testing
