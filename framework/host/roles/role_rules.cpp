// SPDX-License-Identifier: Apache-2.0
#include "host/roles/role_rules.hpp"

#include <algorithm>
#include <weft/core/suggest.hpp>
#include <weft/sdk/roles.hpp>

namespace weft {

const std::vector<RoleRules>& all_role_rules() {
  static const std::vector<RoleRules> kRules{
      {.role = Source::role(), .part = PipelinePart::source, .frame_method = kReadFrame},
      {.role = TemplateBuilder::role(),
       .part = PipelinePart::templ,
       .frame_method = kBuildTemplate},
      {.role = Detector::role(),
       .products = {{"keypoints", "template_keypoints"}},
       .sees_texture = true},
      {.role = Matcher::role(),
       .products = {{"correspondences"}},
       .unites = true,
       .hands_on = true},
      {.role = Filter::role(), .products = {{"correspondences"}}, .marks = true, .hands_on = true},
      {.role = WarpModel::role(), .products = {{"warp", "warp_samples"}}, .samples = true},
      {.role = Pass::role(), .gives_all = true},
      {.role = {"stages", {{"run", {}, {}}}}, .gives_all = true, .is_open = true},
      {.role = Solver::role(), .products = {{"shape"}}, .solves = true},
      {.role = Sink::role(),
       .part = PipelinePart::sink,
       .frame_method = kWriteFrame,
       .measures = true},
  };
  return kRules;
}

const RoleRules& rules_of(std::string_view role) {
  static const RoleRules kNone{};
  for (const RoleRules& rules : all_role_rules()) {
    if (rules.role.name == role) return rules;
  }
  return kNone;
}

std::vector<std::string> roles_of(PipelinePart part) {
  std::vector<std::string> names;
  for (const RoleRules& rules : all_role_rules()) {
    if (rules.part == part) names.push_back(rules.role.name);
  }
  return names;
}

std::string role_meant(std::string_view id) {
  std::string role = role_of(id);
  if (!rules_of(role).role.name.empty()) return role;
  std::vector<std::string> names;
  for (const RoleRules& rules : all_role_rules()) names.push_back(rules.role.name);
  const std::string near = nearest(role, names);
  return near.empty() ? role : near;
}

}  // namespace weft
