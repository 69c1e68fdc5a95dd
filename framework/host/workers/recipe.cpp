// SPDX-License-Identifier: Apache-2.0
#include "host/workers/recipe.hpp"

namespace weft::host {
namespace {

template <class T>
std::vector<T> items(const weft_value& value) {
  const T* data = static_cast<const T*>(value.data);
  return {data, data + value.count};
}

RecipeValue value_of(const weft_value& value) {
  RecipeValue result{value.name, value.type, value.is_vector, {}, {}, {}, {}};
  if (value.type == WEFT_VALUE_F64) {
    result.numbers = items<double>(value);
  } else if (value.type == WEFT_VALUE_I64) {
    result.integers = items<std::int64_t>(value);
  } else if (value.type == WEFT_VALUE_BOOL) {
    result.flags = items<std::uint8_t>(value);
  } else {
    for (const char* text : items<const char*>(value)) result.texts.emplace_back(text);
  }
  return result;
}

void add(const RecipeValue& value, Arguments& arguments) {
  if (value.type == WEFT_VALUE_F64 && value.is_vector != 0) {
    arguments.add_numbers(value.name, value.numbers);
  } else if (value.type == WEFT_VALUE_F64) {
    arguments.add_number(value.name, value.numbers.at(0));
  } else if (value.type == WEFT_VALUE_I64 && value.is_vector != 0) {
    arguments.add_integers(value.name, value.integers);
  } else if (value.type == WEFT_VALUE_I64) {
    arguments.add_integer(value.name, value.integers.at(0));
  } else if (value.type == WEFT_VALUE_BOOL) {
    arguments.add_flag(value.name, value.flags.at(0) != 0);
  } else {
    arguments.add_texts(value.name, static_cast<weft_value_type>(value.type), value.texts,
                        value.is_vector != 0);
  }
}

}  // namespace

Recipe Recipe::of(const ComponentSpec& spec) {
  Recipe recipe;
  recipe.id = spec.component().id;
  recipe.library = spec.installed->library->library;
  recipe.produces = spec.component().produces;
  if (spec.component().open_rules != nullptr) {
    recipe.needs = spec.component().needs;
    recipe.reads = spec.component().reads;
    recipe.records = spec.component().records;
    recipe.record_types = spec.component().record_types;
  }
  for (const weft_value& value : spec.arguments.values()) recipe.values.push_back(value_of(value));
  for (const auto& [parameter, child] : spec.nested) {
    recipe.nested.push_back(of(child));
    recipe.nested.back().parameter = parameter;
  }
  return recipe;
}

ComponentSpec Recipe::spec(std::deque<Installed>& installed) const {
  Manifest manifest;
  manifest.library = library;
  Installed& entry = installed.emplace_back();
  entry.component.id = id;
  entry.component.needs = needs;
  entry.component.reads = reads;
  entry.component.produces = produces;
  entry.component.records = records;
  entry.component.record_types = record_types;
  entry.component.find_rules();
  entry.library = std::make_shared<const Manifest>(std::move(manifest));
  ComponentSpec result;
  result.installed = &entry;
  for (const RecipeValue& value : values) add(value, result.arguments);
  for (const Recipe& child : nested) {
    result.nested.push_back({child.parameter, child.spec(installed)});
  }
  return result;
}

}  // namespace weft::host
