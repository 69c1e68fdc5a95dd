// SPDX-License-Identifier: Apache-2.0
#include "host/records/value_check.hpp"

#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <weft/data/codec.hpp>

namespace weft::host {
namespace {

constexpr double kRounding = 1e-9;

/// The values that an array may have.
struct Legal {
  double least, most;
  const char* words;  ///< as in the catalogue
};

std::optional<Legal> legal_values(std::string_view type, const Field& field) {
  const std::string_view name = field.name, unit = field.unit;
  if (unit == "0 or 1") return Legal{0.0, 1.0, "0 or 1"};
  if (unit == "0 to 1") return Legal{-kRounding, 1.0 + kRounding, "0 to 1"};
  if (unit == "-1 to 1") return Legal{-1.0 - kRounding, 1.0 + kRounding, "-1 to 1"};
  if (unit == "-1, 0 or 1") return Legal{-1.0, 1.0, "-1, 0 or 1"};
  if (type == Shape::kType && name == "state") return Legal{1.0, 4.0, "1 to 4"};
  if (type == Sightlines::kType && name == "weight") {
    return Legal{0.0, std::numeric_limits<double>::infinity(), "0 or more"};
  }
  return std::nullopt;
}

/// Checks that all bytes are 0 or 1, eight at a time: masks have millions of them.
bool are_flags(const std::uint8_t* bytes, std::int64_t count) {
  std::uint64_t seen = 0;
  std::int64_t i = 0;
  for (; i + 8 <= count; i += 8) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, bytes + i, sizeof(eight));
    seen |= eight;
  }
  for (; i < count; ++i) seen |= bytes[i];
  return (seen & 0xFEFEFEFEFEFEFEFEU) == 0;
}

/// "holds 7 at [3]", or an empty text.
template <class T>
std::string illegal_value(const weft_array& array, const Legal& legal) {
  const auto is_legal = [&](T value) {
    return static_cast<double>(value) >= legal.least && static_cast<double>(value) <= legal.most;
  };
  const auto text_of = [](T value) { return std::to_string(value); };
  if (array.ndim == 0) {
    const T value = *static_cast<const T*>(array.data);
    return is_legal(value) ? "" : "is " + text_of(value);
  }
  const Array<T> values = detail::borrow_array<T>(array);
  if constexpr (std::is_same_v<T, std::uint8_t>) {
    const bool of_flags = legal.least == 0.0 && legal.most == 1.0;
    if (of_flags && values.contiguous() && are_flags(values.data(), values.size())) return {};
  }
  for (std::int64_t i = 0; i < values.rows(); ++i) {
    const T* row = values.row(i);
    for (std::int64_t j = 0; j < values.row_elements(); ++j) {
      if (is_legal(row[j])) continue;
      const std::string column = array.ndim > 1 ? "," + std::to_string(j) : "";
      return "holds " + text_of(row[j]) + " at [" + std::to_string(i) + column + "]";
    }
  }
  return {};
}

std::string illegal_value_of(const weft_array& array, const Legal& legal) {
  switch (array.dtype) {
    case WEFT_U8:
      return illegal_value<std::uint8_t>(array, legal);
    case WEFT_I8:
      return illegal_value<std::int8_t>(array, legal);
    case WEFT_I32:
      return illegal_value<std::int32_t>(array, legal);
    case WEFT_I64:
      return illegal_value<std::int64_t>(array, legal);
    case WEFT_F64:
      return illegal_value<double>(array, legal);
    default:
      return {};  // the catalogue has no such values of another type
  }
}

/// Visits the fields of a record struct and keeps the first error.
class ValueCheck {
 public:
  explicit ValueCheck(const weft_record& record) : record_(record) {}

  template <class Member>
  void operator()(const Member&, const Field& field) {
    if (!problem_.empty()) return;
    const auto legal = legal_values(record_.type, field);
    const weft_array* array = legal ? find_array(record_, field.name) : nullptr;
    if (array == nullptr || array->memory == WEFT_DEVICE) return;
    const std::string wrong = illegal_value_of(*array, *legal);
    if (wrong.empty()) return;
    problem_ = std::string(record_.type) + ": array '" + field.name + "' " + wrong + " where " +
               legal->words + " is expected";
  }

  const std::string& problem() const { return problem_; }

 private:
  const weft_record& record_;
  std::string problem_;
};

}  // namespace

Result<void> check_values(const weft_record& record) {
  Result<void> status;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    if (std::string_view(record.type) != RecordType::kType) return;
    const RecordType fields{};
    ValueCheck values(record);
    RecordType::fields(fields, values);
    if (!values.problem().empty()) status = Error{Errc::invalid_data, values.problem()};
  });
  return status;
}

}  // namespace weft::host
