// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/setup_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <weft/data/matrix.hpp>

#include "bent_sheets.hpp"

namespace weft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SeenSheet;

/// Frames by hand: a shape, and the matches that it was made from.
class SetupMonitorTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 2033;

  SetupMonitorTest() {
    std::cout << "seed " << kSeed << "\n";
    graph_.values.push_back({.slot = "correspondences", .stage = 0, .name = "filters"});
    graph_.values.push_back({.slot = "shape", .stage = 2, .name = "solvers"});
  }

  SetupMonitor watch(const Camera& given, bool is_sequence = true) const {
    return *SetupMonitor::create(*host::Record::copy_of(templ_), host::Record::copy_of(given),
                                 is_sequence);
  }

  FrameResult frame(const Correspondences& matches, const Points3* vertices_m) {
    FrameResult result;
    result.index = next_++;
    result.values = {host::Record::copy_of(matches), nullptr};
    if (vertices_m == nullptr) return result;
    Shape shape;
    shape.vertices_m = Array<double>({vertices_m->rows(), 3}, 0.0);
    shape.vertices_m.matrix<3>() = *vertices_m;
    shape.source = Array<std::uint8_t>({vertices_m->rows()}, 0);
    result.shape = host::Record::copy_of(shape);
    result.values[1] = result.shape;
    result.state = ShapeState::estimated;
    return result;
  }

  FrameResult sheet_frame(const Camera& given, double k1 = 0.0) {
    const SeenSheet seen =
        testing::see_bent_sheet(templ_, real_, given, k1, static_cast<int>(next_ % 6), rng_);
    return frame(seen.matches, &seen.vertices_m);
  }

  /// The first warnings of each frame: "", or the texts, each with a line break.
  std::vector<std::string> warnings_of(SetupMonitor& monitor, std::vector<FrameResult>& frames) {
    std::vector<std::string> warnings;
    for (FrameResult& frame : frames) {
      monitor.add(graph_, frame);
      std::string& text = warnings.emplace_back();
      for (const std::string& warning : frame.warnings) text += warning + "\n";
    }
    return warnings;
  }

  /// Frames of a surface that is longer by that share of its width, or of its height.
  std::vector<FrameResult> stretched_frames(int count, double by_width, double by_height) {
    std::vector<FrameResult> frames;
    for (int i = 0; i < count; ++i) {
      Template longer = testing::make_template(testing::kBentSpec);
      longer.vertices_m.matrix<3>().col(0) *= 1.0 + by_width;
      longer.vertices_m.matrix<3>().col(1) *= 1.0 + by_height;
      const SeenSheet seen = testing::see_bent_sheet(longer, real_, real_, 0.0, i % 6, rng_);
      frames.push_back(frame(seen.matches, &seen.vertices_m));
    }
    return frames;
  }

  std::vector<FrameResult> sheet_frames(int count, const Camera& given, double k1 = 0.0) {
    std::vector<FrameResult> frames;
    for (int i = 0; i < count; ++i) frames.push_back(sheet_frame(given, k1));
    return frames;
  }

  Graph graph_;
  Template templ_ = testing::make_template(testing::kBentSpec);
  Camera real_ = testing::make_camera();
  Rng rng_{kSeed};
  std::uint64_t next_ = 0;
};

TEST_F(SetupMonitorTest, SaysNothingOfASetUpThatIsRight) {
  SetupMonitor monitor = watch(real_);
  std::vector<FrameResult> frames = sheet_frames(12, real_);
  EXPECT_THAT(warnings_of(monitor, frames), ::testing::Each(IsEmpty()));
  EXPECT_THAT(monitor.warnings(), IsEmpty());
  for (const FrameResult& frame : frames) {
    EXPECT_EQ(frame.shape, frame.values[1]);
    EXPECT_EQ(frame.shape->view("").count, 5U) << "its record is that of the solver";
    EXPECT_EQ(frame.state, ShapeState::estimated);
    EXPECT_EQ(host::arrays_of<Shape>(*frame.shape)->confidence, 1.0);
    EXPECT_THAT(frame.reason, IsEmpty());
  }
}

