// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <weft/data/owned.hpp>

#include "host/calling/hashing.hpp"
#include "misbehaving/misbehaving.hpp"

namespace weft::host {
namespace {

using ::testing::HasSubstr;

class ExecutionContextTest : public ::testing::Test {
 protected:
  ExecutionContextTest() {
    templ_.vertices_m = Array<double>({3, 3}, 0.0);
    templ_.flat_px = Array<double>({3, 2}, 0.0);
    templ_.faces = Array<std::int32_t>({1, 3}, 0);
    templ_.texture = templ_.mask = Array<std::uint8_t>({2, 2}, 0);
  }

  Instance& instantiate(const std::string& id, const std::string& params = "{}",
                        const std::string& stage = "filters") {
    specs_.push_back(misbehaving::resolve(registry_, id, params));
    if (!specs_.back().spec) throw std::runtime_error(specs_.back().problem());
    const auto instance = context_.instantiate(*specs_.back().spec, stage);
    if (!instance) throw std::runtime_error(instance.error().message);
    return **instance;
  }

  Outcome filter(Instance& filter, std::uint64_t frame = 0, bool with_template = true) {
    const Correspondences matches = misbehaving::make_matches(4);
    const RecordView<Correspondences> view("correspondences", matches);
    const RecordView<Template> template_view("template", templ_);
    std::vector<weft_record> inputs{view.raw()};
    if (with_template) inputs.push_back(template_view.raw());
    return context_.call(filter, 0, inputs, frame);
  }

  double diag(const Outcome& outcome, const char* name) {
    if (!outcome.usable()) ADD_FAILURE() << outcome.error.message;
    return outcome.usable()
               ? view_as<InlierMask>(*outcome.find("inlier_mask"))->diag.value(name, -999.0)
               : 0.0;
  }

