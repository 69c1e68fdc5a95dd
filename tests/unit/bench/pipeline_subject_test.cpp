// SPDX-License-Identifier: Apache-2.0
#include "lab/bench/pipeline_subject.hpp"

#include <gmock/gmock.h>

#include "lab/bench/counts.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::bench {
namespace {

using testing::chain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Subjects : public testing::PipelineTest {
 protected:
  CheckedPipeline checked(const std::string& text, bool with_sinks = false) const {
    auto [pipeline, report] = check(text);
    EXPECT_TRUE(report.ok()) << report.text();
    return with_sinks ? std::move(pipeline) : without_sinks(std::move(pipeline));
  }

  Result<std::unique_ptr<PipelineSubject>> open(const std::string& text,
                                                std::int64_t frames) const {
    return PipelineSubject::open(checked(text), frames, never_);
  }

  const std::atomic<bool> never_{false};
};

TEST_F(Subjects, ReadEachFrameOnceAndRunItAsOftenAsWanted) {
  const auto subject = open(chain({{"sources", "{frames: 9}"}}), 4);
  ASSERT_TRUE(subject) << subject.error().message;
  EXPECT_EQ((*subject)->reading().size(), 4U);
  for (int repetition = 0; repetition < 3; ++repetition) {
    (*subject)->restart();
    for (std::int64_t frame = 0; frame < 4; ++frame) {
      const auto spent = (*subject)->run(frame);
      ASSERT_TRUE(spent) << spent.error().message;
      EXPECT_EQ(spent->parts.size(), 6U);
      double sum_ms = 0.0;
      for (const PartSpent& part : spent->parts) sum_ms += part.took.ms;
      EXPECT_LE(sum_ms, spent->whole.ms);
    }
  }
  EXPECT_EQ((*subject)->states().at("estimated"), 12);
}

TEST_F(Subjects, FeedNothingBackToTheFirstFrameOfARepetition) {
  // No shape in frame 0, so that its state indicates whether there was a frame before it.
  const auto subject = open(chain({{"matchers", "{no_result_at: [0]}"}}), 2);
  ASSERT_TRUE(subject) << subject.error().message;
  for (int repetition = 0; repetition < 2; ++repetition) {
    (*subject)->restart();
    ASSERT_TRUE((*subject)->run(0));
    ASSERT_TRUE((*subject)->run(1));
  }
  const std::map<std::string, std::int64_t> expected{{"estimated", 2}, {"none", 2}};
  EXPECT_EQ((*subject)->states(), expected);
}

TEST_F(Subjects, NameTheFrameAndTheStageOfAnError) {
  const auto subject = open(chain({{"filters", "{error_at: [1]}"}}), 3);
  ASSERT_TRUE(subject) << subject.error().message;
  EXPECT_TRUE((*subject)->run(0));
  const auto failed = (*subject)->run(1);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("frame 1: filters: "));
  EXPECT_THAT(failed.error().message, HasSubstr("scripted error"));
  EXPECT_THAT(failed.error().where, HasSubstr("pipeline.yaml"));
}

TEST_F(Subjects, TakeAsManyFramesAsAllHaveUnlessANumberIsAsked) {
  std::vector<std::unique_ptr<PipelineSubject>> subjects;
  for (const char* frames : {"{frames: 9}", "{frames: 5}"}) {
    auto subject = open(chain({{"sources", frames}}), 8);
    ASSERT_TRUE(subject) << subject.error().message;
    subjects.push_back(*std::move(subject));
  }
  const auto fewer = settled({6, 2, 5, 5}, subjects, false);
  ASSERT_TRUE(fewer) << fewer.error().message;
  EXPECT_EQ(fewer->frames, 3);
  const auto exact = settled({6, 2, 5, 5}, subjects, true);
  ASSERT_FALSE(exact);
  EXPECT_THAT(exact.error().message, HasSubstr("has 5 frames; 2 to warm up and 6 to measure"));
  EXPECT_FALSE(settled({6, 4, 5, 5}, subjects, false));
}

TEST_F(Subjects, OfASourceWithoutFramesCannotBeMeasured) {
  auto subject = open(chain({{"sources", "{frames: 0}"}}), 8);
  ASSERT_TRUE(subject) << subject.error().message;
  std::vector<std::unique_ptr<PipelineSubject>> subjects;
  subjects.push_back(*std::move(subject));
  const auto none = settled({6, 2, 5, 5}, subjects, false);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("has 0 frames"));
}

TEST_F(Subjects, CountNoAllocationsWithoutTheLibraryThatCounts) {
  const auto counts = count_here(checked(chain()), {2, 1, 1, 1}, never_);
  ASSERT_TRUE(counts) << counts.error().message;
  EXPECT_FALSE(counts->allocations);
  EXPECT_THAT(counts->parts, IsEmpty());
  EXPECT_GT(counts->loaded_kib, 0.0);
  EXPECT_GE(counts->peak_kib, counts->loaded_kib);
}

/// A record with one array of this size.
host::RecordPtr record_of(std::int64_t bytes) {
  auto record = std::make_shared<host::Record>("correspondences/1");
  record->allocate("bytes", WEFT_U8, 1, &bytes);
  return record;
}

TEST(Moved, CountsWhatIsReadAndWhatIsMadeAnew) {
  Graph graph;
  graph.values = {{"image", -1, "", 0, -1},
                  {"template", -1, "", 0, -1},
                  {"correspondences", 0, "filters", 0, -1}};
  const Node node{{{"image", 0, true}, {"template", 1, true}}, {2}, {}};
  FrameResult frame;
  const host::RecordPtr image = record_of(300);
  auto made = std::make_shared<host::Record>("correspondences/1");
  const std::int64_t bytes = 50;
  made->allocate("kept", WEFT_U8, 1, &bytes);
  made->share(*image, "bytes");  // handed on as it is
  frame.values = {image, record_of(7000), made};
  const Moved moved = moved_by(node, graph, frame);
  EXPECT_EQ(moved.in, 300U);
  EXPECT_EQ(moved.out, 50U);
}

TEST(Moved, CountsARecordThatIsReadTwiceOnce) {
  Graph graph;
  graph.values = {{"image", -1, "", 0, -1}, {"image", -1, "", 0, -1}};
  const Node node{{{"image", 0, true}, {"image", 1, false}}, {}, {}};
  FrameResult frame;
  frame.values = {record_of(300), nullptr};
  EXPECT_EQ(moved_by(node, graph, frame).in, 300U);
  frame.values[1] = frame.values[0];
  EXPECT_EQ(moved_by(node, graph, frame).in, 300U);
}

}  // namespace
}  // namespace weft::bench
