// SPDX-License-Identifier: Apache-2.0
// How an instance is made.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "faults.hpp"

namespace weft::faults {
namespace {

/// The declaration of one parameter.
struct Declared {
  std::string name;
  std::int32_t type;
  bool is_vector;
  double minimum, maximum;

  bool is_number() const {
    return !is_vector && (type == WEFT_VALUE_F64 || type == WEFT_VALUE_I64);
  }
  bool is_bounded() const { return std::isfinite(minimum) || std::isfinite(maximum); }
};

std::vector<Declared> declared_by_original() {
  std::vector<Declared> all;
  const auto parameter = [](void* context, const weft_parameter* given) {
    const weft_value& value = given->default_value;
    static_cast<std::vector<Declared>*>(context)->push_back(
        {value.name, value.type, value.is_vector != 0, given->minimum, given->maximum});
  };
  const weft_describe sink{sizeof(weft_describe),
                           0,
                           &all,
                           parameter,
                           [](void*, const char*) {},
                           [](void*, const char*, const weft_field*) {}};
  weft_error error{sizeof(weft_error), 0, {}, {}, {}};
  original().describe(&sink, &error);
  return all;
}

/// A value, and the number in it where it was changed.
struct Given {
  weft_value value;
  bool is_changed = false;
  double f64 = 0.0;
  std::int64_t i64 = 0;
};

double number_in(const weft_value& value) {
  return value.type == WEFT_VALUE_F64
             ? *static_cast<const double*>(value.data)
             : static_cast<double>(*static_cast<const std::int64_t*>(value.data));
}

void set_number(Given& given, double number) {
  given.is_changed = true;
  given.f64 = number;
  given.i64 = static_cast<std::int64_t>(number);
  const bool is_real = given.value.type == WEFT_VALUE_F64;
  given.value.data = is_real ? static_cast<const void*>(&given.f64) : &given.i64;
}

const Declared* find(const std::vector<Declared>& declared, const char* name) {
  const auto found = std::find_if(declared.begin(), declared.end(),
                                  [&](const Declared& each) { return each.name == name; });
  return found != declared.end() ? &*found : nullptr;
}

/// Replaces later values of the first bounded number in this process by its first value.
void keep_first(Given& given) {
  static const std::string name = given.value.name;
  static const double first = number_in(given.value);
  if (name == given.value.name) set_number(given, first);
}

/// True if the plugin receives this value.
bool pass_on(Given& given, const Declared& declared) {
  const std::int32_t type = given.value.type;
  if (has("accepts_wrong_type") && type != declared.type) return false;
  if (type != declared.type || !declared.is_number() || given.value.count != 1) return true;
  if (has("ignores_numbers")) return false;
  if (!declared.is_bounded()) return true;
  const double number = number_in(given.value);
  if (has("crashes_at_end_of_range") &&
      (number == declared.minimum || number == declared.maximum)) {
    std::abort();
  }
  const bool is_outside = !(number >= declared.minimum && number <= declared.maximum);
  if (has("accepts_out_of_range") && is_outside) {
    const bool is_low = !(number > declared.maximum);
    set_number(given, is_low ? declared.minimum : declared.maximum);
  }
  if (has("keeps_first_number")) keep_first(given);
  return true;
}

/// True if two numbers are in the upper halves of their ranges.
bool is_in_corner(const std::vector<Declared>& declared, const weft_create& with) {
  int high = 0;
  for (std::uint64_t i = 0; i < with.count; ++i) {
    const Declared* known = find(declared, with.values[i].name);
    if (known == nullptr || known->type != with.values[i].type || !known->is_number()) continue;
    if (number_in(with.values[i]) > (known->minimum + known->maximum) / 2.0) ++high;
  }
  return high > 1;
}

std::int32_t create_original(const weft_create& with, void** self, weft_error& error) {
  const std::vector<Declared> declared = declared_by_original();
  if (has("crashes_in_corner") && is_in_corner(declared, with)) std::abort();
  std::vector<Given> all;
  for (std::uint64_t i = 0; i < with.count; ++i) {
    all.push_back({with.values[i]});
    const Declared* known = find(declared, with.values[i].name);
    if (known == nullptr && has("refuses_unknown")) {
      error.code = WEFT_CODE_INVALID_VALUE;
      return refuse(error, "there is no such parameter");
    }
    if (known != nullptr && !pass_on(all.back(), *known)) all.pop_back();
  }
  std::vector<weft_value> values;
  for (Given& given : all) {
    if (given.is_changed) set_number(given, given.f64);  // the vector may have moved it
    values.push_back(given.value);
  }
  weft_create passed = with;
  passed.struct_size = sizeof(passed);
  passed.values = values.data();
  passed.count = values.size();
  return original().create(&passed, self, &error);
}

}  // namespace

std::int32_t create(const weft_create* with, void** self, weft_error* error) {
  if (has("create_null")) return WEFT_OK;
  if (has("create_crashes")) write_where_nothing_is();
  if (has("create_exits")) std::exit(0);
  if (has("create_hangs")) sleep_for_ever();
  if (has("create_throws")) throw 42;
  static std::atomic<int> at_work = 0;
  if (has("creates_one_at_a_time")) {
    if (at_work++ > 0) std::abort();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  disturb_process("create");
  const std::int32_t status = create_original(*with, self, *error);
  if (has("creates_one_at_a_time")) --at_work;
  if (has("create_status")) return 77;
  if (status == WEFT_OK) instance_of(*self).creator = std::this_thread::get_id();
  if (status != WEFT_OK && has("names_no_subject")) error->subject[0] = '\0';
  return status;
}

}  // namespace weft::faults