  const Registry registry_ = misbehaving::scan();
  std::deque<misbehaving::Resolved> specs_;
  ExecutionContext context_{7, {}};
  Template templ_;
};

TEST_F(ExecutionContextTest, RandomDrawsDependOnRunFrameAndStageOnly) {
  Instance& one = instantiate("filters/test_good");
  Instance& same_stage = instantiate("filters/test_good", "{count: 9}");
  Instance& other_stage = instantiate("filters/test_good", "{}", "filters#2");
  const double draw = diag(filter(one, 3), "first_draw");
  EXPECT_EQ(draw, Rng(component_seed(7, 3, "filters", "")).uniform());
  EXPECT_EQ(diag(filter(one, 3), "first_draw"), draw);
  EXPECT_EQ(diag(filter(same_stage, 3), "first_draw"), draw);
  EXPECT_NE(diag(filter(one, 4), "first_draw"), draw);
  EXPECT_NE(diag(filter(other_stage, 3), "first_draw"), draw);
}

TEST_F(ExecutionContextTest, ANestedFailureIsTheParentsWithTheNestedId) {
  Instance& parent = instantiate("filters/test_good",
                                 "{warp: {use: warps/test_shift, params: {always_fails: true}}}");
  const Outcome outcome = filter(parent);
  EXPECT_EQ(outcome.status, WEFT_NO_RESULT);
  EXPECT_EQ(outcome.error.code, Errc::no_result);
  EXPECT_EQ(outcome.error.message, "told to fail");
  EXPECT_EQ(outcome.error.where, "warps/test_shift");
}

TEST_F(ExecutionContextTest, ANestedWarpThatReturnsTooFewOrTooManySamplesIsCaught) {
  for (const std::string extra : {"-1", "1"}) {
    Instance& parent =
        instantiate("filters/test_good",
                    "{warp: {use: warps/test_shift, params: {extra_samples: " + extra + "}}}");
    const Outcome outcome = filter(parent);
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_EQ(outcome.error.where, "warps/test_shift");
    EXPECT_THAT(outcome.error.message, HasSubstr("entries for 4 of the input 'points'"));
  }
}

TEST_F(ExecutionContextTest, TimesEveryCallNestedOnesFirst) {
  filter(instantiate("filters/test_good"));
  std::vector<std::string> names;
  for (const Timing& timing : context_.times().take()) {
    names.push_back(timing.component);
    EXPECT_GE(timing.took.ms, 0.0);
  }
  EXPECT_THAT(names, ::testing::ElementsAre("filters/warp", "filters/warp", "filters"));
  EXPECT_TRUE(context_.times().take().empty());
}

TEST_F(ExecutionContextTest, GivesTheTimesOfOneFrameAndKeepsThoseOfOthers) {
  Instance& good = instantiate("filters/test_good");
  for (const std::uint64_t frame : {4U, 2U, 4U}) filter(good, frame);
  const auto frames_of = [](const Timings& timings) {
    std::vector<std::uint64_t> frames;
    for (const Timing& timing : timings) {
      if (timing.component == "filters") frames.push_back(timing.frame);
    }
    return frames;
  };
  EXPECT_THAT(frames_of(context_.times().take(4)), ::testing::ElementsAre(4, 4));
  EXPECT_TRUE(context_.times().take(4).empty());
  filter(good, kOfflineFrame);
  filter(good, 1);
  EXPECT_THAT(frames_of(context_.times().take()), ::testing::ElementsAre(1, 2, kOfflineFrame));
}

TEST_F(ExecutionContextTest, CountsProcessorTimeOfAllThreadsAndNoneOfWaiting) {
  filter(instantiate("filters/test_busy", "{threads: 3, each_ms: 10}"));
  filter(instantiate("filters/test_busy", "{threads: 0, sleep_ms: 40}"));
  const Timings timings = context_.times().take();
  ASSERT_EQ(timings.size(), 2U);
  EXPECT_GE(timings[0].took.processor_ms, 30.0);
  EXPECT_GE(timings[1].took.ms, 40.0);
  EXPECT_LT(timings[1].took.processor_ms, 40.0);
}

TEST_F(ExecutionContextTest, AFlaggedResultKeepsItsOutputsAndItsReason) {
  const misbehaving::TemporaryFolder folder;
  misbehaving::write_file(folder / "model", "");
  Instance& strict = instantiate("filters/test_strict",
                                 "{ratio: 0.25, rounds: 9, model: " + (folder / "model") + "}");
  const Outcome outcome = filter(strict, 0, false);
  EXPECT_EQ(outcome.status, WEFT_DEGENERATE);
  EXPECT_EQ(outcome.error.message, "keeps nothing");
  EXPECT_EQ(diag(outcome, "ratio"), 0.25);
  EXPECT_EQ(diag(outcome, "rounds"), 9.0);
}

TEST_F(ExecutionContextTest, RevisionsOfOutputsAreNeverUsedTwice) {
  Instance& good = instantiate("filters/test_good");
  std::set<std::uint64_t> revisions;
  for (int i = 0; i < 10; ++i) {
    const Outcome outcome = filter(good, 1);
    EXPECT_TRUE(revisions.insert(outcome.find("inlier_mask")->revision()).second);
  }
  EXPECT_EQ(revisions.count(0), 0U);
}

TEST_F(ExecutionContextTest, TwoContextsNeverGiveEqualRevisions) {
  ExecutionContext other(7, {});
  std::set<std::uint64_t> revisions;
  for (int i = 0; i < 5; ++i) {
    for (ExecutionContext* context : {&context_, &other}) {
      const auto matches = Record::copy_of(misbehaving::make_matches(2));
      ASSERT_TRUE(context->admit(*matches, "correspondences"));
      EXPECT_TRUE(revisions.insert(matches->revision()).second) << matches->revision();
    }
  }
  EXPECT_EQ(revisions.count(0), 0U);
  const auto matches = Record::copy_of(misbehaving::make_matches(2));
  ExecutionContext worker(7, {}, nullptr, kRevisionOfWorker);
  ASSERT_TRUE(worker.admit(*matches, "correspondences"));
  EXPECT_NE(matches->revision() & kRevisionOfWorker, 0U);
}

TEST_F(ExecutionContextTest, EqualTemplatesAndCamerasHaveEqualRevisionsInAllContexts) {
  ExecutionContext other(8, {}, nullptr, kRevisionOfWorker);
  const auto revision = [](ExecutionContext& context, const auto& typed) {
    const auto record = Record::copy_of(typed);
    const auto admitted = context.admit(*record, "record");
    EXPECT_TRUE(admitted) << (admitted ? "" : admitted.error().message);
    EXPECT_NE(record->revision(), 0U);
    return record->revision();
  };
  const std::uint64_t first = revision(context_, templ_);
  EXPECT_EQ(revision(other, templ_), first);
  Template changed = owned_record(templ_);
  changed.vertices_m(2, 1) = 0.001;
  EXPECT_NE(revision(context_, changed), first);
  Camera camera;
  camera.fx = camera.fy = 500.0;
  const std::uint64_t of_camera = revision(context_, camera);
  EXPECT_EQ(revision(other, camera), of_camera);
  camera.cx = 1.0;
  EXPECT_NE(revision(context_, camera), of_camera);
}

TEST_F(ExecutionContextTest, ANestedComponentIsGivenTheRevisionOfWhatItsParentPassesOn) {
  templ_.revision = 77;
  EXPECT_EQ(diag(filter(instantiate("filters/test_good")), "template_revision"), 77.0);
}

TEST_F(ExecutionContextTest, AWarpIsEvaluatedByItsProducer) {
  Instance& near = instantiate("warps/test_shift", "{shift_px: 1}", "warps");
  Instance& far = instantiate("warps/test_shift", "{shift_px: 100}", "warps#2");
  const Correspondences matches = misbehaving::make_matches(4);
  const RecordView<Correspondences> view("correspondences", matches);
  const RecordView<Template> template_view("template", templ_);
  const weft_record inputs[] = {view.raw(), template_view.raw()};
  Points points;
  points.xy_px = Array<double>({1, 2}, 0.0);
  for (const auto& [instance, shift] : {std::pair{&near, 1.0}, {&far, 100.0}}) {
    const Outcome fitted = context_.call(*instance, 0, inputs, 0);
    ASSERT_EQ(fitted.status, WEFT_OK) << fitted.error.message;
    const Outcome samples = context_.evaluate(*fitted.find("warp"), points, 0);
    ASSERT_EQ(samples.status, WEFT_OK) << samples.error.message;
    EXPECT_EQ(view_as<WarpSamples>(*samples.find("warp_samples"))->xy_px(0, 0), shift);
  }
  Warp orphan;
  orphan.domain_px = Array<double>({4}, 0.0);
  EXPECT_EQ(context_.evaluate(*Record::copy_of(orphan), points, 0).status, WEFT_ERROR);
}

}  // namespace
}  // namespace weft::host
