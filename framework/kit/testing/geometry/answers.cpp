// SPDX-License-Identifier: Apache-2.0
#include "kit/testing/geometry/answers.hpp"

#include <algorithm>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/matrix.hpp>
#include <weft/testing/role_contract.hpp>

#include "kit/testing/contract_cases.hpp"

namespace weft::testing {
namespace {

std::set<std::string> left_out_of(const Subject& subject) {
  std::set<std::string> left_out;
  for (const char* slot : {"previous.shape", "known_points", "image", "object_mask"}) {
    if (subject.rules().solves && !subject.requires_input(slot)) left_out.insert(slot);
  }
  return left_out;
}

}  // namespace

Points2 inner_texels(const Template& templ) {
  const auto flat_px = templ.flat_px.matrix<2>();
  const Eigen::RowVector2d low = flat_px.colwise().minCoeff(), high = flat_px.colwise().maxCoeff();
  Rng rng(kContractSeed);
  Points2 points(25, 2);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (int k = 0; k < 2; ++k) {
      points(i, k) = low(k) + (high(k) - low(k)) * rng.uniform(0.2, 0.8);
    }
  }
  return points;
}

std::optional<Points2> warped(Performer& performer, const HostRecord& warp,
                              const Points2& texels_px) {
  const Answer answer = performer.evaluate(warp, {make_array<double>(texels_px), 0});
  const auto samples = answer.get<WarpSamples>("warp_samples");
  if (!samples) return std::nullopt;
  const Array<std::uint8_t>& valid = samples->valid;
  const bool all = std::all_of(valid.data(), valid.data() + valid.rows(), [](auto v) { return v; });
  if (!all) return std::nullopt;
  return Points2(samples->xy_px.matrix<2>());
}

Asked ask(const Subject& subject, const Scene& scene, const Points2& texels_px) {
  Performer performer(subject);
  if (const auto ready = performer.begin(scene.templ, scene.camera); !ready) {
    return {{WEFT_ERROR, ready.error().code, ready.error().message, {}}};
  }
  const auto inputs = inputs_of(subject, scene, left_out_of(subject));
  Asked asked{performer.call(kRunStage, inputs, 7)};
  const HostRecord warp = asked.answer.find("warp");
  if (warp != nullptr) asked.warped_px = warped(performer, warp, texels_px);
  return asked;
}

bool sees_pixels(const Subject& subject) {
  const auto left_out = left_out_of(subject);
  const auto gets = [&](const char* slot) {
    return subject.takes(slot) && left_out.count(slot) == 0;
  };
  return gets("image") || gets("object_mask");
}

}  // namespace weft::testing
