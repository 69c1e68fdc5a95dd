// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/first_frame.hpp"

#include <Eigen/Geometry>
#include <weft/core/index.hpp>

#include "pipeline/execution/input.hpp"

namespace weft {
namespace {

std::int64_t count_kept(const Correspondences& matches) {
  std::int64_t kept = 0;
  for (std::int64_t i = 0; i < matches.count(); ++i) kept += matches.kept(i) != 0 ? 1 : 0;
  return kept;
}

double box_diagonal_px(const Correspondences& matches) {
  Eigen::AlignedBox2d box;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    box.extend(Eigen::Vector2d(matches.image_px(i, 0), matches.image_px(i, 1)));
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

/// The last matches of a frame, as filters left them.
Result<host::RecordPtr> matches_in(const PipelineConfig& config, const Graph& graph,
                                   host::ExecutionContext& context, const host::RecordPtr& templ,
                                   const host::RecordPtr& camera, const FrameInput& input) {
  const int value = graph.latest("correspondences");
  if (value < 0) {
    return Error{Errc::invalid_value,
                 "the pipeline has no matches to judge the template by: give it a matcher"};
  }
  auto executor = Executor::create(config, graph, context, templ, camera);
  if (!executor) return executor.error();
  FrameResult result = (*executor)->begin(input);
  const int last = graph.values[to_index(value)].stage;
  for (int stage = 0; stage <= last; ++stage) (*executor)->run_stage(to_index(stage), result);
  if (result.values[to_index(value)] != nullptr) return result.values[to_index(value)];
  return Error{Errc::no_result, "frame 0 has no matches: " + result.causes[to_index(value)].str()};
}

/// The matches of all frames that have some, which borrow from their records.
Result<std::vector<Correspondences>> matches_of(const FirstFrame& first) {
  std::vector<Correspondences> all;
  std::vector<host::RecordPtr> records = first.others;
  if (first.matches != nullptr) records.insert(records.begin(), first.matches);
  for (const host::RecordPtr& record : records) {
    auto matches = host::view_as<Correspondences>(*record);
    if (!matches) return matches.error();
    all.push_back(*std::move(matches));
  }
  return all;
}

}  // namespace

Result<FirstFrame> look_at_first_frame(const PipelineConfig& config, const Graph& graph,
                                       host::ExecutionContext& context, std::int64_t frames) {
  auto input = PipelineInput::open(config, context);
  if (!input) return input.error();
  const auto frame = input->read(0);
  if (!frame || !frame->input.failure.empty()) {
    return Error{Errc::no_result,
                 "frame 0 cannot be read: " + (frame ? frame->input.failure : "there is none")};
  }
  FirstFrame first;
  first.templ = input->templ();
  first.camera = input->camera();
  first.image = frame->input.find("image");
  auto given = matches_in(config, graph, context, first.templ, first.camera, frame->input);
  // A filter that accepts no set counts like one that keeps few matches.
  if (!given && given.error().code != Errc::no_result) return given.error();
  if (given) first.matches = *std::move(given);
  const auto templ = host::view_as<Template>(*first.templ);
  if (!templ) return templ.error();
  const auto camera = host::view_as<Camera>(*first.camera);
  if (!camera) return camera.error();
  if (first.matches != nullptr) {
    const auto matches = host::view_as<Correspondences>(*first.matches);
    if (!matches) return matches.error();
    first.look = {count_kept(*matches),
                  0,
                  box_diagonal_px(*matches),
                  fit_flipped(*templ, *camera, *matches),
                  {},
                  {}};
    const auto residuals = residuals_at_rest(*templ, *camera, *matches);
    if (residuals) first.look.field = fit_residual_field(*templ, *residuals);
  }
  const auto record = host::Record::copy_of(mirrored(*templ));
  if (record == nullptr) return Error{Errc::no_memory, "no memory for the mirrored texture"};
  const auto turned = matches_in(config, graph, context, record, first.camera, frame->input);
  if (turned) {
    const auto matches = host::view_as<Correspondences>(**turned);
    if (!matches) return matches.error();
    first.look.kept_mirrored = count_kept(*matches);
    first.look.fits_mirrored = fit_flipped(mirrored(*templ), *camera, *matches);
  }
  for (std::int64_t i = 1; i < frames; ++i) {
    const auto other = input->read(static_cast<std::uint64_t>(i));
    if (!other) break;
    if (!other->input.failure.empty()) continue;
    auto matches = matches_in(config, graph, context, first.templ, first.camera, other->input);
    if (matches) first.others.push_back(*std::move(matches));
  }
  auto photographs = matches_of(first);
  if (!photographs) return photographs.error();
  first.look.charts = chart_matches(*templ, *camera, *photographs);
  return first;
}

}  // namespace weft
