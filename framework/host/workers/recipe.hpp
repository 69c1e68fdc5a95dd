// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "host/loading/component_spec.hpp"

namespace weft::host {

/// A parameter of a component: its value is in the list that fits its type.
struct RecipeValue {
  std::string name;
  std::int32_t type = 0, is_vector = 0;  ///< weft_value_type; 0 or 1
  std::vector<double> numbers;           ///< [.] values of floating-point types
  std::vector<std::int64_t> integers;    ///< [.] values of integer types
  std::vector<std::uint8_t> flags;       ///< [.] 0 or 1
  std::vector<std::string> texts;        ///< [.] values of text types

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.name), visit(self.type), visit(self.is_vector);
    visit(self.numbers), visit(self.integers), visit(self.flags), visit(self.texts);
  }
};

/// All that it takes to make a component, with those nested in it.
struct Recipe {
  std::string parameter;  ///< parameter that contains the component; empty for the outermost
  std::string id, library;
  std::vector<std::string> needs, reads, produces;  ///< [.] names of slots
  std::vector<std::string> records;                 ///< with `record_types`, where its role is open
  std::vector<RecordSchema> record_types;           ///< [.] of vendors
  std::vector<RecipeValue> values;                  ///< [.] parameters
  std::vector<Recipe> nested;                       ///< [.] nested components

  static Recipe of(const ComponentSpec& spec);

  /// As a component of this process; `installed` holds what it refers to.
  ComponentSpec spec(std::deque<Installed>& installed) const;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.parameter), visit(self.id), visit(self.library), visit(self.produces);
    visit(self.needs), visit(self.reads), visit(self.records), visit(self.record_types);
    visit(self.values), visit(self.nested);
  }
};

}  // namespace weft::host
