// SPDX-License-Identifier: Apache-2.0
// The rule of `estimated` and `weak` holds for every solver, also for one without the C++ SDK.
#include "host/calling/judge_shape.hpp"

#include <gtest/gtest.h>

#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::host {
namespace {

/// A bent surface that matches show at the centres of all faces, and the record of its shape.
class JudgeShape : public ::testing::Test {
 protected:
  JudgeShape() {
    const Faces faces = templ_.faces.matrix<3>();
    const std::int64_t count = faces.rows();
    matches_.template_px = Array<double>({count, 2}, 0.0);
    matches_.image_px = Array<double>({count, 2}, 0.0);
    matches_.face = Array<std::int32_t>({count}, 0);
    matches_.barycentrics = Array<double>({count, 3}, 1.0 / 3.0);
    matches_.kept = Array<std::uint8_t>({count}, 1);
    matches_.score = Array<double>({count}, 0.0);
    const Eigen::Vector3d centre = Eigen::Vector3d::Constant(1.0 / 3.0);
    for (std::int64_t i = 0; i < count; ++i) {
      matches_.face(i) = static_cast<std::int32_t>(i);
      matches_.image_px.matrix<2>().row(i) =
          project(testing::pinhole(camera_), interpolate(vertices_m_, faces, i, centre))
              .transpose();
    }
  }

  /// The state after the host has judged a shape that is `off_m` behind the true one.
  ShapeState state_of(double off_m, ShapeState given = ShapeState::estimated,
                      double confidence = 0.9) {
    Shape shape;
    shape.vertices_m = make_array<double>(vertices_m_);
    for (std::int64_t i = 0; i < shape.vertices_m.rows(); ++i) shape.vertices_m(i, 0) += off_m;
    shape.state = static_cast<std::int32_t>(given);
    shape.confidence = confidence;
    shape.source = Array<std::uint8_t>({shape.vertices_m.rows()}, 1);
    record_ = Record::copy_of(shape);
    const RecordView<Template> templ("template", templ_);
    const RecordView<Camera> camera("camera", camera_);
    const RecordView<Correspondences> matches("correspondences", matches_);
    const weft_record inputs[] = {templ.raw(), camera.raw(), matches.raw()};
    EvidenceMemory memory;
    judge_shape(*record_, inputs, memory);
    return view_as<Shape>(*record_)->shape_state();
  }

  double evidence(const char* name) const {
    return view_as<Shape>(*record_)->diag.value(name, -1.0);
  }

  testing::SheetSpec spec_;
  Template templ_ = testing::make_template(spec_);
  Camera camera_ = testing::make_camera();
  Points3 vertices_m_ = testing::bent_vertices(
      templ_, testing::make_cylinder(spec_, 0.25, 0.3, {0.6, 0.0, 0.0, 0.2, -0.1, 0.0}));
  Correspondences matches_;
  std::shared_ptr<Record> record_;
};

TEST_F(JudgeShape, AShapeThatTheMatchesConfirmStaysEstimatedAndHasItsEvidence) {
  EXPECT_EQ(state_of(0.0), ShapeState::estimated);
  EXPECT_EQ(evidence("kept_matches"), static_cast<double>(matches_.count()));
  EXPECT_EQ(evidence("agreeing_matches"), static_cast<double>(matches_.count()));
  EXPECT_GT(evidence("agreeing_coverage"), 0.5);
}

TEST_F(JudgeShape, AShapeThatTheMatchesContradictIsWeakWhateverItsSolverStates) {
  EXPECT_EQ(state_of(0.1), ShapeState::weak);
  EXPECT_EQ(evidence("agreeing_matches"), 0.0);
}

TEST_F(JudgeShape, AStateOtherThanEstimatedIsKept) {
  EXPECT_EQ(state_of(0.0, ShapeState::weak), ShapeState::weak);
  EXPECT_EQ(state_of(0.0, ShapeState::predicted), ShapeState::predicted);
  EXPECT_EQ(state_of(0.1, ShapeState::lost), ShapeState::lost);
}

TEST_F(JudgeShape, AShapeOfLowConfidenceIsWeak) {
  EXPECT_EQ(state_of(0.0, ShapeState::estimated, 0.3), ShapeState::weak);
}

}  // namespace
}  // namespace weft::host
