// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lab/ablation/plan/plan.hpp"

namespace weft::lab {

/// A plan as one document.
struct PlanDocument {
  yaml::Node root;                             ///< without `extends` and `without`
  std::vector<ConfigSource> sources;           ///< the file, what it extends, the command line
  std::vector<yaml::Problem> problems;         ///< [.] errors with their places
  std::vector<host::FormerName> former_names;  ///< former names of ids and metrics; the root has
                                               ///< current ones
  bool complete = true;                        ///< each text could be read to its end
};

/// Reads a plan file, lays it over the plan that it `extends`, and lays the changes of the command
/// line over that.
///
/// Maps are merged key by key, all other values are replaced. An axis with another `set` path or
/// another `stage` replaces the one with its name. A key that the extended plan lacks is inserted
/// after its predecessor in the list, before its successor if it is listed first, or at the end.
/// `name` is not taken from the extended plan.
PlanDocument read_plan_document(const std::string& file, const PlanChanges& changes);

/// One plan merged into another, by these rules.
yaml::Node merged_plans(yaml::Node base, yaml::Node over);

/// Replaces former ids in `use` and `except` of axes, and former names of metrics.
void use_current_plan_names(yaml::Node& root, std::vector<host::FormerName>& found);

/// Leaves axes ("bend"), values of them ("bend.little") and data ("data.handles") out of a plan,
/// and the comparisons and expectations that are about them. Appends what is wrong to `problems`.
void leave_out_of_plan(yaml::Node& root, const yaml::Node& names,
                       std::vector<yaml::Problem>& problems);

/// The document that a setting "axes.bend.values=[1, 2]" merges into a plan, positions in its own
/// text.
yaml::Node plan_overlay_of(const std::string& setting, const yaml::Node& root,
                           std::vector<yaml::Problem>& problems);

}  // namespace weft::lab
