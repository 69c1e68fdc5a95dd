// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/catalogue_page.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <string_view>
#include <weft/data/catalogue.hpp>
#include <weft/sdk/roles.hpp>

namespace weft {
namespace {

template <class T>
const char* element_name(const Array<T>&) {
  constexpr const char* kNames[] = {"", "u8", "i8", "u16", "i16", "i32", "i64", "f32", "f64"};
  return kNames[dtype_of<T>()];
}
const char* element_name(double) { return "f64"; }
const char* element_name(std::int64_t) { return "i64"; }
const char* element_name(std::int32_t) { return "i32"; }
const char* element_name(const std::string&) { return "u8 text"; }
const char* element_name(const NamedArrays&) { return "any"; }
const char* element_name(const Diagnostics&) { return "any"; }

std::string shape_of(const Field& field) {
  return *field.shape == '\0' ? "scalar" : "[" + std::string(field.shape) + "]";
}

/// An array whose elements or text are one of a set of values.
struct ValueSet {
  std::string_view type, array;
  bool is_open;  ///< a minor version may add values
};
constexpr ValueSet kValueSets[] = {{Keypoints::kType, "metric", false},
                                   {Visibility::kType, "reason", true},
                                   {Shape::kType, "state", false},
                                   {GroundTruth::kType, "kind", true},
                                   {GroundTruth::kType, "match_label", false}};

const char* set_mark(std::string_view type, std::string_view array) {
  const auto found =
      std::find_if(std::begin(kValueSets), std::end(kValueSets),
                   [&](const ValueSet& set) { return set.type == type && set.array == array; });
  if (found == std::end(kValueSets)) return "";
  return found->is_open ? "; open set" : "; closed set";
}

/// Collects the inputs that may occur several times in a call.
struct ListCollector {
  std::set<std::string> names{};

  template <class RecordType>
  void operator()(const char* slot, const ListInput<RecordType>&) {
    names.insert(slot);
  }
  template <class Member>
  void operator()(const char*, const Member&) {}
};

template <class Input>
std::set<std::string> lists_of() {
  const weft_call no_call{};
  ListCollector lists;
  Input input{Call(no_call)};
  Input::slots(input, lists);
  return lists.names;
}

/// The list inputs of a role; templates and sources have no inputs.
std::set<std::string> lists_of(std::string_view role) {
  if (role == Detector::kRole) return lists_of<DetectorInput>();
  if (role == Matcher::kRole) return lists_of<MatcherInput>();
  if (role == Filter::kRole) return lists_of<FilterInput>();
  if (role == WarpModel::kRole) return lists_of<FitInput>();
  if (role == Pass::kRole) return lists_of<PassInput>();
  if (role == Solver::kRole) return lists_of<SolverInput>();
  if (role == Sink::kRole) return lists_of<SinkInput>();
  return {};
}

void write_slots(std::ostream& page, const std::vector<RoleSlot>& slots,
                 const std::set<std::string>& lists) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    page << (i > 0 ? ", " : "") << "`" << slots[i].name << "`" << (slots[i].required ? "*" : "")
         << (lists.contains(slots[i].name) ? " (list)" : "");
  }
}

}  // namespace

std::string catalogue_page() {
  std::ostringstream page;
  page << "# Records and roles\n\n"
       << "Printed by `weft records`; a test compares this page with the program.\n\n"
       << "Letters in shapes are lengths that agree within a record; `?` is an optional axis of "
          "three\ncolours. Numbers are finite unless the meaning states otherwise. Pixel centres "
          "are at integer\ncoordinates; the camera frame is x right, y down, z forward.\n\n"
       << "A version of a record keeps the values of a *closed set*. A minor version of the host "
          "may add\nvalues to an *open set*, keys to JSON texts, and names of `diag.*` arrays: a "
          "reader "
          "accepts\nunknown ones.\n\n## Records\n";
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    page << "\n### " << RecordType::kType
         << "\n\n| array | type | shape | unit, frame | meaning |\n|---|---|---|---|---|\n";
    const RecordType typed{};
    RecordType::fields(typed, [&](const auto& member, const Field& field) {
      page << "| " << field.name << (field.optional ? " (optional)" : "") << " | "
           << element_name(member) << " | " << shape_of(field) << " | " << field.unit << " | "
           << field.meaning << (field.may_be_nan ? "; NaN where missing" : "")
           << (field.may_be_on_device ? "; may lie on a device" : "")
           << set_mark(RecordType::kType, field.name) << " |\n";
    });
  });
  page << "\n## Roles\n\nAn asterisk marks what is required in, or produced by, every use. A slot "
          "occurs at most once in a\ncall, except a list: it occurs once for each stage of `from`, "
          "in that order.\n\n"
       << "| role | method | consumes | produces |\n|---|---|---|---|\n";
  for (const Role& role : all_roles()) {
    for (std::size_t i = 0; i < role.methods.size(); ++i) {
      page << "| " << role.name << " | " << i << " " << role.methods[i].name << " | ";
      write_slots(page, role.methods[i].inputs, lists_of(role.name));
      page << " | ";
      write_slots(page, role.methods[i].outputs, {});
      page << " |\n";
    }
  }
  page << "\nComponents of the role `stages` declare what they take and make: any of these "
          "inputs,\nwhat passes make, and record types of their vendor, `vendor.name/version`.\n";
  return page.str();
}

}  // namespace weft
