// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pipeline/graph/wiring.hpp"

namespace weft {
namespace {

/// Collects what a component and those nested in it want of the inputs of its role.
class Demands {
 public:
  Demands(const StageConfig& stage, const RoleMethod& offered, std::vector<yaml::Problem>& problems)
      : stage_(stage), offered_(offered), problems_(problems) {}

  std::vector<Demand> collect() {
    if (stage_.component.installed != nullptr) add(stage_.component, false);
    if (!is_known(stage_.component)) add_chosen();
    return std::move(demands_);
  }

 private:
  bool is_offered(const std::string& slot) const {
    return std::any_of(offered_.inputs.begin(), offered_.inputs.end(),
                       [&](const RoleSlot& input) { return input.name == slot; });
  }

  void add(const host::ComponentSpec& spec, bool nested) {
    const host::ComponentManifest& component = spec.component();
    const RoleMethod& method = nested ? component.rules().main_method() : offered_;
    for (const RoleSlot& input : method.inputs) {
      if (input.required) want(component, input.name, true, nested);
    }
    // A newer library may read inputs that this version does not have.
    const bool is_newer = spec.installed->library->abi_minor > WEFT_ABI_MINOR;
    for (const std::string& slot : component.needs) want(component, slot, true, nested);
    for (const std::string& slot : component.reads) {
      if (!is_newer || is_offered(slot)) want(component, slot, false, nested);
    }
    for (const host::NestedSpec& child : spec.nested) {
      if (child.component.installed != nullptr) add(child.component, true);
    }
  }

  void want(const host::ComponentManifest& component, const std::string& slot, bool required,
            bool nested) {
    const auto refuse = [&](std::string message) {
      problems_.push_back({stage_.at, std::move(message)});
    };
    if (!is_offered(slot)) {
      if (nested) return;
      return refuse(component.id + " wants '" + slot + "', which " + component.role() +
                    " are never given");
    }
    if (slot == "ground_truth" && !component.uses_truth && !rules_of(component.role()).measures) {
      return refuse(component.id + " reads ground_truth without declaring uses_truth");
    }
    for (Demand& demand : demands_) {
      if (demand.slot != slot) continue;
      demand.required = demand.required || required;
      return;
    }
    demands_.push_back({slot, required && !slot.starts_with("previous.")});
  }

  /// For a stage with unknown plugins, the choices of `from` count as demands.
  void add_chosen() {
    for (const FromRule& rule : stage_.from) {
      const bool known = std::any_of(demands_.begin(), demands_.end(), [&](const Demand& demand) {
        return demand.slot == rule.slot;
      });
      if (!known && is_offered(rule.slot)) demands_.push_back({rule.slot, false});
    }
  }

  const StageConfig& stage_;
  const RoleMethod& offered_;
  std::vector<yaml::Problem>& problems_;
  std::vector<Demand> demands_;
};

}  // namespace

bool is_known(const host::ComponentSpec& spec) {
  return spec.installed != nullptr &&
         std::all_of(spec.nested.begin(), spec.nested.end(),
                     [](const host::NestedSpec& child) { return is_known(child.component); });
}

std::vector<Demand> demands_of(const StageConfig& stage, const RoleMethod& offered,
                               std::vector<yaml::Problem>& problems) {
  return Demands(stage, offered, problems).collect();
}

}  // namespace weft
