// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/geometry/face_locator.hpp>

#include "host/records/record.hpp"

namespace weft {

/// Matches with a filter's verdict: kept only if kept before too, the filter's scores, the least
/// confidence of all filters; all other arrays are shared. Fails when the mask has another length.
/// Made in the pool where one is given.
Result<host::RecordPtr> with_mask(const host::Record& correspondences, const host::Record& mask,
                                  const std::shared_ptr<host::MemoryPool>& pool = nullptr);

/// Keypoints of the texture with the face that holds each and the weights in it.
Result<host::RecordPtr> locate_on_template(const host::Record& keypoints,
                                           const host::Record& templ);

/// Completes the matches that sources and matchers give; see Correspondences. One for all frames of
/// a template: it looks for faces with a grid that it makes when it is first needed.
class MatchPlacer {
 public:
  /// Its records are made in the pool where one is given.
  explicit MatchPlacer(host::RecordPtr templ, std::shared_ptr<host::MemoryPool> pool = nullptr)
      : template_(std::move(templ)), pool_(std::move(pool)) {}

  /// The record itself unless it has matches that lack something. Fails on template_xy_m for a
  /// template without m_per_px.
  Result<host::RecordPtr> place(host::RecordPtr record);

 private:
  Result<const FaceLocator*> locator();
  Result<Eigen::Array2d> m_per_px() const;

  host::RecordPtr template_;
  std::shared_ptr<host::MemoryPool> pool_;
  std::optional<FaceLocator> locator_;
};

/// The last shape again, `age` frames after it was measured: predicted, or lost from
/// `lost_after` + 1 on; with a confidence of 0 and no covariance, for nothing was measured.
host::RecordPtr aged_shape(const host::Record& shape, std::int64_t age, int lost_after,
                           const std::shared_ptr<host::MemoryPool>& pool = nullptr);

/// The shape with another state and confidence. The reason is its array "x.weft.reason", a text.
host::RecordPtr doubted_shape(const host::Record& shape, ShapeState state, double confidence,
                              std::string_view reason);

/// The texture as an image and its mask as a region, for detectors.
struct TextureInput {
  host::RecordPtr image;
  host::RecordPtr region;
};
Result<TextureInput> texture_input(const host::Record& templ);

}  // namespace weft
