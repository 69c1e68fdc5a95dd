// SPDX-License-Identifier: Apache-2.0
// sources/images on a folder that another program fills meanwhile.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <future>
#include <utility>
#include <weft/data/image.hpp>
#include <weft/testing/mistakes.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "common/cameras/tests/frame_folder.hpp"
#include "encoded_frame.hpp"

namespace weft::images {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using weft::testing::encoded_frame;
using weft::testing::FrameFolder;
using weft::testing::kCount;
using weft::testing::kOpen;
using weft::testing::kRead;
using weft::testing::mistakes_of;
using weft::testing::PluginAnswer;
using weft::testing::PluginUnderTest;

constexpr double kPatient_s = 60.0;

void append(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::app) << bytes;
}

/// Simulates another program, which does one step each time the source checks for cancellation.
class Recorder {
 public:
  using Steps = std::vector<std::function<void()>>;

  explicit Recorder(PluginUnderTest& source) : source_(source) {
    source_.watch([this] {
      asks_since_stop_ += stop_ ? 1 : 0;
      if (done_ < steps_.size()) steps_[done_++]();
      return stop_;
    });
  }
  ~Recorder() { source_.watch(nullptr); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void does(Steps steps) {
    steps_ = std::move(steps);
    done_ = 0;
  }
  bool is_through() const { return done_ == steps_.size(); }
  /// Has the source stopped.
  void stop(bool wanted) {
    stop_ = wanted;
    asks_since_stop_ = 0;
  }
  int asks_since_stop() const { return asks_since_stop_; }

  static void nothing() {}

 private:
  PluginUnderTest& source_;
  Steps steps_;
  std::size_t done_ = 0;
  bool stop_ = false;
  int asks_since_stop_ = 0;
};

class GrowingFolderSource : public ::testing::Test {
 protected:
  GrowingFolderSource() {
    folder_.write_camera();
    fs::create_directory(folder_.path("frames"));
  }

  std::string path(const std::string& name) const { return folder_.path("frames/" + name); }
  void write(const std::string& name, int blue) const {
    folder_.write("frames/" + name, encoded_frame(name, blue));
  }
  std::string params(double wait_s, const std::string& pattern = "frames/*",
                     const std::string& more = "") const {
    return "{path: '" + folder_.path(pattern) + "', camera: '" + folder_.path("camera.yaml") +
           "', wait_s: " + std::to_string(wait_s) + more + "}";
  }

  static void open(PluginUnderTest& source) {
    const PluginAnswer opened = source.process(kOpen, {});
    ASSERT_EQ(opened.status, WEFT_OK) << opened.message;
    const auto count = source.process(kCount, {}).get<Count>();
    EXPECT_EQ(count->frames, -1);
    EXPECT_EQ(count->live, 1);
  }
  /// Blue value of the frame's first pixel; -1 where there is no frame.
  static int blue_of(PluginUnderTest& source, std::uint64_t frame) {
    const PluginAnswer answer = source.process(kRead, {}, frame);
    EXPECT_EQ(answer.status, WEFT_OK) << frame << ": " << answer.message;
    const auto image = answer.get<Image>();
    return image ? image->pixels.data()[0] : -1;
  }

