// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/params.hpp>

namespace weft {
inline const weft_value* Params::find(const char* name, int type, bool vector) {
  for (std::uint64_t i = 0; i < count_; ++i) {
    if (std::string_view(values_[i].name) != name) continue;
    if (values_[i].type == type && (values_[i].is_vector != 0) == vector) return &values_[i];
    refuse(name, "has the wrong type");
  }
  return nullptr;
}

inline void Params::refuse(const char* name, const std::string& problem) {
  if (status_) {
    status_ =
        Error{Errc::invalid_value, "parameter '" + std::string(name) + "' " + problem, {}, name};
  }
}

inline void Params::declare(weft_parameter parameter, const char* name, int type, const char* help,
                            const void* data, std::uint64_t count) {
  parameter.struct_size = sizeof(weft_parameter);
  parameter.default_value.name = name;
  parameter.default_value.type = type;
  parameter.default_value.count = count;
  parameter.default_value.data = data;
  parameter.help = help;
  if (parameter.unit == nullptr) parameter.unit = "";
  if (parameter.role == nullptr) parameter.role = "";
  parameter.was = std::exchange(former_name_, "");
  parameter.flags = std::exchange(flags_, 0);
  sink_->parameter(sink_->context, &parameter);
}

template <class Number>
void Params::read_number(const char* name, Number& value, int type, const char* unit, Range range,
                         const char* help, Need need) {
  if (sink_ != nullptr) {
    weft_parameter parameter = detail::parameter_in(range, unit);
    parameter.required = need == Need::required ? 1 : 0;
    declare(parameter, name, type, help, &value);
  } else if (const weft_value* given = find(name, type)) {
    const Number number = *static_cast<const Number*>(given->data);
    if (!detail::is_within(range, number)) {
      refuse(name, "is outside its range");
    } else {
      value = number;
    }
  } else if (need == Need::required) {
    refuse(name, "is required");
  }
}

inline void Params::read(const char* name, double& value, const char* unit, Range range,
                         const char* help, Need need) {
  read_number(name, value, WEFT_VALUE_F64, unit, range, help, need);
}

inline void Params::read(const char* name, std::int64_t& value, const char* unit, Range range,
                         const char* help, Need need) {
  read_number(name, value, WEFT_VALUE_I64, unit, range, help, need);
}

inline void Params::read(const char* name, int& value, const char* unit, Range range,
                         const char* help, Need need) {
  std::int64_t wide = value;
  read(name, wide, unit, detail::within_int(range), help, need);
  value = static_cast<int>(wide);
}

inline void Params::read(const char* name, bool& value, const char* help) {
  const std::uint8_t flag = value ? 1 : 0;
  if (sink_ != nullptr) {
    declare({}, name, WEFT_VALUE_BOOL, help, &flag);
  } else if (const weft_value* given = find(name, WEFT_VALUE_BOOL)) {
    value = *static_cast<const std::uint8_t*>(given->data) != 0;
  }
}

inline void Params::read_text(const char* name, std::string& value, int type, const char* help,
                              Need need, std::initializer_list<const char*> words) {
  if (sink_ != nullptr) {
    weft_parameter parameter{};
    parameter.required = need == Need::required ? 1 : 0;
    parameter.choices = words.size() > 0 ? words.begin() : nullptr;
    parameter.choice_count = words.size();
    const char* text = value.c_str();
    declare(parameter, name, type, help, &text);
  } else if (const weft_value* given = find(name, type)) {
    value = *static_cast<const char* const*>(given->data);
  } else if (need == Need::required) {
    refuse(name, "is required");
  }
}

inline void Params::text(const char* name, std::string& value, const char* help, Need need) {
  read_text(name, value, WEFT_VALUE_TEXT, help, need);
}

inline void Params::input_path(const char* name, std::string& value, const char* help, Need need,
                               std::initializer_list<const char*> words) {
  read_text(name, value, WEFT_VALUE_INPUT_PATH, help, need, words);
}

inline void Params::output_path(const char* name, std::string& value, const char* help) {
  read_text(name, value, WEFT_VALUE_OUTPUT_PATH, help, Need::optional);
}

inline void Params::labels(const char* name,
                           std::vector<std::pair<std::string, std::string>>& value,
                           const char* help) {
  if (sink_ != nullptr) {
    declare({}, name, WEFT_VALUE_LABELS, help, nullptr, 0);
  } else if (const weft_value* given = find(name, WEFT_VALUE_LABELS)) {
    const auto* texts = static_cast<const char* const*>(given->data);
    value.clear();
    for (std::uint64_t i = 0; i + 1 < given->count; i += 2) {
      value.emplace_back(texts[i], texts[i + 1]);
    }
  }
}

template <class Enum>
void Params::choice(const char* name, Enum& value,
                    std::initializer_list<std::pair<const char*, Enum>> choices, const char* help) {
  if (sink_ != nullptr) {
    std::vector<const char*> words;
    const char* current = "";
    for (const auto& [word, meaning] : choices) {
      words.push_back(word);
      if (meaning == value) current = word;
    }
    weft_parameter parameter{};
    parameter.choices = words.data();
    parameter.choice_count = words.size();
    declare(parameter, name, WEFT_VALUE_CHOICE, help, &current);
  } else if (const weft_value* given = find(name, WEFT_VALUE_CHOICE)) {
    const std::string_view chosen = *static_cast<const char* const*>(given->data);
    for (const auto& [word, meaning] : choices) {
      if (chosen == word) {
        value = meaning;
        return;
      }
    }
    refuse(name, "is none of its choices");
  }
}

inline void Params::component(const char* name, ComponentHandle& value, const char* help) {
  if (sink_ != nullptr) {
    weft_parameter parameter{};
    parameter.role = value.role;
    const char* id = value.default_id;
    declare(parameter, name, WEFT_VALUE_COMPONENT, help, &id);
  } else if (const weft_value* given = find(name, WEFT_VALUE_COMPONENT)) {
    value.handle = *static_cast<const std::uint64_t*>(given->data);
  }
}

}  // namespace weft
