// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/core/range.hpp>
#include <weft/core/result.hpp>

namespace weft {

namespace detail {

/// A declaration with a unit and a range.
inline weft_parameter parameter_in(Range range, const char* unit) {
  const IntegerRange integers(range);
  weft_parameter parameter{};
  parameter.unit = unit;
  parameter.minimum = range.minimum;
  parameter.maximum = range.maximum;
  parameter.integer_minimum = integers.minimum;
  parameter.integer_maximum = integers.maximum;
  return parameter;
}

}  // namespace detail

/// Distinguishes optional from required parameters.
enum class Need { optional, required };

/// A nested component. The classes of weft/sdk/nested.hpp derive typed handles from it.
struct ComponentHandle {
  const char* role;
  const char* default_id;
  std::uint64_t handle = 0;  ///< set by the host
};

/// Declares and reads a component's parameters, once, in its constructor. The checks, the manifest,
/// the documentation and the editor schema are generated from these declarations. The variable's
/// value before the call is the default. Read all parameters unconditionally.
class Params {
 public:
  /// Collects the declarations.
  explicit Params(const weft_describe* sink) : sink_(sink) {}
  /// Assigns the given values to the variables.
  Params(const weft_value* values, std::uint64_t count) : values_(values), count_(count) {}

  /// The former name of the parameter that is declared next: `p.formerly("start").read(...)`. Files
  /// that use it still run, with a warning, and `weft migrate` rewrites them.
  Params& formerly(const char* name) {
    former_name_ = name;
    return *this;
  }

  /// The parameter that is declared next is one of those that users change most: programs show it
  /// first. `p.prominent().read(...)`
  Params& prominent() {
    flags_ |= WEFT_PARAMETER_PROMINENT;
    return *this;
  }

  /// Files that set the parameter that is declared next get a warning with its help, which names
  /// what to use instead.
  Params& deprecated() {
    flags_ |= WEFT_PARAMETER_DEPRECATED;
    return *this;
  }

  void read(const char* name, double& value, const char* unit, Range range, const char* help,
            Need need = Need::optional);
  void read(const char* name, int& value, const char* unit, Range range, const char* help,
            Need need = Need::optional);
  void read(const char* name, std::int64_t& value, const char* unit, Range range, const char* help,
            Need need = Need::optional);
  void read(const char* name, bool& value, const char* help);
  /// Reads a vector of numbers, each within `range`.
  void read(const char* name, std::vector<double>& values, const char* unit, Range range,
            const char* help, Need need = Need::optional);
  /// Reads a vector of integers, each within `range`.
  void read(const char* name, std::vector<std::int64_t>& values, const char* unit, Range range,
            const char* help, Need need = Need::optional);
  void read(const char* name, std::vector<int>& values, const char* unit, Range range,
            const char* help, Need need = Need::optional);
  /// Reads a list of texts.
  void read(const char* name, std::vector<std::string>& values, const char* help,
            Need need = Need::optional);
  void text(const char* name, std::string& value, const char* help, Need need = Need::optional);
  /// Reads the path of an input. Relative paths are resolved against the folder of the file that
  /// gives them; the value is absolute. Each of `words`, such as "auto", is legal instead of a path
  /// and is read unchanged.
  void input_path(const char* name, std::string& value, const char* help,
                  Need need = Need::optional, std::initializer_list<const char*> words = {});
  /// Reads the path of an output. Relative paths are resolved against the run folder; the value is
  /// absolute. A component writes files only to such paths.
  void output_path(const char* name, std::string& value, const char* help);
  /// Reads an ordered map from text to text; empty if it is not given.
  void labels(const char* name, std::vector<std::pair<std::string, std::string>>& value,
              const char* help);
  /// Reads one of several words.
  template <class Enum>
  void choice(const char* name, Enum& value,
              std::initializer_list<std::pair<const char*, Enum>> choices, const char* help);
  void component(const char* name, ComponentHandle& value, const char* help);

  /// The first illegal value, if there is one.
  const Result<void>& status() const { return status_; }

 private:
  const weft_value* find(const char* name, int type, bool vector = false);
  void declare(weft_parameter parameter, const char* name, int type, const char* help,
               const void* data, std::uint64_t count = 1);
  template <class Number>
  void read_number(const char* name, Number& value, int type, const char* unit, Range range,
                   const char* help, Need need);
  template <class Number>
  void read_numbers(const char* name, std::vector<Number>& values, int type, const char* unit,
                    Range range, const char* help, Need need);
  void read_text(const char* name, std::string& value, int type, const char* help, Need need,
                 std::initializer_list<const char*> words = {});
  void refuse(const char* name, const std::string& problem);

  const weft_describe* sink_ = nullptr;
  const weft_value* values_ = nullptr;
  std::uint64_t count_ = 0;
  const char* former_name_ = "";
  std::uint32_t flags_ = 0;  ///< flags of the next declaration
  Result<void> status_;
};

}  // namespace weft

#include <weft/core/params_inline.hpp>

// Lists.
namespace weft {

template <class Number>
void Params::read_numbers(const char* name, std::vector<Number>& values, int type, const char* unit,
                          Range range, const char* help, Need need) {
  if (sink_ != nullptr) {
    weft_parameter parameter = detail::parameter_in(range, unit);
    parameter.default_value.is_vector = 1;
    parameter.required = need == Need::required ? 1 : 0;
    declare(parameter, name, type, help, values.data(), values.size());
  } else if (const weft_value* given = find(name, type, true)) {
    const auto* numbers = static_cast<const Number*>(given->data);
    for (std::uint64_t i = 0; i < given->count; ++i) {
      if (!detail::is_within(range, numbers[i])) {
        return refuse(name, "has a value outside its range");
      }
    }
    values.assign(numbers, numbers + given->count);
  } else if (need == Need::required) {
    refuse(name, "is required");
  }
}

inline void Params::read(const char* name, std::vector<double>& values, const char* unit,
                         Range range, const char* help, Need need) {
  read_numbers(name, values, WEFT_VALUE_F64, unit, range, help, need);
}

inline void Params::read(const char* name, std::vector<std::int64_t>& values, const char* unit,
                         Range range, const char* help, Need need) {
  read_numbers(name, values, WEFT_VALUE_I64, unit, range, help, need);
}

inline void Params::read(const char* name, std::vector<int>& values, const char* unit, Range range,
                         const char* help, Need need) {
  std::vector<std::int64_t> wide(values.begin(), values.end());
  read(name, wide, unit, detail::within_int(range), help, need);
  values.clear();
  for (const std::int64_t number : wide) values.push_back(static_cast<int>(number));
}

inline void Params::read(const char* name, std::vector<std::string>& values, const char* help,
                         Need need) {
  if (sink_ != nullptr) {
    weft_parameter parameter{};
    parameter.default_value.is_vector = 1;
    parameter.required = need == Need::required ? 1 : 0;
    std::vector<const char*> texts;
    for (const std::string& text : values) texts.push_back(text.c_str());
    declare(parameter, name, WEFT_VALUE_TEXT, help, texts.data(), texts.size());
  } else if (const weft_value* given = find(name, WEFT_VALUE_TEXT, true)) {
    const auto* texts = static_cast<const char* const*>(given->data);
    values.assign(texts, texts + given->count);
  } else if (need == Need::required) {
    refuse(name, "is required");
  }
}

}  // namespace weft
