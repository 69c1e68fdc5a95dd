// SPDX-License-Identifier: Apache-2.0
#include "row_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <weft/core/index.hpp>

#include "common/csv_cells.hpp"

namespace weft::known_points {
namespace {

using nlohmann::json;

/// Characters of UTF-8 before this byte, and one.
int column_of(std::string_view line, std::size_t byte) {
  const std::string_view before = line.substr(0, byte);
  return 1 + static_cast<int>(std::count_if(before.begin(), before.end(), [](char c) {
           return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
         }));
}

}  // namespace

Error mistake_at(const std::string& path, int line, int column, const std::string& message) {
  return {Errc::invalid_data,
          path + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + message,
          {}};
}

Result<void> CsvReader::read_header(std::string_view line, int line_number) {
  if (const auto wrong = sources::mistake_in_csv_header(line)) {
    return mistake_at(path_, line_number, 1, *wrong);
  }
  const auto cells = sources::csv_cells(line);
  if (!cells) return mistake_at(path_, line_number, 1, cells.error().message);
  std::vector<int> columns;
  for (const sources::CsvCell& cell : *cells) {
    const auto field = field_named(cell.text);
    columns.push_back(column_of(line, cell.byte));
    if (!field) {
      return mistake_at(path_, line_number, columns.back(),
                        "the column " + unknown_field(cell.text));
    }
    fields_.push_back(*field);
    if (const auto end = fields_.end() - 1; std::find(fields_.begin(), end, *field) != end) {
      return mistake_at(path_, line_number, columns.back(),
                        std::string("the column '") + name_of(*field) + "' is given twice");
    }
  }
  const auto wrong = check_fields(fields_);
  if (!wrong) return {};
  int column = 1;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (wrong->field == fields_[i]) column = columns[i];
  }
  return mistake_at(path_, line_number, column, "the header " + wrong->message);
}

Result<PointRow> CsvReader::read(std::string_view line, int line_number) const {
  const auto read = sources::csv_cells(line);
  if (!read) return mistake_at(path_, line_number, 1, read.error().message);
  const std::vector<sources::CsvCell>& cells = *read;
  if (cells.size() != fields_.size()) {
    return mistake_at(path_, line_number, column_of(line, cells.back().byte),
                      "has " + std::to_string(cells.size()) + " fields where the header has " +
                          std::to_string(fields_.size()));
  }
  Numbers numbers{};
  std::array<int, kFields> columns{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Field field = fields_[i];
    const bool may_lack = field == Field::radius_mm || field == Field::sigma_mm;
    columns[to_index(field)] = column_of(line, cells[i].byte);
    if (cells[i].text.empty() && may_lack) continue;
    auto& number = numbers[to_index(field)];
    number = sources::csv_number(cells[i].text);
    if (number) continue;
    return mistake_at(path_, line_number, columns[to_index(field)],
                      std::string("'") + name_of(field) + "' must be a finite number, not '" +
                          cells[i].text + "'");
  }
  PointRow row;
  const auto wrong = read_row(numbers, row);
  if (!wrong) return row;
  return mistake_at(path_, line_number, columns[to_index(*wrong->field)], wrong->message);
}

Result<PointRow> read_json_row(const std::string& path, std::string_view line, int line_number) {
  const auto mistake = [&](const std::string& key, const std::string& message) {
    const std::size_t byte = key.empty() ? 0 : line.find("\"" + key + "\"");
    return mistake_at(path, line_number, column_of(line, std::min(byte, line.size())), message);
  };
  std::set<std::string> keys;
  std::string repeated;
  const auto note_keys = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::key && !keys.insert(parsed.get<std::string>()).second) {
      repeated = parsed.get<std::string>();
    }
    return true;
  };
  json object;
  try {
    object = json::parse(line.begin(), line.end(), note_keys);
  } catch (const json::parse_error& error) {
    return mistake_at(path, line_number, column_of(line, std::max<std::size_t>(error.byte, 1) - 1),
                      "is not JSON: give one object in each line");
  } catch (const json::exception&) {
    return mistake("", "has a number that is too large");
  }
  if (!object.is_object()) return mistake("", "must be an object: {\"time_s\": 0.4, ...}");
  if (!repeated.empty()) return mistake(repeated, "'" + repeated + "' is given twice");
  Numbers numbers{};
  std::vector<Field> fields;
  for (const auto& [key, value] : object.items()) {
    const auto field = field_named(key);
    if (!field) return mistake(key, unknown_field(key));
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      return mistake(key, "'" + key + "' must be a finite number");
    }
    fields.push_back(*field);
    numbers[to_index(*field)] = value.get<double>();
  }
  PointRow row;
  auto wrong = check_fields(fields);
  if (!wrong) wrong = read_row(numbers, row);
  if (!wrong) return row;
  return mistake(wrong->field ? name_of(*wrong->field) : "", wrong->message);
}

}  // namespace weft::known_points
