// SPDX-License-Identifier: Apache-2.0
#include "host/records/record_schema.hpp"

#include <algorithm>
#include <weft/data/field_reader.hpp>

#include "host/records/record.hpp"

namespace weft::host {
namespace {

/// The error of one array, or empty.
std::string problem_of(const weft_array* array, const FieldSchema& field, ShapePattern& lengths) {
  if (array == nullptr) return field.optional ? "" : "is missing";
  if (array->dtype != field.dtype) {
    return std::string("has elements of type ") + dtype_name(array->dtype) + " where " +
           dtype_name(field.dtype) + " is expected";
  }
  std::string problem = lengths.match(field.shape, *array);
  if (problem.empty() && !field.may_be_nan && !is_finite(*array)) problem = "holds NaN or infinity";
  return problem;
}

}  // namespace

std::int32_t dtype_called(std::string_view word) {
  for (std::int32_t dtype = WEFT_U8; dtype <= WEFT_F64; ++dtype) {
    if (word == dtype_name(dtype)) return dtype;
  }
  return 0;
}

Result<void> validate(const weft_record& record, const RecordSchema& schema) {
  const auto refuse = [&](const std::string& name, const std::string& problem) {
    return Error{Errc::invalid_data, schema.type + ": array '" + name + "' " + problem, {}};
  };
  const auto* end = record.arrays + record.count;
  const auto* remote = std::find_if(
      record.arrays, end, [](const weft_array& array) { return array.memory == WEFT_DEVICE; });
  if (remote != end) return refuse(remote->name, "lies in device memory");
  ShapePattern lengths;
  for (const FieldSchema& field : schema.arrays) {
    const std::string problem = problem_of(find_array(record, field.name), field, lengths);
    if (!problem.empty()) return refuse(field.name, problem);
  }
  return {};
}

}  // namespace weft::host
