// SPDX-License-Identifier: Apache-2.0
#include "host/describe/build_id.hpp"

#include <cstring>

namespace weft::host {
namespace {

std::string to_hex(const unsigned char* bytes, std::size_t count) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += kDigits[bytes[i] >> 4U];
    text += kDigits[bytes[i] & 15U];
  }
  return text;
}

std::string build_id_in_notes(const std::vector<unsigned char>& notes) {
  const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
  std::size_t offset = 0;
  while (offset + sizeof(Elf64_Nhdr) <= notes.size()) {
    Elf64_Nhdr header;
    std::memcpy(&header, notes.data() + offset, sizeof(header));
    const std::size_t name = offset + sizeof(header);
    const std::size_t content = name + padded(header.n_namesz);
    const std::size_t next = content + padded(header.n_descsz);
    if (next > notes.size() || next <= offset) return {};
    if (header.n_type == NT_GNU_BUILD_ID && header.n_namesz == 4 &&
        std::memcmp(notes.data() + name, "GNU", 4) == 0) {
      return to_hex(notes.data() + content, header.n_descsz);
    }
    offset = next;
  }
  return {};
}

}  // namespace

Result<std::string> read_build_id(const std::string& path) {
  const auto file = ElfFile::open(path);
  if (!file) return file.error();
  return build_id_of(*file);
}

std::string build_id_of(const ElfFile& file) {
  for (const Elf64_Phdr& segment : file.segments()) {
    constexpr std::uint64_t kLargestNote = 1U << 20U;
    if (segment.p_type != PT_NOTE || segment.p_filesz > kLargestNote) continue;
    std::vector<unsigned char> notes(segment.p_filesz);
    if (!file.read(segment.p_offset, notes.data(), notes.size())) continue;
    if (std::string id = build_id_in_notes(notes); !id.empty()) return id;
  }
  return {};
}

Result<void> check_library_file(const std::string& path) {
  const auto file = ElfFile::open(path);
  return file ? check_dynamic_tables(*file) : file.error();
}

}  // namespace weft::host
