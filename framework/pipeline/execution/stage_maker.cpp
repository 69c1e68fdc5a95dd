// SPDX-License-Identifier: Apache-2.0
#include "pipeline/execution/stage_maker.hpp"

#include "host/roles/role_rules.hpp"
#include "pipeline/execution/compose.hpp"

namespace weft {

using host::Instance;
using host::RecordPtr;

Result<Instance*> instantiate(host::ExecutionContext& context, const StageConfig& stage,
                              const host::ComponentSpec& component) {
  return stage.isolation ? context.instantiate_isolated(component, stage.name, *stage.isolation)
                         : context.instantiate(component, stage.name);
}

Result<MadeStage> StageMaker::make(const StageConfig& stage) const {
  const auto instance = prepared(stage, stage.component);
  if (!instance) return instance.error();
  if (!rules_of(stage.role).sees_texture) return MadeStage{*instance, nullptr};
  auto keypoints = keypoints_of(stage, **instance);
  if (keypoints) return MadeStage{*instance, *std::move(keypoints)};
  context.discard(**instance);
  return keypoints.error();
}

Result<Instance*> StageMaker::prepared(const StageConfig& stage,
                                       const host::ComponentSpec& component) const {
  const auto instance = instantiate(context, stage, component);
  if (!instance) return instance.error();
  const auto ready = context.prepare(**instance, *templ, *camera);
  if (ready) return *instance;
  context.discard(**instance);
  return ready.error();
}

/// Uses the component with `template_params`, where the stage has these.
Result<RecordPtr> StageMaker::keypoints_of(const StageConfig& stage, Instance& instance) const {
  if (!stage.on_template) return keypoints_by(stage, instance);
  const auto own = prepared(stage, *stage.on_template);
  if (!own) return own.error();
  auto keypoints = keypoints_by(stage, **own);
  context.discard(**own);
  return keypoints;
}

Result<RecordPtr> StageMaker::keypoints_by(const StageConfig& stage, Instance& instance) const {
  const auto texture = texture_input(*templ);
  if (!texture) return texture.error();
  const weft_record inputs[] = {texture->image->view("image"), texture->region->view("region")};
  const host::Outcome outcome = context.call(instance, kRunStage, inputs, host::kOfflineFrame);
  const std::string id = stage.component.component().id;
  if (!outcome.usable()) return Error{outcome.error.code, outcome.error.message, id};
  auto located = locate_on_template(*outcome.find("keypoints"), *templ);
  if (!located) return located.error();
  if (host::view_as<Keypoints>(**located)->count() == 0) {
    return Error{Errc::invalid_data,
                 "finds no keypoints on the template's texture; use a texture with more contrast "
                 "or another detector",
                 id};
  }
  return located;
}

}  // namespace weft
