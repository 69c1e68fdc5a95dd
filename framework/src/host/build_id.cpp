// SPDX-License-Identifier: Apache-2.0
#include <elf.h>

#include <cstring>
#include <fstream>
#include <vector>
#include <weft/host/build_id.hpp>

namespace weft::host {
namespace {

template <class T>
bool read_at(std::ifstream& stream, std::uint64_t offset, T* target, std::size_t count = 1) {
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(reinterpret_cast<char*>(target), static_cast<std::streamsize>(sizeof(T) * count));
  return static_cast<bool>(stream);
}

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

Result<std::string> read_build_id(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Error{Errc::io, "cannot be read", file};
  Elf64_Ehdr header;
  if (!read_at(stream, 0, &header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_ident[EI_CLASS] != ELFCLASS64) {
    return Error{Errc::incompatible, "is no 64-bit ELF file", file};
  }
  for (int i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    const auto step = static_cast<std::uint64_t>(i) * sizeof(segment);
    if (!read_at(stream, header.e_phoff + step, &segment)) {
      return Error{Errc::incompatible, "is a truncated ELF file", file};
    }
    constexpr std::uint64_t kLargestNote = 1U << 20U;
    if (segment.p_type != PT_NOTE || segment.p_filesz > kLargestNote) continue;
    std::vector<unsigned char> notes(segment.p_filesz);
    if (!read_at(stream, segment.p_offset, notes.data(), notes.size())) {
      return Error{Errc::incompatible, "is a truncated ELF file", file};
    }
    if (std::string id = build_id_in_notes(notes); !id.empty()) return id;
  }
  return std::string{};
}

}  // namespace weft::host
