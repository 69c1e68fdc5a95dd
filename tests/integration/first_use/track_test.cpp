// SPDX-License-Identifier: Apache-2.0
// weft track, typed as a new user would.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <weft/core/rng.hpp>

#include "integration/shelled_program.hpp"

namespace weft {
namespace {

using ::testing::AllOf;
using testing::Ended;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::read_lines;
using testing::read_text;

namespace fs = std::filesystem;

class Track : public testing::ShelledProgram {
 protected:
  /// Frames of the demo's surface in the folder frames; the surface always fills the same share of
  /// the image.
  void film_the_sheet(int frames = 4, double focal_px = 820.0) const {
    write(
        "weft: 1\n"
        "source:\n"
        "  use: sources/synthetic\n"
        "  params: {texture: " WEFT_TEXTURE ", width_m: 0.297, distance_m: " +
            std::to_string(0.45 * focal_px / 820.0) + ", frames: " + std::to_string(frames) +
            ", focal_px: " + std::to_string(focal_px) +
            "}\n"
            "template:\n"
            "  use: templates/rectangular\n"
            "  params: {texture: " WEFT_TEXTURE
            ", width_m: 0.297, columns: 13, rows: 9}\n"
            "sinks:\n  - {use: sinks/dataset, params: {path: film}}\n",
        "film.yaml");
    const Ended filmed = weft({"run", "film.yaml", "--out", "filmed", "--quiet"});
    ASSERT_EQ(filmed.exit_code, 0) << filmed.err;
    fs::rename(path("filmed/film/frames"), path("frames"));
  }

  Ended track(std::vector<std::string> more) const {
    std::vector<std::string> words{"track"};
    words.insert(words.end(), more.begin(), more.end());
    return weft(words);
  }

  std::string pipeline(const std::string& folder) const {
    return read_text(path(folder + "/track.yaml"));
  }

