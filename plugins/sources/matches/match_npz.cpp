// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/npy.hpp>

#include "common/npz_file.hpp"
#include "match_files.hpp"

namespace weft::matches {
namespace {

constexpr std::string_view kMatches = "correspondences/", kTruth = "ground_truth/";

/// Two columns in one array [N,2].
struct Places {
  const char* name;
  Column x, y;
};
constexpr std::array<Places, 4> kPlaces{
    {{"template_px", Column::template_x_px, Column::template_y_px},
     {"template_xy_m", Column::template_x_m, Column::template_y_m},
     {"image_px", Column::image_x_px, Column::image_y_px},
     {"match_xy_px", Column::true_x_px, Column::true_y_px}}};

bool is_array(std::string_view name) { return name.ends_with(".npy"); }

/// The array of a member with data of matches. Arrays of Weft's records that a file of matches may
/// not have are ignored; in other files, every array must be known.
struct Named {
  std::string name;
  bool of_record = false;
};
std::optional<Named> array_in(std::string_view member) {
  Named named{std::string(member.substr(0, member.size() - 4)), member.find('/') != member.npos};
  if (!named.of_record) return named;
  if (member.starts_with(kMatches)) named.name.erase(0, kMatches.size());
  if (member.starts_with(kTruth)) {
    named.name.erase(0, kTruth.size());
    if (named.name != "match_xy_px" && named.name != "match_label") return std::nullopt;
  }
  if (named.name == "match_label") named.name = "label";
  return named;
}

template <class T>
double element(const char* data, std::int64_t index) {
  T value;
  std::memcpy(&value, data + to_index(index) * sizeof(T), sizeof(T));
  return static_cast<double>(value);
}

double number_at(std::int32_t dtype, const char* data, std::int64_t index) {
  switch (dtype) {
    case WEFT_U8:
      return element<std::uint8_t>(data, index);
    case WEFT_I8:
      return element<std::int8_t>(data, index);
    case WEFT_U16:
      return element<std::uint16_t>(data, index);
    case WEFT_I16:
      return element<std::int16_t>(data, index);
    case WEFT_I32:
      return element<std::int32_t>(data, index);
    case WEFT_I64:
      return element<std::int64_t>(data, index);
    case WEFT_F32:
      return element<float>(data, index);
    default:
      return element<double>(data, index);
  }
}

class NpzReader {
 public:
  explicit NpzReader(const std::string& path) : path_(path) {}

  Result<void> add(const sources::ArchiveMember& member) {
    const auto named = array_in(member.name);
    if (!named) return {};
    for (const Places& places : kPlaces) {
      if (named->name == places.name) return add_columns(member, {places.x, places.y});
    }
    const auto column = column_named(named->name);
    const bool alone = column && std::none_of(kPlaces.begin(), kPlaces.end(), [&](const auto& p) {
                         return p.x == *column || p.y == *column;
                       });
    if (alone) return add_columns(member, {*column});
    if (named->of_record) return {};
    return mistake(member, "is unknown: " + known() + "; remove or rename it");
  }

  Result<MatchTable> table() {
    if (const auto wrong = table_.mistake()) {
      return Error{Errc::invalid_data, path_ + ": " + *wrong + " (" + known() + ")"};
    }
    return std::move(table_);
  }

 private:
  Error mistake(const sources::ArchiveMember& member, const std::string& message) const {
    return {Errc::invalid_data, path_ + ": " + escaped(member.name, 80) + " " + message, {}};
  }

  static std::string known() {
    return "arrays are template_px or template_xy_m, image_px, match_xy_px [N,2] and label, score, "
           "kept, frame, distance, ratio, scale_ratio, angle_difference_rad [N]";
  }

  Result<void> add_columns(const sources::ArchiveMember& member,
                           const std::vector<Column>& columns) {
    const auto header = parse_npy(member.bytes);
    if (!header) {
      return mistake(member, header.error().message +
                                 "; save it as numbers in C order: "
                                 "numpy.ascontiguousarray(a, dtype=float)");
    }
    const auto width = static_cast<std::int64_t>(columns.size());
    const bool fits = width == 1 ? header->shape.size() == 1
                                 : header->shape.size() == 2 && header->shape[1] == width;
    if (!fits)
      return mistake(member, width == 1 ? "must be of shape [N]" : "must be of shape [N,2]");
    if (rows_ < 0) rows_ = header->shape[0];
    if (header->shape[0] != rows_) {
      return mistake(member, "has " + std::to_string(header->shape[0]) +
                                 " entries where the array before has " + std::to_string(rows_));
    }
    for (std::int64_t k = 0; k < width; ++k) {
      const Column column = columns[to_index(k)];
      if (table_.has(column)) return mistake(member, "is given twice: remove one");
      table_.declare(column);
      table_[column].reserve(to_index(rows_));
      for (std::int64_t n = 0; n < rows_; ++n) {
        worked_in_loop(n);
        const double value =
            number_at(header->dtype, member.bytes.data() + header->data_offset, width * n + k);
        if (const auto wrong = mistake_in(column, value)) {
          return mistake(member, "at " + std::to_string(n) + " " + *wrong);
        }
        table_[column].push_back(value);
      }
    }
    return {};
  }

  const std::string& path_;
  std::int64_t rows_ = -1;
  MatchTable table_;
};

}  // namespace

Result<MatchTable> read_match_npz(const std::string& path) {
  const auto members = sources::read_npz_file(path, &is_array);
  if (!members) return members.error();
  NpzReader reader(path);
  // A record with places in metres has others that stand for nothing.
  const bool in_metres = std::any_of(members->begin(), members->end(), [](const auto& member) {
    return member.name == "correspondences/template_xy_m.npy";
  });
  for (const sources::ArchiveMember& member : *members) {
    if (in_metres && member.name == "correspondences/template_px.npy") continue;
    if (auto added = reader.add(member); !added) return added.error();
  }
  return reader.table();
}

}  // namespace weft::matches
