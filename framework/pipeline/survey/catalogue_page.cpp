// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/catalogue_page.hpp"

#include <sstream>
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

void write_slots(std::ostream& page, const std::vector<RoleSlot>& slots) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    page << (i > 0 ? ", " : "") << "`" << slots[i].name << "`" << (slots[i].required ? "*" : "");
  }
}

}  // namespace

std::string catalogue_page() {
  std::ostringstream page;
  page << "# Records and roles\n\n"
       << "Printed by `weft records`; a test compares this page with the program.\n\n"
       << "Letters in shapes are lengths that agree within a record; `?` is an optional axis of "
          "three\ncolours. Numbers are finite unless the meaning states otherwise. Pixel centres "
          "are at integer\ncoordinates; the camera frame is x right, y down, z forward.\n\n## "
          "Records\n";
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    page << "\n### " << RecordType::kType
         << "\n\n| array | type | shape | unit, frame | meaning |\n|---|---|---|---|---|\n";
    const RecordType typed{};
    RecordType::fields(typed, [&](const auto& member, const Field& field) {
      page << "| " << field.name << (field.optional ? " (optional)" : "") << " | "
           << element_name(member) << " | " << shape_of(field) << " | " << field.unit << " | "
           << field.meaning << (field.may_be_nan ? "; NaN where missing" : "")
           << (field.may_be_on_device ? "; may lie on a device" : "") << " |\n";
    });
  });
  page << "\n## Roles\n\nAn asterisk marks what is required in, or produced by, every use.\n\n"
       << "| role | method | consumes | produces |\n|---|---|---|---|\n";
  for (const Role& role : all_roles()) {
    for (std::size_t i = 0; i < role.methods.size(); ++i) {
      page << "| " << role.name << " | " << i << " " << role.methods[i].name << " | ";
      write_slots(page, role.methods[i].inputs);
      page << " | ";
      write_slots(page, role.methods[i].outputs);
      page << " |\n";
    }
  }
  page << "\nComponents of the role `stages` declare what they take and make: any of these "
          "inputs,\nwhat passes make, and record types of their vendor, `vendor.name/version`.\n";
  return page.str();
}

}  // namespace weft
