// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/compose.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <weft/data/correspondences.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft {
namespace {

host::RecordPtr two_matches() {
  Correspondences matches;
  matches.template_px = matches.image_px = Array<double>({2, 2}, 0.0);
  matches.face = Array<std::int32_t>({2}, 0);
  matches.barycentrics = Array<double>({2, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({2}, 0);
  matches.score = Array<double>({2}, 0.0);
  return host::Record::copy_of(matches);
}

/// The matches after a filter, which may report a confidence.
host::RecordPtr filtered(const host::RecordPtr& matches, std::optional<double> confidence) {
  InlierMask mask{Array<std::uint8_t>({2}, 0), Array<double>({2}, 0.0), {}};
  if (confidence) mask.confidence = make_scalar(*confidence);
  return *with_mask(*matches, *host::Record::copy_of(mask));
}

std::optional<double> confidence_of(const host::RecordPtr& matches) {
  const auto typed = host::view_as<Correspondences>(*matches);
  if (!typed->confidence.present()) return std::nullopt;
  return *typed->confidence.data();
}

TEST(Compose, MatchesHaveNoConfidenceUntilAFilterSaysOne) {
  EXPECT_EQ(confidence_of(two_matches()), std::nullopt);
  EXPECT_EQ(confidence_of(filtered(two_matches(), std::nullopt)), std::nullopt);
  EXPECT_EQ(confidence_of(filtered(two_matches(), 0.7)), 0.7);
}

TEST(Compose, TheLeastConfidenceOfTheFiltersStays) {
  const host::RecordPtr doubtful = filtered(two_matches(), 0.4);
  EXPECT_EQ(confidence_of(filtered(doubtful, 0.9)), 0.4);
  EXPECT_EQ(confidence_of(filtered(doubtful, 0.2)), 0.2);
  EXPECT_EQ(confidence_of(filtered(doubtful, std::nullopt)), 0.4);
}

/// Matches at these places without faces; if there are metres, they determine the places.
Correspondences unplaced(const Points2& places, bool in_metres) {
  Correspondences matches;
  const std::int64_t count = places.rows();
  matches.template_px = in_metres ? Array<double>({count, 2}, 0.0) : make_array<double>(places);
  if (in_metres) matches.template_xy_m = make_array<double>(places);
  matches.image_px = Array<double>({count, 2}, 0.0);
  matches.face = Array<std::int32_t>({count}, 0);
  std::fill_n(matches.face.data(), count, -1);
  matches.barycentrics = Array<double>({count, 3}, 0.0);
  matches.kept = Array<std::uint8_t>({count}, 0);
  matches.score = Array<double>({count}, 0.0);
  return matches;
}

TEST(Compose, MatchesOfWhichOnlyThePlaceIsKnownAreGivenTheirFaces) {
  const Template templ = testing::make_template();
  MatchPlacer placer(host::Record::copy_of(templ));
  const auto faces = templ.faces.matrix<3>();
  const Points2 flat_px = templ.flat_px.matrix<2>();
  Points2 places(faces.rows(), 2);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    places.row(f) = 0.2 * flat_px.row(faces(f, 0)) + 0.3 * flat_px.row(faces(f, 1)) +
                    0.5 * flat_px.row(faces(f, 2));
  }
  const auto placed = placer.place(host::Record::copy_of(unplaced(places, false)));
  ASSERT_TRUE(placed) << placed.error().message;
  const Correspondences matches = *host::view_as<Correspondences>(**placed);
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    EXPECT_EQ(matches.face(f), f);
    EXPECT_NEAR(matches.barycentrics(f, 0), 0.2, 1e-9);
    EXPECT_NEAR(matches.barycentrics(f, 1), 0.3, 1e-9);
    EXPECT_NEAR(matches.barycentrics(f, 2), 0.5, 1e-9);
  }
  EXPECT_TRUE(matches.template_px.matrix<2>() == places);
}

TEST(Compose, MatchesInMetresAreGivenTheirTexels) {
  const Template templ = testing::make_template();
  MatchPlacer placer(host::Record::copy_of(templ));
  Points2 places_m(2, 2);
  places_m << 100.0 * templ.m_per_px(0), 70.0 * templ.m_per_px(1), 20.5 * templ.m_per_px(0), 0.0;
  const auto placed = placer.place(host::Record::copy_of(unplaced(places_m, true)));
  ASSERT_TRUE(placed) << placed.error().message;
  const Correspondences matches = *host::view_as<Correspondences>(**placed);
  EXPECT_NEAR(matches.template_px(0, 0), 100.0, 1e-9);
  EXPECT_NEAR(matches.template_px(0, 1), 70.0, 1e-9);
  EXPECT_NEAR(matches.template_px(1, 0), 20.5, 1e-9);
  EXPECT_GE(matches.face(0), 0);
  EXPECT_FALSE(matches.template_xy_m.present()) << "readers need one place only";
}

TEST(Compose, MatchesBeyondTheTemplateStayOnNoFaceAndOthersAsTheyWere) {
  const Template templ = testing::make_template();
  MatchPlacer placer(host::Record::copy_of(templ));
  Points2 places(3, 2);
  places << -5000.0, 0.0, 100.0, 70.0, 100.0, 70.0;
  Correspondences given = unplaced(places, false);
  given.face(1) = 3;  // a given face is trusted
  given.barycentrics(1, 2) = 1.0;
  const auto placed = placer.place(host::Record::copy_of(given));
  ASSERT_TRUE(placed) << placed.error().message;
  const Correspondences matches = *host::view_as<Correspondences>(**placed);
  EXPECT_EQ(matches.face(0), -1);
  EXPECT_TRUE(matches.barycentrics.matrix<3>().row(0).isZero());
  EXPECT_EQ(matches.face(1), 3);
  EXPECT_EQ(matches.barycentrics(1, 2), 1.0);
  EXPECT_GE(matches.face(2), 0);
  given.face(0) = given.face(2) = 0;
  const host::RecordPtr complete = host::Record::copy_of(given);
  EXPECT_EQ(*placer.place(complete), complete) << "nothing is copied where nothing lacks";
}

TEST(Compose, MatchesInMetresAreRefusedForATemplateWithoutScale) {
  Template templ = testing::make_template();
  templ.m_per_px = {};
  MatchPlacer placer(host::Record::copy_of(templ));
  const auto placed = placer.place(host::Record::copy_of(unplaced(Points2::Zero(1, 2), true)));
  ASSERT_FALSE(placed);
  EXPECT_EQ(placed.error().message,
            "matches are in metres on a template that has no m_per_px: give template_px");
}

TEST(Compose, ACarriedOverShapeHasNoConfidence) {
  Shape shape;
  shape.vertices_m = Array<double>({2, 3}, 0.0);
  shape.source = Array<std::uint8_t>({2}, 0);
  shape.covariance_m2 = Array<double>({2, 3, 3}, 0.0);
  shape.confidence = 0.9;
  const host::RecordPtr aged = aged_shape(*host::Record::copy_of(shape), 1, 5);
  const Shape carried_over = *host::view_as<Shape>(*aged);
  EXPECT_EQ(carried_over.shape_state(), ShapeState::predicted);
  EXPECT_EQ(carried_over.confidence, 0.0);
  EXPECT_FALSE(carried_over.covariance_m2.present());
}

}  // namespace
}  // namespace weft
