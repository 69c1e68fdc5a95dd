// SPDX-License-Identifier: Apache-2.0
#include "host/records/npz.hpp"

#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/npz_members.hpp>

namespace weft::host {
namespace {

struct ReadCloser {
  void operator()(void* archive) const { unzClose(archive); }
};
using Archive = std::unique_ptr<void, ReadCloser>;

struct WriteCloser {
  void operator()(void* archive) const { zipClose(archive, nullptr); }
};

Error zip_failure(const std::string& file, const std::string& what) {
  return {Errc::io, what, file};
}

/// True if the record at the end of an archive is whole. minizip reads a missing byte as 0.
bool has_whole_end(const std::string& file, unzFile archive) {
  constexpr std::streamoff kEndBytes = 22;  // before the comment
  unz_global_info64 info{};
  unzGetGlobalInfo64(archive, &info);
  std::ifstream stream(file, std::ios::binary);
  std::string signature(4, '\0');
  stream.seekg(-kEndBytes - static_cast<std::streamoff>(info.size_comment), std::ios::end);
  return stream.read(signature.data(), 4) && signature == "PK\5\6";
}

Result<Archive> open_archive(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code failure;
  const fs::file_status status = fs::status(file, failure);
  if (!fs::exists(status)) return zip_failure(file, "there is no such file");
  if (!fs::is_regular_file(status)) return zip_failure(file, "is no regular file");
  Archive archive(unzOpen64(file.c_str()));
  if (!archive || !has_whole_end(file, archive.get())) {
    return zip_failure(file, "cannot be read as an npz file");
  }
  return archive;
}

/// The whole member at which the archive stands. It is read to its end, where its checksum is
/// compared, and in pieces, because the size that a damaged file states may be anything. `room` is
/// what may still be read of this archive.
Result<NpzMember> read_member(unzFile archive, const std::string& file, std::uint64_t& room) {
  std::string path(UINT16_MAX, '\0');  // the longest name of the format
  unz_file_info64 info{};
  if (unzGetCurrentFileInfo64(archive, &info, path.data(), path.size(), nullptr, 0, nullptr, 0) !=
      UNZ_OK) {
    return zip_failure(file, "is damaged in its list of members");
  }
  path.resize(std::min<std::size_t>(info.size_filename, path.size()));
  const Error damaged = zip_failure(file, "is damaged at the member " + quote(path));
  auto member = NpzMember::of_path(path);
  if (!member || unzOpenCurrentFile(archive) != UNZ_OK) return damaged;
  std::array<char, 1U << 16U> piece;
  int got = 0;
  while ((got = unzReadCurrentFile(archive, piece.data(), piece.size())) > 0) {
    if (to_index(got) > room) {
      return zip_failure(file, "holds far more than its size: " + quote(path) + " is not read");
    }
    room -= to_index(got);
    member->bytes.append(piece.data(), to_index(got));
  }
  if (unzCloseCurrentFile(archive) != UNZ_OK || got < 0) return damaged;
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

/// Stored, not compressed: compressors gain little on measured numbers.
bool add_member(zipFile archive, const NpzMember& member) {
  constexpr uLong kUtf8Names = 1UL << 11U, kVersionMadeBy = 20;
  zip_fileinfo info{};
  info.dosDate = 33UL << 16U;  // 1980-01-01: no hidden time
  const std::string& bytes = member.bytes;
  const bool is_large = bytes.size() >= UINT32_MAX;
  if (zipOpenNewFileInZip4_64(archive, member.path().c_str(), &info, nullptr, 0, nullptr, 0,
                              nullptr, 0, Z_NO_COMPRESSION, 0, -MAX_WBITS, DEF_MEM_LEVEL,
                              Z_DEFAULT_STRATEGY, nullptr, 0, kVersionMadeBy, kUtf8Names,
                              is_large ? 1 : 0) != ZIP_OK) {
    return false;
  }
  constexpr std::size_t kPiece = std::size_t{1} << 30U;  // sizes of one call are 32 bits wide
  for (std::size_t at = 0; at < bytes.size(); at += kPiece) {
    const auto size = static_cast<unsigned>(std::min(kPiece, bytes.size() - at));
    if (zipWriteInFileInZip(archive, bytes.data() + at, size) != ZIP_OK) return false;
  }
  return zipCloseFileInZip(archive) == ZIP_OK;
}

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
  errno = 0;
  std::unique_ptr<void, WriteCloser> archive(
      zipOpen64(unfinished.path().c_str(), APPEND_STATUS_CREATE));
  if (!archive) return zip_failure(file, "cannot be created; is the folder writable?");
  bool written = true;
  for (const NpzMember& member : members) written = written && add_member(archive.get(), member);
  written = zipClose(archive.release(), nullptr) == ZIP_OK && written;
  if (!written) return failure(std::error_code(errno, std::generic_category()));
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
  unz_global_info64 info{};
  unzGetGlobalInfo64(archive.get(), &info);
  if (info.number_entry > to_index(kMostNpzMembers)) {
    return zip_failure(file, "has more than " + std::to_string(kMostNpzMembers) + " members");
  }
  for (std::uint64_t i = 0; i < info.number_entry; ++i) {
    if (i > 0 && unzGoToNextFile(archive.get()) != UNZ_OK) {
      return zip_failure(file, "is damaged in its list of members");
    }
    const auto member = read_member(archive.get(), file, room);
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
