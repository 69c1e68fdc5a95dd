// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/sdk/role.hpp>

/// How the host treats each role. Other code neither compares the name of a role nor contains the
/// number of a method. The inputs and outputs of a role are defined in weft/sdk/roles.hpp.
namespace weft {

/// Methods by their place in Role::methods.
inline constexpr int kOpenSource = 0, kCountFrames = 1, kReadFrame = 2;
inline constexpr int kOpenSink = 0, kWriteFrame = 1, kFinishSink = 2;
inline constexpr int kBuildTemplate = 0;
inline constexpr int kRunStage = 0;  ///< method number, for every role whose components are stages
inline constexpr int kEvaluateWarp = 1;

/// The part of a pipeline file in which components of a role are listed.
enum class PipelinePart { source, templ, stage, sink };

struct RoleRules {
  Role role;
  PipelinePart part = PipelinePart::stage;
  int frame_method = kRunStage;  ///< the method that takes a frame's data
  /// The values that each of its components adds to the graph; empty if components have a choice,
  /// which their manifests declare.
  std::optional<std::vector<std::string>> products = std::nullopt;
  bool sees_texture = false;  ///< runs once on the template's texture before the first frame too
  bool marks = false;      ///< gives a mask of its first input, from which the host makes the value
  bool samples = false;    ///< its product is a function: the host evaluates it at all vertices,
                           ///< readers elsewhere
  bool unites = false;     ///< takes several values of its first product at once
  bool gives_all = false;  ///< in each frame, makes all outputs of its manifest; other roles may
                           ///< omit some
  bool hands_on = false;   ///< reading a value does not count as use of it; using the product does
  bool solves = false;     ///< makes the shape
  bool measures = false;   ///< may read the truth without a declaration
  bool is_open = false;    ///< its components declare their inputs and outputs themselves, see
                           ///< open_slots.hpp

  const RoleMethod& main_method() const { return role.methods[to_index(frame_method)]; }
};

/// The rules of all roles, in the order in which data flow through them.
const std::vector<RoleRules>& all_role_rules();

/// The rules of a role by its name; rules without a name or any content if the role does not exist.
const RoleRules& rules_of(std::string_view role);

/// Names of the roles whose components are legal in this part.
std::vector<std::string> roles_of(PipelinePart part);

/// The role of a component's id: "filters" of "filters/aem".
inline std::string role_of(std::string_view id) { return std::string(id.substr(0, id.find('/'))); }

/// The role of a component's id, the nearest one where it is misspelt: "filters" of "fitlers/x".
std::string role_meant(std::string_view id);

}  // namespace weft
