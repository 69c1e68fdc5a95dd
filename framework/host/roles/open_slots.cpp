// SPDX-License-Identifier: Apache-2.0
#include "host/roles/open_slots.hpp"

#include <algorithm>
#include <weft/core/component_id.hpp>
#include <weft/core/suggest.hpp>
#include <weft/sdk/roles.hpp>

namespace weft {
namespace {

constexpr std::string_view kPrevious = "previous.";

/// The slots of the catalogue's record types: what any role takes, or what a pass makes.
std::vector<RoleSlot> known_slots(bool is_output) {
  if (is_output) return Pass::role().methods.front().outputs;
  std::vector<RoleSlot> slots;
  for (const Role& role : all_roles()) {
    for (const RoleMethod& method : role.methods) {
      slots.insert(slots.end(), method.inputs.begin(), method.inputs.end());
    }
  }
  return slots;
}

/// The type of a vendor's slot among those that the component declares, or empty.
std::string vendor_type(std::string_view slot, const std::vector<std::string>& records) {
  for (const std::string& type : records) {
    if (is_vendor_record(type) && type.substr(0, type.find('/')) == slot) return type;
  }
  return {};
}

Result<RoleSlot> slot_of(const std::string& name, const OpenSlots& said, bool is_output,
                         bool required) {
  const std::vector<RoleSlot> known = known_slots(is_output);
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&](const RoleSlot& slot) { return slot.name == name; });
  if (found != known.end()) return RoleSlot{name, found->type, required};
  const bool is_previous = !is_output && name.starts_with(kPrevious);
  const std::string of = is_previous ? name.substr(kPrevious.size()) : name;
  std::string type = vendor_type(of, said.records);
  if (!type.empty()) return RoleSlot{name, std::move(type), required && !is_previous};
  std::vector<std::string> names;
  for (const RoleSlot& slot : known) names.push_back(slot.name);
  return Error{Errc::invalid_data,
               "names '" + name + "', which is no " +
                   (is_output ? "output that passes have" : "input of any role") +
                   " and no record type of a vendor that it declares" +
                   did_you_mean(name, names, "; those are called vendor.name"),
               {}};
}

}  // namespace

Result<RoleRules> rules_with(const RoleRules& open, const OpenSlots& slots) {
  RoleRules rules = open;
  RoleMethod& method = rules.role.methods.front();
  struct List {
    const std::vector<std::string>& names;
    std::vector<RoleSlot>& target;
    bool is_output, required;
  };
  for (const List& list : {List{slots.needs, method.inputs, false, true},
                           List{slots.reads, method.inputs, false, false},
                           List{slots.produces, method.outputs, true, false}}) {
    for (const std::string& name : list.names) {
      auto slot = slot_of(name, slots, list.is_output, list.required);
      if (!slot) return slot.error();
      list.target.push_back(*std::move(slot));
    }
  }
  return rules;
}

}  // namespace weft
