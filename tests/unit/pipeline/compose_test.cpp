// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <optional>
#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/pipeline/compose.hpp>

namespace weft {
namespace {

host::RecordPtr two_matches() {
  Correspondences matches;
  matches.template_px = matches.image_px = Array<double>({2, 2});
  matches.face = Array<std::int32_t>({2});
  matches.barycentrics = Array<double>({2, 3});
  matches.kept = Array<std::uint8_t>({2});
  matches.score = Array<double>({2});
  return host::Record::copy_of(matches);
}

/// The matches after a filter, which may say how sure it is.
host::RecordPtr filtered(const host::RecordPtr& matches, std::optional<double> confidence) {
  InlierMask mask{Array<std::uint8_t>({2}), Array<double>({2}), {}};
  if (confidence) mask.confidence = make_scalar(*confidence);
  return *with_mask(*matches, *host::Record::copy_of(mask));
}

std::optional<double> confidence_of(const host::RecordPtr& matches) {
  const auto noun = host::view_as<Correspondences>(*matches);
  if (!noun->confidence.present()) return std::nullopt;
  return *noun->confidence.data();
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

TEST(Compose, AShapeThatIsHeldClaimsNothing) {
  Shape shape;
  shape.vertices_m = Array<double>({2, 3});
  shape.source = Array<std::uint8_t>({2});
  shape.covariance_m2 = Array<double>({2, 3, 3});
  shape.confidence = 0.9;
  const host::RecordPtr aged = aged_shape(*host::Record::copy_of(shape), 1, 5);
  const Shape held = *host::view_as<Shape>(*aged);
  EXPECT_EQ(held.shape_state(), ShapeState::predicted);
  EXPECT_EQ(held.confidence, 0.0);
  EXPECT_FALSE(held.covariance_m2.present());
}

}  // namespace
}  // namespace weft
