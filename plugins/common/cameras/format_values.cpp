// SPDX-License-Identifier: Apache-2.0
#include "common/cameras/format_values.hpp"

#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {

using yaml_files::FileMistake;

const Value* FormatValues::list(const std::string& paths) const {
  const Value* value = find(paths);
  if (value == nullptr || value->kind != Value::Kind::map) return value;
  const std::string path = value->path + "/";
  const Value* data = values_.find(path, "data");
  if (data == nullptr) {
    throw FileMistake(value->place, "'" + value->path + "' must have rows, cols and data");
  }
  double count = 1.0;
  for (const char* side : {"rows", "cols"}) {
    const Value* given = values_.find(path, side);
    if (given == nullptr || given->words.empty()) {
      throw FileMistake(value->place, "has no '" + std::string(side) + "'");
    }
    count *= number(given->words.front(), value->path + "." + side);
  }
  if (count != static_cast<double>(data->words.size())) {
    throw FileMistake(value->place, "'" + value->path + "' has " +
                                        std::to_string(data->words.size()) +
                                        " numbers in data, which is not rows x cols");
  }
  return data;
}

const Word& FormatValues::word(const Value& value) const {
  if (value.kind == Value::Kind::scalar) return value.words.front();
  throw FileMistake(value.place, "'" + value.path + "' must be a number");
}

std::vector<double> FormatValues::numbers(const Value& value) const {
  if (value.kind == Value::Kind::map) {
    throw FileMistake(value.place, "'" + value.path + "' must be a list of numbers");
  }
  std::vector<double> found;
  for (const Word& each : value.words) found.push_back(number(each, value.path));
  return found;
}

double FormatValues::optional_number(const std::string& path) const {
  const Value* value = find(path);
  return value == nullptr ? 0.0 : number(word(*value), value->path);
}

}  // namespace weft::cameras
