// SPDX-License-Identifier: Apache-2.0
#include "common/npz_file.hpp"

#include <zip.h>

#include <array>
#include <filesystem>
#include <memory>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/npz_members.hpp>

namespace weft::sources {
namespace {

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct Close {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

/// Reads a member to its end, where its checksum is compared, and in pieces, because the size that
/// a damaged file states may be anything.
/// `room` is what may still be read of this archive.
bool read_bytes(zip_t* archive, zip_uint64_t index, std::string& bytes, std::uint64_t& room) {
  const std::unique_ptr<zip_file_t, Close> stream(zip_fopen_index(archive, index, 0));
  if (!stream) return false;
  std::array<char, 1U << 16U> piece;
  zip_int64_t got = 0;
  while ((got = zip_fread(stream.get(), piece.data(), piece.size())) > 0) {
    worked(1000);
    if (static_cast<std::uint64_t>(got) > room) return false;
    room -= static_cast<std::uint64_t>(got);
    bytes.append(piece.data(), to_index(got));
  }
  return got == 0;
}

}  // namespace

Result<std::vector<ArchiveMember>> read_npz_file(const std::string& path,
                                                 bool (*wanted)(std::string_view name)) {
  const auto fail = [&](const char* what) { return Error{Errc::io, path + ": " + what}; };
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) return fail("is no file that can be read");
  std::uint64_t room = most_npz_bytes(std::filesystem::file_size(path, failure));
  int code = 0;
  const std::unique_ptr<zip_t, Discard> archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive) return fail("cannot be read as an npz file");
  std::vector<ArchiveMember> members;
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count > kMostNpzMembers) return fail("has too many members");
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* name = zip_get_name(archive.get(), index, 0);
    ArchiveMember member{name != nullptr ? name : "", {}};
    if (!wanted(member.name)) continue;
    if (!read_bytes(archive.get(), index, member.bytes, room)) {
      return Error{Errc::invalid_data, path + ": is damaged, or holds far more than its size, at " +
                                           escaped(member.name, 80)};
    }
    members.push_back(std::move(member));
  }
  return members;
}

}  // namespace weft::sources