TEST_F(SetupMonitorTest, MakesFramesWeakFromTheOneOnInWhichTheFocalLengthTurnsOutToBeWrong) {
  for (const double wrong : {1.3, 0.77}) {
    SCOPED_TRACE(wrong);
    next_ = 0;
    Camera given = real_;
    given.fx *= wrong;
    given.fy *= wrong;
    SetupMonitor monitor = watch(given);
    std::vector<FrameResult> frames = sheet_frames(6, given);
    warnings_of(monitor, frames);
    const std::map<std::string, double> found = [&] {
      const auto figures = monitor.camera();
      return std::map<std::string, double>(figures.begin(), figures.end());
    }();
    EXPECT_NEAR(std::log(found.at("focal_factor") * wrong), 0.0, 2.0 * found.at("focal_std"));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      SCOPED_TRACE(i);
      const auto shape = *host::view_as<Shape>(*frames[i].values[1]);
      EXPECT_EQ(frames[i].shape, frames[i].values[1]) << "sinks see the same";
      EXPECT_EQ(frames[i].state, shape.shape_state());
      EXPECT_EQ(frames[i].state, i < 2 ? ShapeState::estimated : ShapeState::weak);
      if (i < 2) continue;
      EXPECT_LT(shape.confidence, 0.05);
      EXPECT_THAT(frames[i].reason, HasSubstr("the focal length seems to be "));
      const auto* text = shape.others.find<std::uint8_t>("x.weft.reason");
      ASSERT_NE(text, nullptr);
      EXPECT_EQ(std::string(text->data(), text->data() + text->rows()), frames[i].reason);
    }
    ASSERT_EQ(monitor.warnings().size(), 1U);
    EXPECT_THAT(monitor.warnings()[0].text, HasSubstr("frames that are weak for that reason: 4"));
  }
}

TEST_F(SetupMonitorTest, BlamesNoCameraForAShapeThatTheSolverCallsWeakItself) {
  Camera given = real_;
  given.fx *= 1.3;
  given.fy *= 1.3;
  SetupMonitor monitor = watch(given);
  std::vector<FrameResult> frames = sheet_frames(4, given);
  for (FrameResult& frame : frames) frame.state = ShapeState::weak;
  warnings_of(monitor, frames);
  EXPECT_EQ(frames[3].state, ShapeState::weak);
  EXPECT_THAT(monitor.warnings()[0].text, ::testing::Not(HasSubstr("frames that are weak")));
}

TEST_F(SetupMonitorTest, ClaimsNothingOfTheCameraThatAStretchedSheetExplains) {
  for (const auto& [by_width, by_height] : std::vector<std::pair<double, double>>{
           {0.05, 0.0}, {0.0, 0.05}, {0.08, -0.02}, {0.05, 0.05}, {0.03, 0.0}}) {
    SCOPED_TRACE(std::to_string(by_width) + " by " + std::to_string(by_height));
    next_ = 0;
    SetupMonitor monitor = watch(real_);
    std::vector<FrameResult> frames = stretched_frames(30, by_width, by_height);
    warnings_of(monitor, frames);
    for (const FrameResult& frame : frames) {
      EXPECT_EQ(frame.state, ShapeState::estimated);
      const double confidence = host::arrays_of<Shape>(*frame.shape)->confidence;
      EXPECT_EQ(confidence, frame.reason.empty() ? 1.0 : 0.5) << frame.reason;
    }
    const bool is_silent = monitor.warnings().empty();
    EXPECT_TRUE(is_silent || by_width != by_height);
    EXPECT_FALSE(is_silent && by_width - by_height > 0.09);
    for (const RunWarning& warning : monitor.warnings()) {
      std::cout << warning.text << "\n";
      EXPECT_THAT(warning.text, ::testing::StartsWith("either "));
      EXPECT_THAT(warning.text, HasSubstr("or the surface stretches, by about "));
    }
  }
}

