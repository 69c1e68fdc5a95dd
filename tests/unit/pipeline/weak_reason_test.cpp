// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/weak_reason.hpp"

#include <gtest/gtest.h>

#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>

#include "host/records/record.hpp"

namespace weft {
namespace {

/// A frame with one solver, whose inputs are optional matches (value 0) and sightlines (value 1),
/// and whose shape is value 2.
struct WeakFrame {
  Graph graph;
  FrameResult result;
  Shape shape;

  WeakFrame() {
    graph.values = {{"correspondences", -1, "", 0, -1},
                    {"sightlines", -1, "", 0, -1},
                    {"shape", 0, "solvers", 0, -1}};
    graph.stages = {Node{{{"correspondences", 0, false}, {"sightlines", 1, false}}, {2}, {}}};
    result.values.resize(3);
    shape.vertices_m = Array<double>({4, 3}, 1.0);
    shape.source = Array<std::uint8_t>({4}, 1);
    shape.state = static_cast<std::int32_t>(ShapeState::weak);
  }

  void add_matches() {
    Correspondences matches;
    matches.template_px = matches.image_px = Array<double>({1, 2}, 0.0);
    matches.face = Array<std::int32_t>({1}, 0);
    matches.barycentrics = Array<double>({1, 3}, 0.0);
    matches.kept = Array<std::uint8_t>({1}, 1);
    matches.score = Array<double>({1}, 1.0);
    result.values[0] = host::Record::copy_of(matches);
  }

  void add_sightlines() {
    Sightlines lines;
    lines.vertex = lines.face = Array<std::int32_t>({1}, 0);
    lines.barycentrics = Array<double>({1, 3}, 0.0);
    lines.pixel_px = Array<double>({1, 2}, 0.0);
    lines.ray = Array<double>({1, 3}, 0.0);
    lines.weight = Array<double>({1}, 1.0);
    result.values[1] = host::Record::copy_of(lines);
  }

  std::string reason(double agreeing, double kept, double coverage, double confidence) {
    Shape judged = shape;
    judged.confidence = confidence;
    judged.diag.set("agreeing_matches", agreeing);
    judged.diag.set("kept_matches", kept);
    judged.diag.set("agreeing_coverage", coverage);
    result.values[2] = host::Record::copy_of(judged);
    EXPECT_NE(result.values[2], nullptr);
    return weak_reason(graph, result, 2);
  }
};

TEST(WeakReason, IsTheCriterionThatMatchesFail) {
  WeakFrame frame;
  frame.add_matches();
  frame.add_sightlines();
  EXPECT_EQ(frame.reason(12, 40, 0.6, 0.9),
            "weak: only 12 of 40 matches agree with the shape, 30 are needed");
  EXPECT_EQ(frame.reason(100, 200, 0.18, 0.9),
            "weak: the agreeing matches cover 18 % of the visible surface, 25 % are needed");
  EXPECT_EQ(frame.reason(100, 200, 0.5, 0.04), "weak: confidence 0.04 is below 0.5");
}

TEST(WeakReason, CountsSightlinesWithoutMatches) {
  WeakFrame frame;
  frame.add_sightlines();
  EXPECT_EQ(frame.reason(6, 10, 0.6, 0.9),
            "weak: only 6 of 10 sightlines agree with the shape, 8 are needed");
  EXPECT_EQ(frame.reason(12, 40, 0.6, 0.9), "");
}

TEST(WeakReason, IsTheConfidenceWithoutEvidence) {
  WeakFrame frame;
  EXPECT_EQ(frame.reason(0, 0, 0.0, 0.3), "weak: confidence 0.30 is below 0.5");
  frame.shape.confidence = 0.2;
  frame.result.values[2] = host::Record::copy_of(frame.shape);  // a plugin without evidence
  EXPECT_EQ(weak_reason(frame.graph, frame.result, 2), "weak: confidence 0.20 is below 0.5");
}

TEST(WeakReason, IsEmptyWhereTheSolverItselfMarkedTheShape) {
  WeakFrame frame;
  frame.add_matches();
  EXPECT_EQ(frame.reason(100, 200, 0.5, 0.9), "");
}

}  // namespace
}  // namespace weft
