// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/role.hpp>

/// What a role means to the host. Nothing else compares the name of a role or knows the number of a
/// method; what a role consumes and produces stands in weft/sdk/roles.hpp.
namespace weft {

/// Methods by their place in Role::methods.
inline constexpr int kOpenSource = 0, kCountFrames = 1, kReadFrame = 2;
inline constexpr int kOpenSink = 0, kWriteFrame = 1, kFinishSink = 2;
inline constexpr int kBuildTemplate = 0;
inline constexpr int kRunStage = 0;  ///< of every role whose components are stages
inline constexpr int kEvaluateWarp = 1;

/// Where components of a role stand in a pipeline file.
enum class PipelinePart { source, templ, stage, sink };

struct RoleRules {
  Role role;
  PipelinePart part = PipelinePart::stage;
  int frame_method = kRunStage;  ///< the method that takes a frame's data
  /// The values that each of its components adds to the graph; nothing where a component has a
  /// choice, which its manifest tells.
  std::optional<std::vector<std::string>> products = std::nullopt;
  bool sees_texture = false;  ///< runs once on the template's texture before the first frame too
  bool marks = false;      ///< gives a mask of its first input, of which the host makes the value
  bool samples = false;    ///< what it makes is evaluated: by the host at all vertices, by readers
  bool unites = false;     ///< takes several values of its first product at once
  bool gives_all = false;  ///< in each frame, all that its manifest says; others may lack some
  bool hands_on = false;   ///< of its product, what it reads is not yet used
  bool solves = false;     ///< makes the shape
  bool measures = false;   ///< may read the truth without saying so
  bool is_open = false;    ///< its components say themselves what they take, see open_slots.hpp

  const RoleMethod& main_method() const { return role.methods[to_index(frame_method)]; }
};

/// Of all roles, in the order in which data flow through them.
const std::vector<RoleRules>& all_role_rules();

/// Of a role's name; one without a name or any meaning where there is no such role.
const RoleRules& rules_of(std::string_view role);

/// Names of the roles whose components may stand there.
std::vector<std::string> roles_of(PipelinePart part);

/// The role of a component's id: "filters" of "filters/aem".
inline std::string role_of(std::string_view id) { return std::string(id.substr(0, id.find('/'))); }

/// The role of a component's id, the nearest one where it is misspelt: "filters" of "fitlers/x".
std::string role_meant(std::string_view id);

}  // namespace weft
