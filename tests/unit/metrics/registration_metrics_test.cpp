// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/registration_metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "test_run.hpp"

namespace weft::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Patches at these distances along u, NaN for one that was not found.
Registration at(const std::vector<double>& distances_mm) {
  Registration made;
  const auto count = static_cast<std::int64_t>(distances_mm.size());
  made.place_px = Array<double>({count, 2}, 0.0);
  made.displacement_mm = Array<double>({count, 2}, 0.0);
  made.correlation = Array<double>({count}, 0.5);
  made.found = Array<std::uint8_t>({count}, 0);
  for (std::int64_t i = 0; i < count; ++i) {
    made.displacement_mm(i, 0) = distances_mm[static_cast<std::size_t>(i)];
    made.found(i) = std::isnan(made.displacement_mm(i, 0)) ? 0 : 1;
  }
  return made;
}

const double kNotFound = std::nan("");

TEST(RegistrationMetrics, CountAPatchThatIsNotFoundAsNotWithinAnyDistance) {
  const FrameRegistration frame =
      frame_registration(at({0.5, 1.0, 1.5, -2.0, 3.0, kNotFound, 0.0, kNotFound}));
  EXPECT_EQ(frame.patches, 8);
  EXPECT_DOUBLE_EQ(frame.within_1mm_percent, 100.0 * 3 / 8);
  EXPECT_DOUBLE_EQ(frame.within_2mm_percent, 100.0 * 5 / 8);
  EXPECT_DOUBLE_EQ(frame.found_percent, 75.0);
  EXPECT_DOUBLE_EQ(frame.median_mm, 1.25);
  EXPECT_DOUBLE_EQ(frame.p90_mm, 2.5);
}

TEST(RegistrationMetrics, AreUnknownWithoutPatchesOrWithoutOneThatIsFound) {
  EXPECT_TRUE(std::isnan(frame_registration(at({})).within_1mm_percent));
  const FrameRegistration none = frame_registration(at({kNotFound}));
  EXPECT_EQ(none.found_percent, 0.0);
  EXPECT_EQ(none.within_2mm_percent, 0.0);
  EXPECT_TRUE(std::isnan(none.median_mm));
}

TEST(RegistrationMetrics, CountAllPatchesOfARunTheSame) {
  const RegistrationMetrics all = summarise_registration(
      {frame_registration(at({0.0, 0.0, 0.0})), frame_registration(at({4.0}))}, 5);
  EXPECT_EQ(all.frames, 2);
  EXPECT_EQ(all.frames_unmeasured, 3);
  EXPECT_EQ(all.patches, 4);
  EXPECT_DOUBLE_EQ(all.within_1mm_percent, 75.0);
  EXPECT_DOUBLE_EQ(all.median_mm, 0.0);
}

TEST(RegistrationMetrics, OfARunWithoutAnyAreUnknownAndNotPrinted) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  const RunMetrics metrics = evaluated(run);
  EXPECT_EQ(metrics.registration.frames, 0);
  EXPECT_EQ(metrics.registration.frames_unmeasured, 0);
  EXPECT_THAT(to_table(metrics), Not(HasSubstr("flat reference")));
}

TEST(RegistrationMetrics, AreReadFromTheRunFolderAndPrintedWithoutGroundTruth) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.add(ShapeState::none, std::nullopt, std::nullopt);
  Shape shape;
  shape.vertices_m = make_array<double>(run.vertices());
  shape.source = Array<std::uint8_t>({run.vertices().rows()}, 0);
  run.write_npz(TestRun::frame_name(0),
                {{"shape", host::Record::copy_of(shape)},
                 {"registration", host::Record::copy_of(at({0.5, 1.5, kNotFound, 0.5}))}});
  const RunMetrics metrics = evaluated(run);
  EXPECT_DOUBLE_EQ(metrics.registration.within_1mm_percent, 50.0);
  EXPECT_EQ(metrics.registration.frames_unmeasured, 1);
  EXPECT_THAT(to_table(metrics),
              HasSubstr("within 1 mm: 50.0 %, within 2 mm: 75.0 %, found: 75.0"));
  EXPECT_THAT(to_json(metrics), HasSubstr("\"registration_within_1mm_percent\": 50.0"));
}

TEST(RegistrationMetrics, HaveColumnsInTheTableOfFramesWhereAFrameHasThem) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.solved(1.0, std::nullopt);
  EXPECT_THAT(to_frames_table(evaluated(run)), Not(HasSubstr("within 1 mm")));
  run.measure({{1, at({0.5, 1.5, kNotFound, 0.5})}});
  const std::string table = to_frames_table(evaluated(run));
  EXPECT_THAT(table, HasSubstr("within 1 mm %  displaced mm"));
  EXPECT_THAT(table, HasSubstr("50.0          0.50\n"));
  EXPECT_THAT(table, Not(HasSubstr("reprojection"))) << "no frame has truth";
}

TEST(RegistrationMetrics, OfALaterMeasurementAreReadFromTheRunFolder) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.solved(1.0, std::nullopt);
  run.measure({{1, at({0.5, kNotFound})}});
  EXPECT_EQ(evaluated(run).registration.frames, 1);
  EXPECT_DOUBLE_EQ(*evaluated(run).frames[1].registration->distances_mm.begin(), 0.5);
  run.measure({});
  EXPECT_EQ(evaluated(run).registration.frames, 0) << "nothing could be measured";
  run.write_text("registration.npz", "PK damaged");
  const auto damaged = evaluate_run(run.folder());
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().where, HasSubstr("registration.npz"));
}

TEST(RegistrationMetrics, OfALaterMeasurementReplaceThoseOfAStage) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.solved(1.0, std::nullopt);
  for (const int frame : {0, 1}) {
    auto records = *host::read_npz(run.folder() + "/" + TestRun::frame_name(frame));
    records.emplace_back("registration", host::Record::copy_of(at({9.0})));
    run.write_npz(TestRun::frame_name(frame), records);
  }
  EXPECT_EQ(evaluated(run).registration.frames, 2);
  run.measure({{1, at({0.5, kNotFound})}});
  EXPECT_EQ(evaluated(run).registration.frames, 1);
  EXPECT_EQ(evaluated(run).registration.patches, 2);
}

TEST(RegistrationMetrics, OfAMeasurementReplaceThoseOfTheRunInSolvedFramesOnly) {
  TestRun run;
  run.solved(1.0, std::nullopt);
  run.add(ShapeState::predicted, run.vertices(), std::nullopt);
  const Registration measured = at({0.0, 5.0});
  std::vector<std::uint64_t> asked;
  EvaluationOptions options;
  options.measure_registration = [&](const FrameLine& line,
                                     const FrameRecords&) -> Result<std::optional<Registration>> {
    asked.push_back(line.frame);
    return std::optional<Registration>(measured);
  };
  const auto metrics = evaluate_run(run.folder(), options);
  ASSERT_TRUE(metrics) << metrics.error().message;
  EXPECT_THAT(asked, ::testing::ElementsAre(0U));
  EXPECT_EQ(metrics->registration.patches, 2);
  EXPECT_EQ(metrics->registration.frames_unmeasured, 1);
}

}  // namespace
}  // namespace weft::lab