  FrameFolder folder_;
};

TEST_F(GrowingFolderSource, GivesFilesInTheOrderOfTheirNamesAsTheyCome) {
  write("b.png", 2);
  write("a.png", 1);
  PluginUnderTest source("sources/images", params(kPatient_s, "frames/*.png", ", fps: 25"));
  Recorder recorder(source);
  open(source);
  EXPECT_EQ(blue_of(source, 0), 1);
  EXPECT_EQ(blue_of(source, 1), 2);
  recorder.does({Recorder::nothing, [&] { folder_.write("frames/c.txt", "no image"); },
                 Recorder::nothing, Recorder::nothing, [&] { write("d.png", 4); }});
  EXPECT_EQ(blue_of(source, 2), 4);
  EXPECT_TRUE(recorder.is_through()) << "it has waited";
  write("f.png", 6);
  write("e.png", 5);
  EXPECT_EQ(blue_of(source, 3), 5);
  write("e2.png", 55);  // when f.png is known already
  EXPECT_EQ(blue_of(source, 4), 55);
  const PluginAnswer last = source.process(kRead, {}, 5);
  EXPECT_EQ(last.get<Image>()->stem, "f");
  EXPECT_DOUBLE_EQ(last.get<Time>()->t_s, 5 / 25.0);
  EXPECT_EQ(blue_of(source, 1), 2) << "the file is still there";
}

TEST_F(GrowingFolderSource, GoesOnToAFrameThatIsFurtherOn) {
  PluginUnderTest source("sources/images", params(kPatient_s));
  Recorder recorder(source);
  open(source);
  recorder.does({[&] { write("a.png", 1); }, Recorder::nothing, Recorder::nothing,
                 [&] { write("b.png", 2); }});
  EXPECT_EQ(blue_of(source, 1), 2);
  EXPECT_EQ(blue_of(source, 0), 1);
}

TEST_F(GrowingFolderSource, DoesNotReadAFileThatIsStillBeingWritten) {
  for (const std::string name : {"a.png", "b.jpg", "c.bmp"}) {
    SCOPED_TRACE(name);
    fs::remove_all(folder_.path("frames"));
    fs::create_directory(folder_.path("frames"));
    PluginUnderTest source("sources/images", params(kPatient_s));
    Recorder recorder(source);
    open(source);
    const std::string bytes = encoded_frame(name, 200), file = path(name);
    const std::size_t half = bytes.size() / 2;
    const auto write_later = [&] { write("later" + name.substr(1), 7); };
    const bool tells_its_end = name != "c.bmp";
    recorder.does({[&] {
                     append(file, bytes.substr(0, half));
                     if (tells_its_end) write_later();
                   },
                   Recorder::nothing, Recorder::nothing,
                   [&] { append(file, bytes.substr(half, 1)); }, Recorder::nothing,
                   Recorder::nothing,
                   [&] {
                     append(file, bytes.substr(half + 1));
                     if (!tells_its_end) write_later();
                   }});
    const PluginAnswer frame = source.process(kRead, {}, 0);
    ASSERT_EQ(frame.status, WEFT_OK) << frame.message;
    EXPECT_TRUE(recorder.is_through());
    const cv::Mat whole = cv::imread(file, cv::IMREAD_UNCHANGED);
    const auto image = *frame.get<Image>();
    EXPECT_TRUE(std::equal(whole.datastart, whole.dataend, image.pixels.data()));
  }
}

TEST_F(GrowingFolderSource, ReadsWhatAThreadWritesPieceByPiece) {
  constexpr int kFrames = 40;
  PluginUnderTest source("sources/images", params(kPatient_s));
  open(source);
  const auto writing = std::async(std::launch::async, [&] {
    for (int i = 0; i < kFrames; ++i) {
      const std::string name = std::to_string(1000 + i) + ".png", bytes = encoded_frame(name, i);
      std::ofstream file(path(name), std::ios::binary);
      for (std::size_t at = 0; at < bytes.size(); at += 7)
        file << bytes.substr(at, 7) << std::flush;
    }
  });
  for (int i = 0; i < kFrames; ++i) EXPECT_EQ(blue_of(source, static_cast<std::uint64_t>(i)), i);
}

TEST_F(GrowingFolderSource, AFileThatStaysDamagedIsAnErrorOfItsFrameOnly) {
  folder_.write("frames/0.png", encoded_frame("0.png", 1).substr(0, 60));
  folder_.write("frames/1.png", "");
  fs::create_directory(path("2.png"));
  write("3.png", 3);
  PluginUnderTest source("sources/images", params(0.01));
  open(source);
  const std::vector<std::string> reasons{"cut off", "it is empty", "it is a folder"};
  for (std::uint64_t i = 0; i < reasons.size(); ++i) {
    const PluginAnswer frame = source.process(kRead, {}, i);
    EXPECT_EQ(frame.status, WEFT_ERROR) << i;
    EXPECT_THAT(frame.message, AllOf(HasSubstr(path(std::to_string(i))), HasSubstr(reasons[i])));
  }
  EXPECT_EQ(blue_of(source, 3), 3);
}

TEST_F(GrowingFolderSource, ReadsTheLastFileOfAFormatWithoutAnEndWhenItNoLongerGrows) {
  write("0.bmp", 50);
  PluginUnderTest source("sources/images", params(0.01));
  open(source);
  EXPECT_EQ(blue_of(source, 0), 50);
}

TEST_F(GrowingFolderSource, EndsWhenNoNewFileCameForSoLong) {
  write("0.png", 10);
  PluginUnderTest source("sources/images", params(0.01));
  open(source);
  EXPECT_EQ(blue_of(source, 0), 10);
  const PluginAnswer end = source.process(kRead, {}, 1);
  EXPECT_EQ(end.status, WEFT_END);
  EXPECT_THAT(end.message, HasSubstr("no new file for 'wait_s'"));
  write("1.png", 11);
  EXPECT_EQ(source.process(kRead, {}, 1).status, WEFT_END) << "an end is an end";
  EXPECT_EQ(source.process(kRead, {}, 7).status, WEFT_END);
  EXPECT_EQ(blue_of(source, 0), 10);
  open(source);
  EXPECT_EQ(blue_of(source, 1), 11) << "of a source that was opened again";
}

TEST_F(GrowingFolderSource, AFolderIntoWhichNothingComesIsAnErrorAndThenTheEnd) {
  PluginUnderTest source("sources/images", params(0.01, "frames/*.jpg"));
  open(source);
  write("0.png", 10);
  const PluginAnswer end = source.process(kRead, {}, 0);
  EXPECT_EQ(end.status, WEFT_ERROR);
  EXPECT_THAT(end.message, AllOf(HasSubstr("frames/*.jpg"), HasSubstr("no file came")));
  EXPECT_EQ(source.process(kRead, {}, 1).status, WEFT_END);
}

TEST_F(GrowingFolderSource, StopsAtOnceWhenItIsCancelledWhileItWaits) {
  PluginUnderTest source("sources/images", params(kPatient_s));
  Recorder recorder(source);
  open(source);
  recorder.does({Recorder::nothing, Recorder::nothing, Recorder::nothing, Recorder::nothing,
                 [&] { recorder.stop(true); }});
  EXPECT_EQ(source.process(kRead, {}, 0).status, WEFT_CANCELLED);
  EXPECT_LE(recorder.asks_since_stop(), 2);
  recorder.stop(false);
  write("0.png", 10);
  EXPECT_EQ(blue_of(source, 0), 10) << "that was not the end";
}

TEST_F(GrowingFolderSource, LeavesOutWhatSortsBeforeTheLastFileRead) {
  write("9.png", 9);
  PluginUnderTest source("sources/images", params(kPatient_s));
  Recorder recorder(source);
  open(source);
  EXPECT_EQ(blue_of(source, 0), 9);
  recorder.does({[&] { write("8.png", 8); }, Recorder::nothing, Recorder::nothing,
                 [&] { write("10.png", 10); }});
  EXPECT_EQ(blue_of(source, 1), 10);
}

TEST_F(GrowingFolderSource, EndsWithAnErrorWhereAllThatCameSortsBeforeTheLastFileRead) {
  write("9.png", 9);
  PluginUnderTest source("sources/images", params(0.01));
  open(source);
  EXPECT_EQ(blue_of(source, 0), 9);
  write("8.png", 8);
  write("08.png", 8);
  const PluginAnswer end = source.process(kRead, {}, 1);
  EXPECT_EQ(end.status, WEFT_ERROR);
  EXPECT_THAT(end.message, AllOf(HasSubstr("but 2 that sort before 9.png"),
                                 HasSubstr("in the order in which they arrive")));
  EXPECT_EQ(source.process(kRead, {}, 2).status, WEFT_END);
}

TEST_F(GrowingFolderSource, AFolderThatIsRemovedIsAnErrorAtOnceAndThenTheEnd) {
  write("0.png", 10);
  PluginUnderTest source("sources/images", params(kPatient_s));
  Recorder recorder(source);
  open(source);
  EXPECT_EQ(blue_of(source, 0), 10);
  recorder.does(
      {Recorder::nothing, Recorder::nothing, [&] { fs::remove_all(folder_.path("frames")); }});
  const PluginAnswer gone = source.process(kRead, {}, 1);
  EXPECT_EQ(gone.status, WEFT_ERROR);
  EXPECT_THAT(gone.message, AllOf(HasSubstr(folder_.path("frames")), HasSubstr("can no longer")));
  EXPECT_EQ(source.process(kRead, {}, 2).status, WEFT_END);
}

TEST_F(GrowingFolderSource, RefusesBeforeAnythingRunsWhatAFolderThatGrowsCannotHave) {
  write("0.png", 1);
  const auto expect_refused = [&](const std::string& text, const std::string& parameter,
                                  const std::string& reason) {
    EXPECT_THAT(mistakes_of("sources/images", text),
                ElementsAre(AllOf(HasSubstr(parameter + ": "), HasSubstr(reason))))
        << text;
    const PluginAnswer opened = PluginUnderTest("sources/images", text).process(kOpen, {});
    EXPECT_EQ(opened.status, WEFT_ERROR) << text;
    EXPECT_THAT(opened.message, HasSubstr(reason));
  };
  expect_refused(params(1, "frames"), "path", "is a folder: name its files");
  expect_refused(params(1, "frames/0.png"), "path", "names one file: with 'wait_s' give a pattern");
  expect_refused(params(1, "farmes/*.png"), "path", "does not exist: make it before the run");
  expect_refused(params(1, "f*/*.png"), "path", "may occur in the file name only");
  for (const std::string parameter : {"truth", "depth", "region"}) {
    expect_refused(params(1, "frames/*", ", " + parameter + ": '" + path("*.png") + "'"), parameter,
                   "'" + parameter + "' belongs to frames that are all there");
  }
  expect_refused(params(1, "frames/*", ", excluded: {a: why}"), "excluded",
                 "'excluded' belongs to frames that are all there");
  folder_.write_image("frames/0.png", cv::Mat(6, 9, CV_8UC3, cv::Scalar::all(1)));
  expect_refused(params(1), "camera", "0.png: is 9 x 6 px");
}

TEST_F(GrowingFolderSource, IsNotRefusedForFilesThatAreNotThereYet) {
  EXPECT_THAT(mistakes_of("sources/images", params(1)), IsEmpty());
  folder_.write("frames/0.png", encoded_frame("0.png", 1).substr(0, 60));
  EXPECT_THAT(mistakes_of("sources/images", params(1)), IsEmpty());
}

}  // namespace
}  // namespace weft::images
