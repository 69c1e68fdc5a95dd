// SPDX-License-Identifier: Apache-2.0
// Arrays that a detector keeps in device memory, in pipelines that can and cannot read there.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <weft/data/correspondences.hpp>

#include "support/pipeline_fixture.hpp"

namespace weft {
namespace {

using ::testing::HasSubstr;
using testing::head;
using testing::Ran;

constexpr double kBytes = 24.0 * 4.0 * 4.0;  // descriptors of one image

class Devices : public testing::PipelineTest {
 protected:
  static std::string pipeline(const std::string& matcher, const std::string& detector_params = "{}",
                              const std::string& matcher_params = "{}") {
    return "max_failed: 9\n" + head("{frames: 3}") +
           "stages:\n  - {use: detectors/test.device, params: " + detector_params +
           "}\n  - {use: matchers/" + matcher + ", params: " + matcher_params +
           "}\n  - {use: warps/test.scripted}\n  - {use: passes/test.scripted}\n"
           "  - {use: solvers/test.scripted}\n";
  }
  /// The message of a run that does not come to its first frame.
  std::string run_to_failure(const std::string& text) const {
    const Ran ran = run(text);
    return ran.summary ? "" : ran.summary.error().message;
  }
  /// 1 if the matcher read the descriptors where they lay, 0 if here, -1 without matches.
  static double read_there(const Ran& ran, std::size_t frame) {
    if (frame >= ran.frames.size()) return -1.0;
    for (const host::RecordPtr& record : ran.frames[frame].values) {
      if (record == nullptr || record->type() != Correspondences::kType) continue;
      return host::view_as<Correspondences>(*record)->score(0);
    }
    return -1.0;
  }
  static double downloaded(const Ran& ran, std::size_t frame) {
    return ran.number(frame, "matchers", "downloaded_bytes");
  }
};

TEST_F(Devices, AComponentOfTheSameLibraryReadsWhereTheArraysLie) {
  const Ran ran = run(pipeline("test.device"));
  for (std::size_t frame : {0, 1, 2}) {
    EXPECT_EQ(ran.status(frame, "matchers"), "ok");
    EXPECT_EQ(read_there(ran, frame), 1.0);
    EXPECT_TRUE(std::isnan(downloaded(ran, frame))) << "nothing is fetched";
  }
}

TEST_F(Devices, AnyOtherIsGivenACopyWhichIsCountedAndMadeOnce) {
  const Ran ran = run(pipeline("test.reading"));
  for (std::size_t frame : {0, 1, 2}) {
    EXPECT_EQ(ran.status(frame, "matchers"), "ok");
    EXPECT_EQ(read_there(ran, frame), 0.0);
  }
  EXPECT_EQ(downloaded(ran, 0), 2 * kBytes) << "those of the template too";
  EXPECT_EQ(downloaded(ran, 1), kBytes);
  EXPECT_EQ(downloaded(ran, 2), kBytes);
  const auto trace = nlohmann::json::parse(testing::read_text(ran.folder + "/trace.json"));
  double traced = 0.0;
  for (const auto& event : trace) {
    if (event["name"] == "matchers") traced += event["args"].value("downloaded_bytes", 0.0);
  }
  EXPECT_EQ(traced, 4 * kBytes);
  const auto lines = testing::read_lines(ran.folder + "/frames.jsonl");
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_THAT(lines[1], HasSubstr("\"downloaded_bytes\":384"));
}

TEST_F(Devices, NestedComponentsAreGivenWhatTheyCanRead) {
  const auto handing = [&](const std::string& params, const std::string& out) {
    return run(pipeline("test.handing", "{}", params), out);
  };
  EXPECT_EQ(read_there(handing("{reader: {use: matchers/test.device}}", "a"), 1), 1.0);
  EXPECT_EQ(read_there(handing("{reader: {use: matchers/test.reading}}", "b"), 1), 0.0);
  const Ran own = handing("{own: true}", "c");
  EXPECT_THAT(own.status(0, "matchers"), HasSubstr("'descriptors' in device memory that is no"));
}

TEST_F(Devices, WhatANestedComponentAnswersComesToWhereItsParentCanReadIt) {
  const Ran there = run(pipeline("test.finding"), "a");
  EXPECT_EQ(there.status(1, "matchers"), "ok");
  EXPECT_EQ(read_there(there, 1), 1.0);
  const Ran here = run(pipeline("test.finding_here"), "b");
  EXPECT_EQ(here.status(1, "matchers"), "ok");
  EXPECT_EQ(read_there(here, 1), 0.0);
  EXPECT_EQ(downloaded(here, 1), 2 * kBytes) << "the stage's keypoints, and its own";
  const Ran lost = run(pipeline("test.finding_here", "{}",
                                "{detector: {use: detectors/test.device, params: {lost_at: [1]}}}"),
                       "c");
  EXPECT_THAT(lost.status(1, "matchers"), HasSubstr("scripted loss"));
  EXPECT_EQ(lost.status(2, "matchers"), "ok");
}

TEST_F(Devices, WhatCannotBeFetchedCostsOneFrameAndNamesItsMaker) {
  const Ran ran = run(pipeline("test.reading", "{lost_at: [1], nan_there_at: [2]}"));
  EXPECT_EQ(ran.status(0, "matchers"), "ok");
  const std::string what =
      "error: detectors/test.device: its array 'descriptors', which lies on a device, ";
  EXPECT_EQ(ran.status(1, "matchers"), what + "cannot be copied: scripted loss");
  EXPECT_EQ(ran.status(2, "matchers"), what + "holds NaN or infinity");
}

TEST_F(Devices, AComponentThatNamesNoMemoryOfItsOwnCannotLeaveAnArrayThere) {
  std::string text = pipeline("test.device");
  text.replace(text.find("detectors/test.device"), 21, "detectors/test.silent");
  const auto report = run_to_failure(text);
  EXPECT_THAT(report, HasSubstr("the array 'descriptors' of keypoints/1 cannot be an output"));
  EXPECT_THAT(report, HasSubstr("it has no device_memory table"));
}

TEST_F(Devices, OnlyWhatTheCatalogueAllowsMayLieThere) {
  const Ran ran = run(pipeline("test.device", "{scale_there_at: [1]}"));
  EXPECT_EQ(ran.status(0, "detectors"), "ok");
  EXPECT_THAT(ran.status(1, "detectors"),
              HasSubstr("the host refused its array 'scale_px' of keypoints/1: it lies in device "
                        "memory"));
}

}  // namespace
}  // namespace weft