  int measured(const std::string& folder) const {
    int count = 0;
    for (const std::string& line : read_lines(path(folder + "/run/frames.jsonl"))) {
      count += line.find("\"estimated\"") != std::string::npos ||
               line.find("\"weak\"") != std::string::npos;
    }
    return count;
  }
};

TEST_F(Track, FindsAFlatObjectInFramesWithoutAPipelineFile) {
  film_the_sheet();
  const Ended ended = track({"frames", "--object", WEFT_TEXTURE, "--flat", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("frames_tracked/track.yaml"),
                               HasSubstr("in units of the object's width"),
                               HasSubstr("a sequence: their names are numbered"),
                               HasSubstr("frames_tracked/run/report.html")));
  EXPECT_THAT(ended.err, HasSubstr("not calibrated: the focal length is assumed"));
  EXPECT_THAT(ended.out, HasSubstr("found     in 4 of 4 frames\n"));
  EXPECT_EQ(measured("frames_tracked"), 4);
  for (const char* made : {"overlay.avi", "meshes", "report.html"}) {
    EXPECT_TRUE(fs::exists(path("frames_tracked/run/") + made)) << made;
  }
  EXPECT_THAT(read_text(path("frames_tracked/run/manifest.json")),
              AllOf(HasSubstr("\"assumed_camera\""), HasSubstr("\"focal_sd_px\"")));
  EXPECT_THAT(pipeline("frames_tracked"), AllOf(HasSubstr("width_m: 1,"), HasSubstr("camera: auto"),
                                                Not(HasSubstr("sequence"))));
  const Ended again = weft({"run", "frames_tracked/track.yaml", "--out", "again", "--quiet"});
  EXPECT_EQ(again.exit_code, 0) << "the pipeline may be changed and run again: " << again.err;
}

/// The frames have no camera data, and 0.75 longer sides are far from the assumed focal length.
TEST_F(Track, MeasuresTheFocalLengthWhereNothingSaysIt) {
  constexpr double kFocal_px = 480.0, kLongerSide_px = 640.0;
  film_the_sheet(20, kFocal_px);
  const Ended ended = track({"frames", "--object", WEFT_TEXTURE, "--flat", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("times the longer side, from "));
  const std::string text = pipeline("frames_tracked");
  const std::size_t at = text.find("focal_by_side: ");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(at + 15)), kFocal_px / kLongerSide_px,
              0.03 * kFocal_px / kLongerSide_px);
  EXPECT_FALSE(fs::exists(path("frames_tracked/camera")));
  EXPECT_THAT(ended.err, Not(HasSubstr("the focal length seems to be")));
  EXPECT_THAT(ended.out, HasSubstr("found     in 20 of 20 frames\n"));
}

TEST_F(Track, TakesImagesOfSeveralSizesForUnordered) {
  film_the_sheet();
  const std::string first = path("frames") + "/000000.png";
  ASSERT_TRUE(fs::exists(first)) << "the test knows how frames are named";
  const cv::Mat image = cv::imread(first);
  cv::imwrite(first, image(cv::Rect(10, 0, image.cols - 30, image.rows - 8)));
  const Ended ended = track({"frames", "--object", WEFT_TEXTURE, "--flat", "--width", "0.297",
                             "--out", "out", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("unordered images: they have several sizes"),
                               Not(HasSubstr("in units"))));
  EXPECT_THAT(pipeline("out"), AllOf(HasSubstr("sequence: false"), HasSubstr("width_m: 0.297")));
  EXPECT_EQ(measured("out"), 4);
  EXPECT_THAT(ended.out, HasSubstr("out/run/unwarped\n"));
  EXPECT_TRUE(fs::exists(path("out/run/unwarped/000003.png")));
}

TEST_F(Track, IsMeasuredAgainstTheFlatPrintAfterwards) {
  film_the_sheet();
  const Ended ended = track({"frames", "--object", WEFT_TEXTURE, "--flat", "--width", "0.297",
                             "--out", "out", "--quiet", "--unordered"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(read_text(path("out/run/report.html")), Not(HasSubstr("id=\"flat-print\"")));
  const auto eval = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"eval", "out/run", "--frames"};
    words.insert(words.end(), more.begin(), more.end());
    return weft(words);
  };
  const Ended unsaved = eval({"--no-save", "--flat-reference"});
  EXPECT_EQ(unsaved.exit_code, 0) << unsaved.err;
  EXPECT_THAT(unsaved.out, HasSubstr("within 1 mm %  displaced mm"));
  EXPECT_THAT(eval({}).out, Not(HasSubstr("within 1 mm"))) << "it was not kept";
  const Ended kept = eval({"--alignment", "all", "--flat-reference"});
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  const std::string first = "registration against the flat reference";
  EXPECT_EQ(eval({}).out.substr(eval({}).out.find(first)),
            unsaved.out.substr(unsaved.out.find(first)));
  ASSERT_EQ(weft({"report", "out/run"}).exit_code, 0);
  const std::string page = read_text(path("out/run/report.html"));
  EXPECT_THAT(page, AllOf(HasSubstr("Against the flat print, "), HasSubstr("id=\"flat-print\""),
                          HasSubstr("Worst frame, 00000"), HasSubstr("unwarped image</span>")));
}

TEST_F(Track, TakesTheRectangleInAPhotographForTheObject) {
  film_the_sheet();
  const Ended ended = track({"frames", "--object", WEFT_PHOTO, "--out", "out", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("the rectangle that was found in the photograph"));
  EXPECT_THAT(pipeline("out"), HasSubstr("use: templates/photo"));
  EXPECT_EQ(measured("out"), 4);
}

/// 240 x 180 px of grey blobs, as a table or a wall has them.
cv::Mat blobs() {
  constexpr std::uint64_t kSeed = 50;
  cv::Mat image(180, 240, CV_8U);
  Rng rng(kSeed);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(rng.below(256));
    }
  }
  cv::GaussianBlur(image, image, {}, 2.5);
  cv::normalize(image, image, 40, 220, cv::NORM_MINMAX);
  return image;
}

