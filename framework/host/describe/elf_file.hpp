// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <elf.h>

#include <cstdint>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::host {

/// The headers of a complete 64-bit ELF file, read without mapping it. A process that maps a
/// truncated file is killed by a signal at the first access beyond its end. For this reason each
/// library is opened here before it is loaded.
class ElfFile {
 public:
  /// Fails with io if there is no readable regular file. Fails with incompatible if its headers
  /// contradict each other or name bytes that the file does not have: "is a truncated ELF file".
  /// Does not wait for a pipe.
  static Result<ElfFile> open(const std::string& path);

  ElfFile(ElfFile&& other) noexcept;
  ElfFile& operator=(ElfFile&&) = delete;
  ~ElfFile();

  const std::string& path() const { return path_; }
  const std::vector<Elf64_Phdr>& segments() const { return segments_; }
  const std::vector<Elf64_Shdr>& sections() const { return sections_; }

  /// False unless all `bytes` at `offset` of the file were read.
  bool read(std::uint64_t offset, void* target, std::uint64_t bytes) const;

  /// True if the file has these bytes.
  bool has(std::uint64_t offset, std::uint64_t bytes) const {
    return offset <= size_ && bytes <= size_ - offset;
  }

  /// The segment that is loaded from the file to these addresses; null when there is none.
  const Elf64_Phdr* loaded_at(std::uint64_t address, std::uint64_t bytes) const;

 private:
  explicit ElfFile(std::string path) : path_(std::move(path)) {}
  Result<void> open_file();
  Result<void> read_headers();
  Result<void> check_segments() const;
  Result<void> check_sections() const;
  Error damaged(const std::string& what) const;
  Error truncated(const std::string& what) const;

  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;  ///< [bytes]
  std::vector<Elf64_Phdr> segments_;
  std::vector<Elf64_Shdr> sections_;
};

/// Checks that the dynamic linker can follow the tables of a library: each table is in a loaded
/// segment, and each relocation target is writable. Fails with incompatible.
Result<void> check_dynamic_tables(const ElfFile& file);

/// The names in the dynamic section of a library: of what it needs, and of symbols that it takes or
/// gives, each with a NUL before and behind it. Empty where it has none.
std::string dynamic_names(const ElfFile& file);

}  // namespace weft::host
