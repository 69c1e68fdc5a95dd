// SPDX-License-Identifier: Apache-2.0
#include "host/describe/slots.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>
#include <vector>
#include <weft/core/suggest.hpp>
#include <weft/sdk/roles.hpp>

#include "host/roles/open_slots.hpp"

namespace weft::host {
namespace {

using Slots = std::vector<RoleSlot> RoleMethod::*;

/// Each once, in the order of the role's methods.
std::vector<std::string> names_of(const Role& role, Slots slots) {
  std::vector<std::string> names;
  for (const RoleMethod& method : role.methods) {
    for (const RoleSlot& slot : method.*slots) {
      if (std::find(names.begin(), names.end(), slot.name) == names.end())
        names.push_back(slot.name);
    }
  }
  return names;
}

std::vector<std::string> words_of(const char* list) {
  std::istringstream stream{std::string(list)};
  return {std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>()};
}

/// The first error of a list of names, separated by blanks, or an empty text.
std::string unknown_name(const char* list, const Role& role, Slots slots, const char* what) {
  const std::vector<std::string> known = names_of(role, slots);
  std::string all;
  for (const std::string& name : known) all += (all.empty() ? "" : ", ") + name;
  for (const std::string& name : words_of(list)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    return "names '" + name + "', which is no " + what + " of " + role.name +
           did_you_mean(name, known, known.empty() ? "; there is none" : "; there are: " + all);
  }
  return {};
}

}  // namespace

std::string unknown_slots(const weft_component& component, bool is_newer) {
  const std::string_view id = component.id;
  const std::vector<Role> roles = all_roles();
  const auto role = std::find_if(roles.begin(), roles.end(), [&](const Role& each) {
    return each.name == id.substr(0, id.find('/'));
  });
  if (role == roles.end()) return {};
  struct List {
    const char *member, *names;
    Slots slots;
    const char* what;
  };
  for (const List& list : {List{"needs", component.needs, &RoleMethod::inputs, "input"},
                           List{"reads", component.reads, &RoleMethod::inputs, "input"},
                           List{"produces", component.produces, &RoleMethod::outputs, "output"}}) {
    const bool is_required = list.names == component.needs;
    if (is_newer && !is_required) continue;
    const std::string wrong = unknown_name(list.names, *role, list.slots, list.what);
    if (!wrong.empty()) return std::string("kAbout.") + list.member + " " + wrong;
  }
  return {};
}

std::string wrong_open_slots(const weft_component& component,
                             const std::set<std::string>& records) {
  const RoleRules& rules = rules_of(role_of(component.id));
  if (!rules.is_open) return {};
  const auto own = rules_with(rules, {words_of(component.needs),
                                      words_of(component.reads),
                                      words_of(component.produces),
                                      {records.begin(), records.end()}});
  return own ? "" : "kAbout " + own.error().message;
}

}  // namespace weft::host
