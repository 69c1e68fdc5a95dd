// SPDX-License-Identifier: Apache-2.0
// weft init, typed as a new user would.
#include <gmock/gmock.h>

#include "integration/shelled_program.hpp"

namespace weft {
namespace {

using testing::Ended;
using ::testing::HasSubstr;
using testing::read_text;
using ::testing::StartsWith;

namespace fs = std::filesystem;

class Init : public testing::ShelledProgram {
 protected:
  std::string pipeline() const { return read_text(path("mine/live.yaml")); }

  void expect_legal() const {
    const Ended checked = weft({"check", "mine/live.yaml"});
    EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err << pipeline();
  }
};

TEST_F(Init, MakesAFolderWithALegalPipelineOfAPicture) {
  const Ended ended = weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "0.297",
                            "--device", "7", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("Next: weft live mine/live.yaml"));
  EXPECT_THAT(pipeline(), HasSubstr("{device: 7}"));
  EXPECT_THAT(pipeline(), HasSubstr("width_m: 0.297"));
  EXPECT_EQ(read_text(path("mine/texture.png")), read_text(WEFT_TEXTURE));
  expect_legal();
}

TEST_F(Init, PointsEditorsToASchemaBesideThePipeline) {
  const Ended ended = weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "0.297",
                            "--device", "0", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(pipeline(), StartsWith("# yaml-language-server: $schema=pipeline.schema.json\n"));
  EXPECT_EQ(read_text(path("mine/pipeline.schema.json")), weft({"schema", "pipeline"}).out);
}

TEST_F(Init, AsksForWhatIsNotGiven) {
  write("fx: 500\nfy: 500\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n", "calibrated.yaml");
  const Ended ended =
      weft(R"(printf '%s\n0.2\n\n%s\n' ')" WEFT_TEXTURE R"(' calibrated.yaml | "$0" "$@")",
           {"init", "mine"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("Its printed width in metres"));
  EXPECT_THAT(pipeline(), HasSubstr("{device: 0, camera: camera.yaml}"));
  EXPECT_THAT(pipeline(), HasSubstr("width_m: 0.2,"));
  expect_legal();
}

TEST_F(Init, ReportsWhatIsMissingWithoutATerminal) {
  const Ended ended = weft(R"("$0" "$@" < /dev/null)", {"init", "mine"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("--picture: is missing"));
  EXPECT_FALSE(fs::exists(path("mine")));
}

TEST_F(Init, CanBeTypedAgainWhereANameWasMistyped) {
  const auto with_camera = [](const std::string& camera) {
    return std::vector<std::string>{"init",  "mine",     "--picture", WEFT_TEXTURE, "--width",
                                    "0.297", "--device", "0",         "--camera",   camera};
  };
  const Ended mistyped = weft(with_camera("none.yaml"));
  EXPECT_EQ(mistyped.exit_code, 2);
  EXPECT_THAT(mistyped.err, HasSubstr("none.yaml: there is no such file"));
  write("fx: 500\nfy: 500\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n", "camera.yaml");
  const Ended again = weft(with_camera("camera.yaml"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  expect_legal();
}

TEST_F(Init, RefusesAPictureThatIsNone) {
  write("no picture", "poster.png");
  const Ended ended = weft({"init", "mine", "--picture", "poster.png", "--width", "0.297",
                            "--device", "0", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("poster.png"));
  EXPECT_FALSE(fs::exists(path("mine")));
}

TEST_F(Init, TakesAFilmInPlaceOfACamera) {
  const std::vector<std::string> command{
      "init",  "mine",     "--picture", WEFT_TEXTURE, "--width",
      "0.297", "--camera", "",          "--video",    "it's, a film.avi"};
  const Ended mistyped = weft(command);
  EXPECT_EQ(mistyped.exit_code, 2);
  EXPECT_THAT(mistyped.err, HasSubstr("it's, a film.avi: there is no such file"));
  write("a film", "it's, a film.avi");
  const Ended ended = weft(command);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(pipeline(),
              HasSubstr("path: '" + fs::canonical(folder_).string() + "/it''s, a film.avi'"));
  EXPECT_THAT(pipeline(), ::testing::Not(HasSubstr("device")));
  const Ended checked = weft({"check", "mine/live.yaml"});
  EXPECT_THAT(checked.err, HasSubstr("it's, a film.avi: "));  // read, and found to be none
}

TEST_F(Init, GivesALivePipelineAFilmByOneOption) {
  ASSERT_EQ(weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "0.297", "--device", "0",
                  "--camera", ""})
                .exit_code,
            0);
  const Ended ended = weft({"live", "mine/live.yaml", "--video", "none.avi", "--no-browser"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, StartsWith("--video none.avi: "));
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("another camera")));
}

TEST_F(Init, AdvisesOnCamerasWhereTheCameraIsNotThere) {
  ASSERT_EQ(weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "0.297", "--device", "1023",
                  "--camera", ""})
                .exit_code,
            0);
  const Ended ended = weft({"live", "mine/live.yaml", "--no-browser"});
  EXPECT_NE(ended.exit_code, 0);
  EXPECT_THAT(ended.err, HasSubstr("/dev/video1023"));
  EXPECT_THAT(ended.err, HasSubstr("another camera"));
}

TEST_F(Init, TakesWhatTemplateMakeWrote) {
  const Ended made = weft({"template", "make", "--use", "templates/rectangular", "--set",
                           "texture=" WEFT_TEXTURE, "--set", "width_m=0.2", "--out", "sheet"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Ended ended =
      weft({"init", "mine", "--template", "sheet", "--device", "0", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(pipeline(), HasSubstr("mesh: template.obj"));
  expect_legal();
}

TEST_F(Init, LeavesAFolderAloneThatIsInUse) {
  fs::create_directories(path("mine"));
  write("precious", "mine/live.yaml");
  const Ended ended = weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "0.297",
                            "--device", "0", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_THAT(ended.err, HasSubstr("mine: exists and is not an empty folder"));
  EXPECT_EQ(pipeline(), "precious");
}

TEST_F(Init, NamesAnOptionThatIsNoLength) {
  const Ended ended = weft({"init", "mine", "--picture", WEFT_TEXTURE, "--width", "-1", "--device",
                            "0", "--camera", ""});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("--width: must be above 0 metres"));
}

}  // namespace
}  // namespace weft
