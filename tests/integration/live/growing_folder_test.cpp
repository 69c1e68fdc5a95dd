// SPDX-License-Identifier: Apache-2.0
// Runs that read a folder while another program fills it.
#include <gmock/gmock.h>

#include <functional>

#include "common/cameras/tests/frame_folder.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::AllOf;
using testing::FrameFolder;
using ::testing::HasSubstr;

/// A run that does something behind each of its frames, and may be cancelled there.
struct RecordingRun : testing::Ran {
  void frame_done(const FrameResult& frame) override {
    Ran::frame_done(frame);
    if (frames.size() <= behind.size()) behind[frames.size() - 1]();
    cancel = frames.size() == cancelled_behind;
  }

  std::vector<std::function<void()>> behind;
  std::size_t cancelled_behind = 0;  ///< frames; 0 for never
  std::atomic<bool> cancel{false};
};

class GrowingFolderRun : public testing::PipelineTest {
 protected:
  GrowingFolderRun() {
    registry_ = host::Registry::scan({{WEFT_TEST_PLUGINS, "test"}, {WEFT_REAL_PLUGINS, "real"}});
    camera_.write_camera();
    std::filesystem::create_directory(camera_.path("frames"));
  }

  void run(const std::string& wait_s, const std::string& options, RecordingRun& ran) const {
    const auto [pipeline, report] =
        check("weft: 1\n" + options + "source: {use: sources/images, params: {path: '" +
              camera_.path("frames/*.png") + "', camera: '" + camera_.path("camera.yaml") +
              "', wait_s: " + wait_s + "}}\ntemplate: {use: templates/test.scripted}\n");
    ASSERT_TRUE(report.ok()) << report.text();
    ran.summary = run_pipeline(pipeline, "", ran, ran.cancel);
    ASSERT_TRUE(ran.summary) << ran.summary.error().message;
  }

  void take_picture(const std::string& name) const { camera_.write_frame("frames/" + name); }

  FrameFolder camera_;
};

TEST_F(GrowingFolderRun, TakesFilesThatComeWhileItRunsAndEndsAtOnceWhenItIsCancelled) {
  take_picture("0.png");
  RecordingRun ran;
  for (const char* name : {"1.png", "2.png", "3.png"}) {
    ran.behind.push_back([this, name] { take_picture(name); });
  }
  ran.cancelled_behind = 4;
  run("600", "", ran);
  EXPECT_EQ(ran.announced, -1);
  EXPECT_EQ(ran.summary->frames, 4);
  EXPECT_EQ(ran.summary->failed, 0);
  EXPECT_TRUE(ran.summary->cancelled);
  EXPECT_TRUE(ran.summary->warnings.empty());
}

TEST_F(GrowingFolderRun, WarnsOfAFileThatComesTooLate) {
  take_picture("9.png");
  RecordingRun ran;
  ran.behind.push_back([this] {
    take_picture("8.png");
    take_picture("10.png");
  });
  ran.cancelled_behind = 2;
  run("600", "", ran);
  EXPECT_EQ(ran.summary->frames, 2);
  ASSERT_EQ(ran.summary->warnings.size(), 1U);
  EXPECT_THAT(ran.summary->warnings[0].text,
              AllOf(HasSubstr("8.png: sorts before 9.png"), HasSubstr("in which they arrive")));
  EXPECT_EQ(ran.summary->warnings[0].frames, 1);
}

TEST_F(GrowingFolderRun, EndsBySayingThatAllFilesCameTooLate) {
  take_picture("9.png");
  RecordingRun ran;
  ran.behind.push_back([this] { take_picture("8.png"); });
  run("0.5", "", ran);
  EXPECT_EQ(ran.summary->frames, 2);
  EXPECT_EQ(ran.summary->failed, 1);
}

TEST_F(GrowingFolderRun, TakesTheNewestFileAndLosesNoneUncounted) {
  constexpr int kFiles = 30;
  for (int i = 0; i < kFiles; ++i) take_picture(std::to_string(100 + i) + ".png");
  RecordingRun ran;
  run("0.5", "realtime: latest\n", ran);
  EXPECT_EQ(ran.summary->frames + ran.summary->dropped, kFiles);
  EXPECT_EQ(ran.summary->failed, 0);
  ASSERT_FALSE(ran.frames.empty());
  EXPECT_EQ(ran.frames.back().index, kFiles - 1U) << "the last one is never dropped";
}

}  // namespace
}  // namespace weft
