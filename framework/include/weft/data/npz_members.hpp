// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/npy.hpp>

namespace weft {

/// A file inside an npz archive: the array of a slot in NumPy's format 1.0, or the record's type as
/// text. The archive itself needs a zip library.
struct NpzMember {
  static constexpr const char* kType = "record_type";

  std::string slot, array, bytes;

  std::string path() const { return slot + "/" + array + ".npy"; }
  bool is_type() const { return array == kType; }
  /// Parses the path of a member without its bytes; nothing for a path of another form.
  static std::optional<NpzMember> of_path(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos || !path.ends_with(".npy")) return std::nullopt;
    return NpzMember{path.substr(0, slash), path.substr(slash + 1, path.size() - slash - 5), {}};
  }
};

inline constexpr std::int64_t kMostNpzMembers = 10'000;

/// Limit of the total size of the members, in bytes: a hundred times the archive's size plus 64
/// MiB. It keeps a small file from exhausting the memory.
inline std::uint64_t most_npz_bytes(std::uint64_t file_bytes) {
  constexpr std::uint64_t kMostRatio = 100, kAlways = 1ULL << 26U, kMost = 1ULL << 33U;
  return std::min(kMost, kAlways + kMostRatio * std::min(file_bytes, kMost));
}

/// Appends the members of a record: first its type, then its arrays.
inline void add_npz_members(const weft_record& record, std::vector<NpzMember>& members) {
  const std::string type = record.type;
  weft_array text{};
  text.dtype = WEFT_U8;
  text.ndim = 1;
  text.shape[0] = static_cast<std::int64_t>(type.size());
  text.stride[0] = 1;
  text.data = const_cast<char*>(type.data());
  members.push_back({record.slot, NpzMember::kType, to_npy(text)});
  for (std::uint64_t i = 0; i < record.count; ++i) {
    members.push_back({record.slot, record.arrays[i].name, to_npy(record.arrays[i])});
  }
}

/// The record of one slot, which owns the bytes of its members.
class NpzRecord {
 public:
  /// Fails if the slot's type is missing or a member is not an array.
  static Result<NpzRecord> create(std::vector<NpzMember> members, const std::string& slot) {
    std::erase_if(members, [&](const NpzMember& member) { return member.slot != slot; });
    NpzRecord record;
    record.members_ = std::move(members);
    std::set<std::string> arrays;
    for (const NpzMember& member : record.members_) {
      if (!arrays.insert(member.array).second) {
        return Error{Errc::invalid_data, "has the member " + member.path() + " twice"};
      }
      auto header = parse_npy(member.bytes);
      if (!header) {
        return Error{Errc::invalid_data, member.path() + " " + header.error().message};
      }
      record.headers_.push_back(*std::move(header));
      if (member.is_type()) record.type_ = member.bytes.substr(record.headers_.back().data_offset);
    }
    if (!record.type_.empty()) return record;
    return Error{Errc::invalid_data, "there is no record '" + slot + "'"};
  }

  /// Calls read(weft_record); the record is valid for the lifetime of this object.
  template <class Read>
  auto with_view(Read&& read) const {
    std::vector<weft_array> arrays;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (!members_[i].is_type()) arrays.push_back(view(members_[i], headers_[i]));
    }
    const std::string slot = members_.front().slot;
    const weft_record record{slot.c_str(),  type_.c_str(), 0, 0, arrays.size(),
                             arrays.data(), WEFT_NO_FRAME, 0, 0, {}};
    return read(record);
  }

 private:
  static weft_array view(const NpzMember& member, const NpyHeader& header) {
    weft_array array{};
    array.name = member.array.c_str();
    array.dtype = header.dtype;
    array.ndim = static_cast<std::int32_t>(header.shape.size());
    array.data = const_cast<char*>(member.bytes.data() + header.data_offset);
    std::int64_t stride = dtype_size(header.dtype);
    for (int axis = array.ndim - 1; axis >= 0; --axis) {
      array.shape[axis] = header.shape[to_index(axis)];
      array.stride[axis] = stride;
      stride *= array.shape[axis];
    }
    return array;
  }

  std::vector<NpzMember> members_;
  std::vector<NpyHeader> headers_;
  std::string type_;
};

}  // namespace weft
