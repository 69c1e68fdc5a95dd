// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <weft/core/mistakes.hpp>
#include <weft/sdk/source.hpp>
#include <weft/sdk/template_builder.hpp>

#include "common/scene/sheet_renderer.hpp"
#include "film/view_truth.hpp"
#include "samples/looks.hpp"
#include "samples/random_sheet.hpp"
#include "samples/scenery.hpp"

namespace weft::frex {

/// Independent images of a flat object, each with its own shape, pose, light, background, occluders
/// and blur. Every frame depends on the seed and its number alone.
class SampleSource final : public Source {
 public:
  static constexpr About kAbout{.reference = "own: random developable surfaces (do Carmo 1976)",
                                .produces = "image ground_truth"};

  explicit SampleSource(Params& p);

  void check(Mistakes& mistakes) const;
  Result<Camera> open(const Call& call) override;
  std::int64_t count() const override { return frames_; }
  Result<SourceFrame> read(std::int64_t index, const Call& call) override;

 private:
  /// Parts that open() makes.
  struct Studio {
    scene::SheetRenderer renderer;
    Pinhole pinhole;
    RandomSheet sheet;
    Scenery scenery;
    Looks looks;
    TruthFrame truth;
  };

  Result<void> check_distances() const;
  scene::View look(const Points3& vertices_m, bool is_there, Rng& rng);

  TemplateComponent object_{"templates/rectangular"};
  std::int64_t frames_ = 1000;
  Camera camera_{410.0, 410.0, 0.0, 0.0, 320, 240};
  SheetRanges shapes_;
  LookRanges looks_;
  double empty_share_ = 0.08;
  int occluders_ = 3;
  std::string backgrounds_;
  bool dense_truth_ = true;
  std::int64_t seed_ = 1;
  std::optional<Studio> studio_;
};

}  // namespace weft::frex
