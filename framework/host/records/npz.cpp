// SPDX-License-Identifier: Apache-2.0
#include "host/records/npz.hpp"

#include <zip.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/npz_members.hpp>

namespace weft::host {
namespace {

struct ZipCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, ZipCloser>;

Error zip_failure(const std::string& file, const std::string& what) {
  return {Errc::io, what, file};
}

Result<Archive> open_archive(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code failure;
  const fs::file_status status = fs::status(file, failure);
  if (!fs::exists(status)) return zip_failure(file, "there is no such file");
  if (!fs::is_regular_file(status)) return zip_failure(file, "is no regular file");
  int code = 0;
  Archive archive(zip_open(file.c_str(), ZIP_RDONLY, &code));
  if (!archive) return zip_failure(file, "cannot be read as an npz file");
  if (zip_get_num_entries(archive.get(), 0) > kMostNpzMembers) {
    return zip_failure(file, "has more than " + std::to_string(kMostNpzMembers) + " members");
  }
  return archive;
}

/// The whole member at `index`. It is read to its end, where its checksum is compared, and in
/// pieces, because the size that a damaged file states may be anything. `room` is what may still be
/// read of this archive.
Result<NpzMember> read_member(zip_t* archive, zip_uint64_t index, const std::string& file,
                              std::uint64_t& room) {
  const char* name = zip_get_name(archive, index, 0);
  const std::string path = name != nullptr ? name : "";
  const Error damaged = zip_failure(file, "is damaged at the member '" + path + "'");
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> stream(zip_fopen_index(archive, index, 0),
                                                                 &zip_fclose);
  if (!stream) return damaged;
  auto member = NpzMember::of_path(path);
  if (!member) return damaged;
  std::array<char, 1U << 16U> piece;
  zip_int64_t got = 0;
  while ((got = zip_fread(stream.get(), piece.data(), piece.size())) > 0) {
    if (static_cast<std::uint64_t>(got) > room) {
      return zip_failure(file, "holds far more than its size: '" + path + "' is not read");
    }
    room -= static_cast<std::uint64_t>(got);
    member->bytes.append(piece.data(), to_index(got));
  }
  if (got < 0) return damaged;
  return *std::move(member);
}

/// The records of a file while its members are read.
struct Assembly {
  std::vector<std::pair<std::string, std::shared_ptr<Record>>> records{};
  std::map<std::string, std::shared_ptr<Record>> by_slot{};
  std::set<std::string> arrays{};

  Result<void> add(const NpzMember& member, const std::string& file) {
    const std::string name = member.slot + "/" + member.array;
    const auto header = parse_npy(member.bytes);
    if (!header) return Error{Errc::invalid_data, name + " " + header.error().message, file};
    const char* data = member.bytes.data() + header->data_offset;
    const std::size_t size = member.bytes.size() - header->data_offset;
    if (member.is_type()) {
      const auto record = std::make_shared<Record>(std::string(data, size));
      if (!by_slot.emplace(member.slot, record).second) {
        return zip_failure(file, "has the slot '" + member.slot + "' twice");
      }
      records.emplace_back(member.slot, record);
      return {};
    }
    const auto found = by_slot.find(member.slot);
    if (found == by_slot.end()) {
      return zip_failure(file,
                         "lacks the type of " + quote(member.slot) + "; was it written by Weft?");
    }
    const auto axes = static_cast<std::int32_t>(header->shape.size());
    if (!arrays.insert(name).second) {
      return zip_failure(file, "has the member '" + name + "' twice");
    }
    void* target = found->second->allocate(member.array, header->dtype, axes, header->shape.data());
    if (target == nullptr) return zip_failure(file, name + " has an illegal name or size");
    std::memcpy(target, data, size);
    return {};
  }
};

}  // namespace

Result<void> write_npz(const std::string& file, const NamedRecords& records,
                       Durability durability) {
  if (records.empty()) return Error{Errc::invalid_value, "there are no records to write", file};
  std::vector<NpzMember> members;
  for (const auto& [slot, record] : records) add_npz_members(record->view(slot.c_str()), members);
  const auto failure = [&](std::error_code reason) {
    return zip_failure(file, "cannot be written (" + why_not_written(reason) + ")");
  };
  UnfinishedFile unfinished(file);
  if (const std::error_code reason = unfinished.status()) return failure(reason);
  int code = 0;
  Archive archive(zip_open(unfinished.path().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (!archive) return zip_failure(file, "cannot be created; is the folder writable?");
  for (const NpzMember& member : members) {
    const std::string name = member.path();
    zip_source_t* source =
        zip_source_buffer(archive.get(), member.bytes.data(), member.bytes.size(), 0);
    const zip_int64_t index = zip_file_add(archive.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      return zip_failure(file, "cannot hold the member " + name);
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    zip_set_file_compression(archive.get(), entry, ZIP_CM_STORE, 0);
    zip_file_set_dostime(archive.get(), entry, 0, 33, 0);  // 1980-01-01: no hidden time
  }
  if (zip_close(archive.get()) != 0) {
    const std::error_code reason(zip_error_code_system(zip_get_error(archive.get())),
                                 std::generic_category());
    if (reason) return failure(reason);
    return zip_failure(file,
                       "cannot be written (" + std::string(zip_strerror(archive.get())) + ")");
  }
  static_cast<void>(archive.release());
  if (const std::error_code reason = unfinished.finish(durability)) return failure(reason);
  return {};
}

Result<NamedRecords> read_npz(const std::string& file, NpzCheck check) {
  const auto opened = open_archive(file);
  if (!opened) return opened.error();
  const Archive& archive = *opened;
  std::error_code failure;
  std::uint64_t room = most_npz_bytes(std::filesystem::file_size(file, failure));
  Assembly assembly;
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto member = read_member(archive.get(), static_cast<zip_uint64_t>(i), file, room);
    if (!member) return member.error();
    if (auto added = assembly.add(*member, file); !added) return added.error();
  }
  NamedRecords result;
  for (auto& [slot, record] : assembly.records) {
    if (check == NpzCheck::catalogue) {
      if (auto valid = validate(record->view(slot.c_str())); !valid) {
        return Error{valid.error().code, "slot '" + slot + "': " + valid.error().message, file};
      }
    }
    result.emplace_back(slot, std::move(record));
  }
  return result;
}

}  // namespace weft::host
