// SPDX-License-Identifier: Apache-2.0
#include "host/records/record_schema.hpp"

#include <algorithm>
#include <weft/data/catalogue.hpp>
#include <weft/data/field_reader.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

/// Collects the fields of a record struct.
struct FieldCollector {
  std::vector<FieldSchema>& arrays;

  template <class T>
  void operator()(const Array<T>&, const Field& field) const {
    add(field, dtype_of<T>());
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T&, const Field& field) const { add(field, dtype_of<T>()); }
  void operator()(const std::string&, const Field& field) const { add(field, WEFT_U8); }
  void operator()(const NamedArrays&, const Field&) const {}
  void operator()(const Diagnostics&, const Field&) const {}

  void add(const Field& field, std::int32_t dtype) const {
    arrays.push_back({field.name, field.shape, field.unit, field.meaning, dtype, field.optional,
                      field.may_be_nan, field.may_be_on_device});
  }
};

std::vector<RecordSchema> read_catalogue() {
  std::vector<RecordSchema> schemas;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    RecordSchema& schema = schemas.emplace_back(RecordSchema{RecordType::kType, {}});
    const RecordType fields{};
    RecordType::fields(fields, FieldCollector{schema.arrays});
  });
  return schemas;
}

/// The error of an array's declaration and layout, or empty. `lengths` has those of the record.
std::string layout_problem(const weft_array& array, const FieldSchema& field,
                           ShapePattern& lengths) {
  if (array.dtype != field.dtype) {
    return std::string("has elements of type ") + dtype_name(array.dtype) + " where " +
           dtype_name(field.dtype) + " is expected";
  }
  if (array.memory == WEFT_DEVICE && !field.may_be_on_device) return "lies in device memory";
  return lengths.match(field.shape, array);
}

/// The error of an array without a field, or empty.
std::string problem_of_other(const weft_array& array) {
  if (array.memory == WEFT_DEVICE) return "is not in the catalogue, but lies in device memory";
  const std::string_view name = array.name;
  if (!name.starts_with("x.")) return {};
  return is_vendor_name(name) ? ShapePattern::check_layout(array) : "must be called x.vendor.name";
}

/// The error of one field, or empty. The numbers of an array on a device are checked when they are
/// fetched.
std::string problem_of(const weft_array* array, const FieldSchema& field, ShapePattern& lengths) {
  if (array == nullptr) return field.optional ? "" : "is missing";
  std::string problem = layout_problem(*array, field, lengths);
  const bool can_be_read = problem.empty() && array->memory != WEFT_DEVICE;
  if (can_be_read && !field.may_be_nan && !is_finite(*array)) problem = "holds NaN or infinity";
  return problem;
}

}  // namespace

const FieldSchema* RecordSchema::find(std::string_view array) const {
  const auto found = std::find_if(arrays.begin(), arrays.end(),
                                  [&](const FieldSchema& field) { return field.name == array; });
  return found != arrays.end() ? &*found : nullptr;
}

const RecordSchema* catalogue_schema(std::string_view type) {
  static const std::vector<RecordSchema> kCatalogue = read_catalogue();
  const auto found = std::find_if(kCatalogue.begin(), kCatalogue.end(),
                                  [&](const RecordSchema& schema) { return schema.type == type; });
  return found != kCatalogue.end() ? &*found : nullptr;
}

std::int32_t dtype_called(std::string_view word) {
  for (std::size_t i = 1; i < kElementTypes.size(); ++i) {
    if (word == kElementTypes[i].name) return static_cast<std::int32_t>(i);
  }
  return 0;
}

Result<void> validate(const weft_record& record, const RecordSchema& schema) {
  const auto refuse = [&](std::string_view name, const std::string& problem) {
    return Error{
        Errc::invalid_data, schema.type + ": array '" + std::string(name) + "' " + problem, {}};
  };
  ShapePattern lengths;
  std::uint64_t known = 0;
  for (const FieldSchema& field : schema.arrays) {
    const weft_array* array = find_array(record, field.name);
    if (array != nullptr) ++known;
    const std::string problem = problem_of(array, field, lengths);
    if (!problem.empty()) return refuse(field.name, problem);
  }
  if (known == record.count) return {};
  for (std::uint64_t i = 0; i < record.count; ++i) {
    const weft_array& array = record.arrays[i];
    if (schema.find(array.name) != nullptr) continue;
    const std::string problem = problem_of_other(array);
    if (!problem.empty()) return refuse(array.name, problem);
  }
  return {};
}

Result<void> validate(const weft_record& record) {
  const RecordSchema* schema = catalogue_schema(record.type);
  if (schema != nullptr) return validate(record, *schema);
  return Error{Errc::invalid_data, std::string("unknown record type ") + record.type};
}

std::string illegal_array(const RecordSchema& schema, const weft_array& array) {
  const FieldSchema* field = schema.find(array.name);
  ShapePattern lengths;
  return field != nullptr ? layout_problem(array, *field, lengths) : problem_of_other(array);
}

}  // namespace weft::host