TEST_F(SetupMonitorTest, TellsAWrongFocalLengthOnceInAFrameAndAtTheEndWithItsFigures) {
  Camera given = real_;
  given.fx *= 1.25;
  given.fy *= 1.25;
  SetupMonitor monitor = watch(given);
  std::vector<FrameResult> frames = sheet_frames(6, given);
  const std::vector<std::string> warnings = warnings_of(monitor, frames);
  EXPECT_THAT(warnings[1], IsEmpty()) << "two frames are too few";
  EXPECT_THAT(warnings[2], HasSubstr("the focal length seems to be 0.8"));
  for (std::size_t i = 3; i < 6; ++i) EXPECT_THAT(warnings[i], IsEmpty());
  ASSERT_EQ(monitor.warnings().size(), 1U);
  EXPECT_EQ(monitor.warnings()[0].component, "setup");
  EXPECT_EQ(monitor.warnings()[0].frames, 6);
  EXPECT_THAT(monitor.warnings()[0].text, HasSubstr("times the one given, 1025 px"));
  for (const FrameResult& frame : frames) {
    ASSERT_FALSE(frame.setup.empty());
    EXPECT_EQ(frame.setup[0].first, "focal_factor");
    EXPECT_EQ(frame.setup[1].first, "focal_std");
    EXPECT_NEAR(frame.setup[0].second, 0.8, 3.0 * frame.setup[1].second);
    EXPECT_LT(frame.setup[1].second, 0.15);
  }
}

/// The error of a template is the same in all frames of a motionless object.
TEST_F(SetupMonitorTest, TakesFramesThatLookAlikeForOne) {
  Camera given = real_;
  given.fx *= 1.25;
  given.fy *= 1.25;
  SetupMonitor monitor = watch(given);
  std::vector<FrameResult> frames;
  for (int i = 0; i < 8; ++i) {
    const SeenSheet seen = testing::see_bent_sheet(templ_, real_, given, 0.0, 1, rng_);
    frames.push_back(frame(seen.matches, &seen.vertices_m));
  }
  EXPECT_THAT(warnings_of(monitor, frames), ::testing::Each(IsEmpty()));
}

TEST_F(SetupMonitorTest, TellsWrongProportionsAndALensThatBendsLines) {
  Camera given = real_;
  given.fx *= 1.1;
  SetupMonitor flattened = watch(given);
  std::vector<FrameResult> frames = sheet_frames(6, given);
  warnings_of(flattened, frames);
  ASSERT_EQ(flattened.warnings().size(), 1U);
  EXPECT_THAT(flattened.warnings()[0].text, ::testing::StartsWith("fx seems to be 0.9"));

  next_ = 0;
  given.fx = 1.25 * real_.fx;
  SetupMonitor squeezed = watch(given);
  frames = sheet_frames(6, given);
  warnings_of(squeezed, frames);
  ASSERT_EQ(squeezed.warnings().size(), 1U);
  EXPECT_THAT(squeezed.warnings()[0].text, ::testing::StartsWith("fx seems to be 0.8"));
  EXPECT_EQ(frames[5].state, ShapeState::weak) << "no sheet stretches by so much";

  next_ = 0;
  SetupMonitor bent = watch(real_);
  frames = sheet_frames(6, real_, -0.3);
  warnings_of(bent, frames);
  ASSERT_EQ(bent.warnings().size(), 1U);
  EXPECT_THAT(bent.warnings()[0].text, HasSubstr("the lens seems to bend straight lines"));
}

TEST_F(SetupMonitorTest, TellsAPrincipalPointThatIsOff) {
  Camera given = real_;
  given.cx += 60.0;
  SetupMonitor monitor = watch(given);
  std::vector<FrameResult> frames = sheet_frames(6, given);
  warnings_of(monitor, frames);
  ASSERT_EQ(monitor.warnings().size(), 1U);
  EXPECT_THAT(monitor.warnings()[0].text, HasSubstr("px left of and "));
}

