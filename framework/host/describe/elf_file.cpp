// SPDX-License-Identifier: Apache-2.0
#include "host/describe/elf_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <weft/core/text_file.hpp>

namespace weft::host {

ElfFile::ElfFile(ElfFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      size_(other.size_),
      segments_(std::move(other.segments_)),
      sections_(std::move(other.sections_)) {}

ElfFile::~ElfFile() {
  if (file_ >= 0) close(file_);
}

Result<ElfFile> ElfFile::open(const std::string& path) {
  ElfFile file(path);
  if (auto done = file.open_file(); !done) return done.error();
  if (auto done = file.read_headers(); !done) return done.error();
  if (auto done = file.check_segments(); !done) return done.error();
  if (auto done = file.check_sections(); !done) return done.error();
  return file;
}

Error ElfFile::damaged(const std::string& what) const {
  return {Errc::incompatible, "is a damaged ELF file: " + what, path_};
}

Error ElfFile::truncated(const std::string& what) const {
  return {
      Errc::incompatible,
      "is a truncated ELF file: " + what + " beyond its end at " + std::to_string(size_) + " bytes",
      path_};
}

Result<void> ElfFile::open_file() {
  file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) {
    const std::string why = std::string("cannot be read: ") + std::strerror(errno);
    const auto found = check_input(path_, InputKind::file);
    return Error{Errc::io, found ? why : found.error().message, path_};
  }
  struct stat status {};
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    return Error{Errc::io, "is no regular file", path_};
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
  return {};
}

bool ElfFile::read(std::uint64_t offset, void* target, std::uint64_t bytes) const {
  if (!has(offset, bytes)) return false;
  auto* to = static_cast<char*>(target);
  while (bytes > 0) {
    const ssize_t got = pread(file_, to, bytes, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    offset += static_cast<std::uint64_t>(got);
    bytes -= static_cast<std::uint64_t>(got);
  }
  return true;
}

Result<void> ElfFile::read_headers() {
  Elf64_Ehdr header;
  if (!read(0, &header, sizeof(header)) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_ident[EI_CLASS] != ELFCLASS64) {
    return Error{Errc::incompatible, "is no 64-bit ELF file", path_};
  }
  if (header.e_ident[EI_DATA] != ELFDATA2LSB || header.e_machine != EM_X86_64) {
    return Error{Errc::incompatible, "is an ELF file for another processor than x86-64", path_};
  }
  if (header.e_type != ET_DYN) return damaged("it is no shared library");
  if (header.e_phentsize != sizeof(Elf64_Phdr)) return damaged("its segments have a wrong size");
  segments_.resize(header.e_phnum);
  if (!read(header.e_phoff, segments_.data(), segments_.size() * sizeof(Elf64_Phdr))) {
    return truncated("its program headers reach");
  }
  if (header.e_shnum == 0) return {};  // all that is not loaded may be stripped
  if (header.e_shentsize != sizeof(Elf64_Shdr)) return damaged("its sections have a wrong size");
  sections_.resize(header.e_shnum);
  if (!read(header.e_shoff, sections_.data(), sections_.size() * sizeof(Elf64_Shdr))) {
    return truncated("its section headers reach");
  }
  return {};
}

Result<void> ElfFile::check_segments() const {
  std::uint64_t loaded_to = 0;
  bool any = false;
  for (const Elf64_Phdr& segment : segments_) {
    if (!has(segment.p_offset, segment.p_filesz)) return truncated("a segment reaches");
    constexpr std::uint64_t kLargest = std::uint64_t{1} << 40U;
    if (segment.p_memsz > kLargest || segment.p_vaddr > kLargest) {
      return damaged("a segment is larger than any memory");
    }
    if (segment.p_type != PT_LOAD) continue;
    if (segment.p_filesz > segment.p_memsz || (any && segment.p_vaddr < loaded_to)) {
      return damaged("its segments overlap");
    }
    loaded_to = segment.p_vaddr + segment.p_memsz;
    any = true;
  }
  if (!any) return damaged("nothing of it is to be loaded");
  for (const Elf64_Phdr& segment : segments_) {
    const bool used = segment.p_type == PT_DYNAMIC || segment.p_type == PT_TLS ||
                      segment.p_type == PT_NOTE || segment.p_type == PT_GNU_EH_FRAME ||
                      segment.p_type == PT_GNU_RELRO;
    if (!used) continue;
    const Elf64_Phdr* loaded = loaded_at(segment.p_vaddr, segment.p_filesz);
    if (loaded == nullptr ||
        segment.p_vaddr - loaded->p_vaddr != segment.p_offset - loaded->p_offset) {
      return damaged("a segment lies outside of those that are loaded");
    }
  }
  return {};
}

Result<void> ElfFile::check_sections() const {
  for (const Elf64_Shdr& section : sections_) {
    const bool has_bytes = section.sh_type != SHT_NOBITS && section.sh_type != SHT_NULL;
    if (has_bytes && !has(section.sh_offset, section.sh_size))
      return truncated("a section reaches");
    const bool of_threads = (section.sh_flags & SHF_TLS) != 0;
    if ((section.sh_flags & SHF_ALLOC) == 0 || section.sh_size == 0 || (of_threads && !has_bytes)) {
      continue;
    }
    const auto holds = [&](const Elf64_Phdr& segment) {
      const std::uint64_t size = has_bytes ? segment.p_filesz : segment.p_memsz;
      const std::uint64_t at = section.sh_addr - segment.p_vaddr;
      return segment.p_type == PT_LOAD && section.sh_addr >= segment.p_vaddr && at <= size &&
             section.sh_size <= size - at &&
             (!has_bytes || section.sh_offset - segment.p_offset == at) &&
             ((section.sh_flags & SHF_WRITE) == 0 || (segment.p_flags & PF_W) != 0) &&
             ((section.sh_flags & SHF_EXECINSTR) == 0 || (segment.p_flags & PF_X) != 0) &&
             (segment.p_flags & PF_R) != 0;
    };
    if (std::none_of(segments_.begin(), segments_.end(), holds)) {
      return damaged("its sections and segments contradict each other");
    }
  }
  // The segment that is made read-only after loading ends before the data that stay writable.
  const auto is_zeroed = [](const Elf64_Shdr& section) {
    return section.sh_type == SHT_NOBITS && (section.sh_flags & SHF_TLS) == 0 &&
           (section.sh_flags & SHF_ALLOC) != 0 && section.sh_size > 0;
  };
  for (const Elf64_Phdr& segment : segments_) {
    if (segment.p_type != PT_GNU_RELRO) continue;
    const std::uint64_t end = segment.p_vaddr + segment.p_memsz;
    const Elf64_Phdr* loaded = loaded_at(segment.p_vaddr, segment.p_filesz);
    constexpr std::uint64_t kPage = 4096;
    const std::uint64_t most = (loaded->p_vaddr + loaded->p_memsz + kPage - 1) / kPage * kPage;
    const bool covers = std::any_of(
        sections_.begin(), sections_.end(),
        [&](const Elf64_Shdr& section) { return is_zeroed(section) && section.sh_addr < end; });
    if (end > most || covers) return damaged("it protects what it must write to");
  }
  return {};
}

const Elf64_Phdr* ElfFile::loaded_at(std::uint64_t address, std::uint64_t bytes) const {
  for (const Elf64_Phdr& segment : segments_) {
    if (segment.p_type == PT_LOAD && address >= segment.p_vaddr &&
        address - segment.p_vaddr <= segment.p_filesz &&
        bytes <= segment.p_filesz - (address - segment.p_vaddr)) {
      return &segment;
    }
  }
  return nullptr;
}

}  // namespace weft::host