TEST_F(Track, SaysThatTheObjectIsInNoImage) {
  fs::create_directories(path("others"));
  cv::imwrite(path("others/table.png"), blobs());
  cv::imwrite(path("others/wall.png"), cv::Mat(180, 240, CV_8U, cv::Scalar(140)));
  // Another print: the photograph of another test's object.
  cv::Mat other = cv::imread(WEFT_OTHER_TEXTURE, cv::IMREAD_GRAYSCALE), small;
  ASSERT_FALSE(other.empty());
  cv::resize(other, small, {240, 180}, 0.0, 0.0, cv::INTER_AREA);
  cv::imwrite(path("others/print.png"), small);
  const Ended ended = track({"others", "--object", WEFT_TEXTURE, "--flat", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("found     in 0 of 3 frames"));
  EXPECT_THAT(ended.err, HasSubstr("the object was found in no frame"));
  EXPECT_EQ(measured("others_tracked"), 0);
}

TEST_F(Track, IsNotSureWhichOfTwoEqualSheetsIsMeant) {
  film_the_sheet();
  const cv::Mat first = cv::imread(path("frames/000000.png"));
  const cv::Mat last = cv::imread(path("frames/000003.png"));
  cv::Mat both, beside, table;
  cv::resize(blobs(), table, first.size());
  cv::cvtColor(table, table, cv::COLOR_GRAY2BGR);
  cv::hconcat(first, last, both);
  cv::hconcat(first, table, beside);
  fs::create_directories(path("pair"));
  cv::imwrite(path("pair/both.png"), both);
  cv::imwrite(path("pair/beside.png"), beside);
  const Ended ended = track({"pair", "--object", WEFT_TEXTURE, "--flat", "--quiet"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (const std::string& line : read_lines(path("pair_tracked/run/frames.jsonl"))) {
    const bool has_two = line.find("\"both\"") != std::string::npos;
    EXPECT_THAT(line, HasSubstr(has_two ? "\"weak\"" : "\"estimated\""));
    EXPECT_EQ(line.find("a second print") != std::string::npos, has_two) << line;
  }
}

TEST_F(Track, SaysWhatIsWrongBeforeAnythingIsWritten) {
  write("no picture", "object.txt");
  write("no film", "film.avi");
  write("", "nothing.mp4");
  fs::create_directories(path("empty"));
  fs::create_directories(path("taken"));
  write("precious", "taken/file");
  struct Case {
    std::vector<std::string> words;
    std::string place, what;
  };
  const std::string object = WEFT_TEXTURE;
  for (const Case& wrong : {
           Case{{"none.avi", "--object", object}, "none.avi", "there is no such file or folder"},
           Case{{"film.avi", "--object", "none.png"}, "none.png", "there is no such file"},
           Case{{"film.avi", "--object", "object.txt"}, "object.txt", "no readable image"},
           Case{{"film.avi", "--object", object}, "film.avi", "is no video"},
           Case{{"nothing.mp4", "--object", object}, "nothing.mp4", "is no video"},
           Case{{"empty", "--object", object}, "empty", "holds no images"},
           Case{{"film.avi", "--object", object, "--out", "taken"}, "taken", "choose another"},
           Case{{"film.avi", "--object", object, "--camera", "no.yaml"}, "no.yaml", "no such file"},
       }) {
    const Ended ended = track(wrong.words);
    EXPECT_NE(ended.exit_code, 0) << wrong.what;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(wrong.place), HasSubstr(wrong.what)));
    EXPECT_FALSE(fs::exists(path("film_tracked"))) << wrong.what;
    EXPECT_FALSE(fs::exists(path("empty_tracked"))) << wrong.what;
  }
  EXPECT_EQ(read_text(path("taken/file")), "precious");
}

}  // namespace
}  // namespace weft
