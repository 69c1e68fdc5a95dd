// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/metrics/field.hpp"

namespace weft::lab {

/// The base of a visitor that treats each declared member separately, even if a frame lacks it.
template <class Visitor>
class EveryDeclaration {
 public:
  template <class Value>
  void derived(const MetricField& field, const Value& value) {
    self()(field, value);
  }

  template <class Members>
  void object(const MetricField& /*field*/, bool /*there*/, Members&& members) {
    members(self());
  }

  template <class Members>
  void when(bool /*there*/, Members&& members) {
    members(self());
  }

 private:
  Visitor& self() { return static_cast<Visitor&>(*this); }
};

}  // namespace weft::lab