/// The error is too small for a warning.
TEST_F(SetupMonitorTest, SaysOfAllFramesTogetherWhereThePrincipalPointLies) {
  Camera given = real_;
  given.cx += 12.0;
  given.cy -= 8.0;
  SetupMonitor monitor = watch(given);
  std::vector<FrameResult> frames = sheet_frames(6, given);
  EXPECT_THAT(monitor.camera(), IsEmpty());
  warnings_of(monitor, frames);
  EXPECT_THAT(monitor.warnings(), IsEmpty());
  std::map<std::string, double> found;
  for (const auto& [name, value] : monitor.camera()) found[name] = value;
  EXPECT_EQ(found["frames"], 6.0);
  EXPECT_NEAR(found["focal_factor"], 1.0, 0.02);
  for (const std::string way : {"centre_", "centre_alone_"}) {
    EXPECT_NEAR(found[way + "x_px"], -12.0, 5.0) << way;
    EXPECT_NEAR(found[way + "y_px"], 8.0, 5.0) << way;
    EXPECT_GT(found[way + "x_std_px"], 8.0) << "what frames have in common is in it: " << way;
    EXPECT_LT(found[way + "x_std_px"], 12.0) << way;
  }
}

/// The filter refuses such matches, so that no set that is filtered is there.
TEST_F(SetupMonitorTest, CountsFramesWhoseFilterHadNoResult) {
  graph_.values.push_back({.slot = "correspondences", .stage = 1, .name = "filters"});
  SetupMonitor monitor = watch(real_);
  std::vector<FrameResult> frames;
  for (int i = 0; i < 6; ++i) {
    const SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, i, rng_);
    frames.push_back(frame(seen.matches, nullptr));
    frames.back().values.push_back(nullptr);
  }
  warnings_of(monitor, frames);
  ASSERT_EQ(monitor.warnings().size(), 1U);
  EXPECT_THAT(monitor.warnings()[0].text, HasSubstr("recognised in 0 of 6 frames"));
}

TEST_F(SetupMonitorTest, MissesNoShapeWhereNothingSolves) {
  graph_.values.pop_back();
  SetupMonitor monitor = watch(real_);
  std::vector<FrameResult> frames;
  for (int i = 0; i < 6; ++i) {
    const SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, i, rng_);
    frames.push_back(frame(seen.matches, nullptr));
    frames.back().values.pop_back();
  }
  EXPECT_THAT(warnings_of(monitor, frames), ::testing::Each(IsEmpty()));
}

TEST_F(SetupMonitorTest, TellsThatTheTextureIsNotThatOfTheObject) {
  SetupMonitor monitor = watch(real_);
  std::vector<FrameResult> frames;
  for (int i = 0; i < 6; ++i) {
    SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, i, rng_);
    for (std::int64_t m = 8; m < seen.matches.count(); ++m) seen.matches.kept(m) = 0;
    for (std::int64_t m = 0; m < seen.matches.count(); ++m) {
      seen.matches.image_px(m, 0) = 640.0 * rng_.uniform();
    }
    frames.push_back(frame(seen.matches, nullptr));
  }
  const std::vector<std::string> warnings = warnings_of(monitor, frames);
  EXPECT_THAT(warnings[3], IsEmpty());
  EXPECT_THAT(warnings[4], HasSubstr("the texture was recognised in 0 of 5 frames"));
  ASSERT_EQ(monitor.warnings().size(), 1U);
}

TEST_F(SetupMonitorTest, TellsThatAnObjectIsTooFastToBeFollowed) {
  SetupMonitor monitor = watch(real_);
  std::vector<FrameResult> frames;
  for (int i = 0; i < 7; ++i) {
    SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, 1, rng_);
    seen.vertices_m.col(0).array() += 0.12 * i;
    frames.push_back(frame(seen.matches, &seen.vertices_m));
  }
  warnings_of(monitor, frames);
  ASSERT_EQ(monitor.warnings().size(), 1U);
  EXPECT_THAT(monitor.warnings()[0].text, HasSubstr("take more frames a second"));
}

TEST_F(SetupMonitorTest, TellsThatASecondPrintIsInViewOrThatAPartIsElsewhere) {
  for (const bool elsewhere : {false, true}) {
    next_ = 0;
    SetupMonitor monitor = watch(real_);
    std::vector<FrameResult> frames;
    for (int i = 0; i < 5; ++i) {
      SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, i, rng_);
      for (std::int64_t m = 0; m < seen.matches.count(); ++m) {
        const bool away = elsewhere ? seen.matches.template_px(m, 0) < 480.0 : m % 2 == 0;
        seen.matches.kept(m) = away ? 0 : 1;
        if (away) seen.matches.image_px(m, 1) += 300.0;
      }
      frames.push_back(frame(seen.matches, &seen.vertices_m));
    }
    warnings_of(monitor, frames);
    ASSERT_EQ(monitor.warnings().size(), 1U);
    EXPECT_THAT(monitor.warnings()[0].text,
                HasSubstr(elsewhere ? "lie elsewhere" : "second print"));
  }
}

TEST_F(SetupMonitorTest, MakesAnUnorderedImageOfTwoPrintsWeakAndNoOther) {
  constexpr int kImages = 14, kLate = 11;  // later ones than those that are looked at closely
  for (const bool is_sequence : {false, true}) {
    next_ = 0;
    SetupMonitor monitor = watch(real_, is_sequence);
    std::vector<FrameResult> frames;
    for (int i = 0; i < kImages; ++i) {
      SeenSheet seen = testing::see_bent_sheet(templ_, real_, real_, 0.0, i % 6, rng_);
      for (std::int64_t m = 0; (i == 1 || i == kLate) && m < seen.matches.count(); m += 2) {
        seen.matches.kept(m) = 0;
        seen.matches.image_px(m, 1) += 300.0;
      }
      frames.push_back(frame(seen.matches, &seen.vertices_m));
    }
    warnings_of(monitor, frames);
    for (int i = 0; i < kImages; ++i) {
      SCOPED_TRACE(i);
      const FrameResult& frame = frames[static_cast<std::size_t>(i)];
      const bool is_doubted = !is_sequence && (i == 1 || i == kLate);
      const auto shape = *host::view_as<Shape>(*frame.values[1]);
      EXPECT_EQ(frame.state, is_doubted ? ShapeState::weak : ShapeState::estimated);
      EXPECT_EQ(shape.shape_state(), frame.state);
      EXPECT_EQ(shape.confidence, is_doubted ? 0.5 : 1.0);
      EXPECT_EQ(frame.reason.starts_with("a second print"), is_doubted) << frame.reason;
    }
  }
}

TEST_F(SetupMonitorTest, DoesNotRaiseTheConfidenceOfAWrongCameraForASecondPrint) {
  Camera given = real_;
  given.fx *= 1.3;
  given.fy *= 1.3;
  SetupMonitor monitor = watch(given, false);
  std::vector<FrameResult> frames = sheet_frames(5, given);
  SeenSheet seen = testing::see_bent_sheet(templ_, real_, given, 0.0, 5, rng_);
  for (std::int64_t m = 0; m < seen.matches.count(); m += 2) {
    seen.matches.kept(m) = 0;
    seen.matches.image_px(m, 1) += 300.0;
  }
  frames.push_back(frame(seen.matches, &seen.vertices_m));
  warnings_of(monitor, frames);
  const auto before = *host::view_as<Shape>(*frames[4].values[1]);
  const auto last = *host::view_as<Shape>(*frames[5].values[1]);
  EXPECT_LT(before.confidence, 0.05) << "the focal length is known to be wrong";
  EXPECT_THAT(frames[5].reason, ::testing::StartsWith("a second print"));
  EXPECT_LT(last.confidence, 0.05);
  EXPECT_EQ(last.shape_state(), ShapeState::weak);
}

TEST_F(SetupMonitorTest, LooksLessAndLessOften) {
  SetupMonitor monitor = watch(real_);
  std::vector<std::uint64_t> looked;
  std::vector<FrameResult> frames = sheet_frames(30, real_);
  warnings_of(monitor, frames);
  for (const FrameResult& frame : frames) {
    if (!frame.setup.empty()) looked.push_back(frame.index);
  }
  EXPECT_THAT(looked, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 22, 27));
}

}  // namespace
}  // namespace weft
