// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <iterator>

#include "host/describe/elf_file.hpp"

namespace weft::host {
namespace {

/// The entries of a library's dynamic section, by tag.
class DynamicTables {
 public:
  explicit DynamicTables(const ElfFile& file) : file_(file) {}

  std::string names() {
    const Elf64_Dyn* table = read_entries() ? find(DT_STRTAB) : nullptr;
    const std::uint64_t bytes = value(DT_STRSZ);
    const Elf64_Phdr* segment =
        table != nullptr ? file_.loaded_at(table->d_un.d_ptr, bytes) : nullptr;
    if (segment == nullptr) return {};
    std::string text(bytes, '\0');
    const std::uint64_t start = segment->p_offset + (table->d_un.d_ptr - segment->p_vaddr);
    return file_.read(start, text.data(), bytes) ? text : std::string();
  }

  Result<void> check() {
    if (!read_entries()) return damaged("its dynamic section is missing or has no end");
    for (const Place& place : kTables) {
      if (!is_inside(place)) return damaged("a table of its dynamic section lies outside of it");
    }
    if (!sections_agree())
      return damaged("its dynamic section and its sections contradict each other");
    if (!names_are_inside()) return damaged("a name in its dynamic section lies outside of it");
    for (const Place& place : {Place{DT_RELA, DT_RELASZ, 0}, Place{DT_JMPREL, DT_PLTRELSZ, 0}}) {
      if (!relocations_are_inside(place)) return damaged("a relocation of it lies outside of it");
    }
    return {};
  }

 private:
  /// A table and the source of its size: another tag, or else its least size in bytes.
  struct Place {
    std::int64_t at, size;
    std::uint64_t least;
  };
  static constexpr Place kTables[] = {{DT_STRTAB, DT_STRSZ, 0},
                                      {DT_SYMTAB, 0, sizeof(Elf64_Sym)},
                                      {DT_RELA, DT_RELASZ, 0},
                                      {DT_JMPREL, DT_PLTRELSZ, 0},
                                      {DT_GNU_HASH, 0, 16},
                                      {DT_HASH, 0, 8},
                                      {DT_VERSYM, 0, 2},
                                      {DT_VERNEED, 0, sizeof(Elf64_Verneed)},
                                      {DT_VERDEF, 0, sizeof(Elf64_Verdef)},
                                      {DT_INIT_ARRAY, DT_INIT_ARRAYSZ, 0},
                                      {DT_FINI_ARRAY, DT_FINI_ARRAYSZ, 0},
                                      {DT_INIT, 0, 1},
                                      {DT_FINI, 0, 1}};

  /// The tags that point to a section of a type, and give its size or its number of parts.
  struct Twin {
    std::uint32_t type;
    std::int64_t at, size, parts;
  };
  static constexpr Twin kTwins[] = {{SHT_DYNSYM, DT_SYMTAB, 0, 0},
                                    {SHT_GNU_HASH, DT_GNU_HASH, 0, 0},
                                    {SHT_HASH, DT_HASH, 0, 0},
                                    {SHT_GNU_versym, DT_VERSYM, 0, 0},
                                    {SHT_GNU_verneed, DT_VERNEED, 0, DT_VERNEEDNUM},
                                    {SHT_GNU_verdef, DT_VERDEF, 0, DT_VERDEFNUM},
                                    {SHT_INIT_ARRAY, DT_INIT_ARRAY, DT_INIT_ARRAYSZ, 0},
                                    {SHT_FINI_ARRAY, DT_FINI_ARRAY, DT_FINI_ARRAYSZ, 0}};

  Error damaged(const std::string& what) const {
    return {Errc::incompatible, "is a damaged ELF file: " + what, file_.path()};
  }

  bool read_entries() {
    for (const Elf64_Phdr& segment : file_.segments()) {
      if (segment.p_type != PT_DYNAMIC) continue;
      entries_.resize(segment.p_filesz / sizeof(Elf64_Dyn));
      if (!file_.read(segment.p_offset, entries_.data(), entries_.size() * sizeof(Elf64_Dyn))) {
        return false;
      }
      const auto end = std::find_if(entries_.begin(), entries_.end(),
                                    [](const Elf64_Dyn& entry) { return entry.d_tag == DT_NULL; });
      if (end == entries_.end()) return false;
      entries_.erase(end, entries_.end());
      return find(DT_STRTAB) != nullptr && find(DT_SYMTAB) != nullptr;
    }
    return false;
  }

  const Elf64_Dyn* find(std::int64_t tag) const {
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Elf64_Dyn& entry) { return entry.d_tag == tag; });
    return found != entries_.end() ? &*found : nullptr;
  }

  std::uint64_t value(std::int64_t tag) const {
    const Elf64_Dyn* entry = find(tag);
    return entry != nullptr ? entry->d_un.d_val : 0;
  }

  bool is_inside(const Place& place) const {
    const Elf64_Dyn* table = find(place.at);
    if (table == nullptr) return true;
    const std::uint64_t bytes = place.size != 0 ? value(place.size) : place.least;
    const Elf64_Phdr* segment = file_.loaded_at(table->d_un.d_ptr, bytes);
    const bool is_code = place.at == DT_INIT || place.at == DT_FINI;
    return segment != nullptr && (!is_code || (segment->p_flags & PF_X) != 0);
  }

  const Elf64_Shdr* section_at(std::uint32_t type, std::int64_t tag) const {
    for (const Elf64_Shdr& section : file_.sections()) {
      if (section.sh_type == type && section.sh_addr == value(tag)) return &section;
    }
    return nullptr;
  }

  /// True if a table is absent or is exactly one section.
  bool is_section(std::uint32_t type, std::int64_t at, std::int64_t size) const {
    if (find(at) == nullptr) return true;
    const Elf64_Shdr* section = section_at(type, at);
    return section != nullptr && (size == 0 || value(size) == section->sh_size);
  }

  /// Checks that section headers, if not stripped, agree with the dynamic section: the linker
  /// writes both.
  bool sections_agree() const {
    const auto is_size = [&](std::int64_t tag, std::uint64_t size) {
      return find(tag) == nullptr || value(tag) == size;
    };
    if (!is_size(DT_SYMENT, sizeof(Elf64_Sym)) || !is_size(DT_RELAENT, sizeof(Elf64_Rela)) ||
        !is_size(DT_PLTREL, DT_RELA) || find(DT_REL) != nullptr) {
      return false;
    }
    if (file_.sections().empty()) return true;
    for (const Twin& twin : kTwins) {
      const auto is_it = [&](const Elf64_Shdr& section) { return section.sh_type == twin.type; };
      const auto& sections = file_.sections();
      const auto section = std::find_if(sections.begin(), sections.end(), is_it);
      if (section == sections.end() || section->sh_size == 0) continue;
      if (find(twin.at) == nullptr || !is_section(twin.type, twin.at, twin.size) ||
          (twin.parts != 0 && value(twin.parts) != section->sh_info)) {
        return false;
      }
    }
    return is_section(SHT_STRTAB, DT_STRTAB, DT_STRSZ) &&
           is_section(SHT_RELA, DT_RELA, DT_RELASZ) &&
           is_section(SHT_RELA, DT_JMPREL, DT_PLTRELSZ) && is_section(SHT_PROGBITS, DT_INIT, 0) &&
           is_section(SHT_PROGBITS, DT_FINI, 0) && is_section(SHT_PROGBITS, DT_PLTGOT, 0) &&
           relocated() == std::count_if(file_.sections().begin(), file_.sections().end(),
                                        [](const Elf64_Shdr& section) {
                                          return section.sh_type == SHT_RELA &&
                                                 (section.sh_flags & SHF_ALLOC) != 0;
                                        });
  }

  /// [tables] of relocations.
  std::ptrdiff_t relocated() const {
    return (find(DT_RELA) != nullptr ? 1 : 0) + (find(DT_JMPREL) != nullptr ? 1 : 0);
  }

  bool names_are_inside() const {
    return std::all_of(entries_.begin(), entries_.end(), [&](const Elf64_Dyn& entry) {
      const bool names = entry.d_tag == DT_NEEDED || entry.d_tag == DT_SONAME ||
                         entry.d_tag == DT_RPATH || entry.d_tag == DT_RUNPATH;
      return !names || entry.d_un.d_val < value(DT_STRSZ);
    });
  }

  /// The address range of a table in memory.
  struct Range {
    std::uint64_t start, bytes;

    bool holds(std::uint64_t address) const { return address - start < bytes; }
  };
  Range range(std::int64_t at, std::int64_t size) const { return {value(at), value(size)}; }

  /// The loaded segment with an address, or just before it; null when there is none.
  static const Elf64_Phdr* in_memory(const std::vector<Elf64_Phdr>& loaded, std::uint64_t address) {
    for (const Elf64_Phdr& segment : loaded) {
      if (address - segment.p_vaddr <= segment.p_memsz) return &segment;
    }
    return nullptr;
  }

  /// Libraries have tens of thousands of them: what they have in common is looked up once.
  bool relocations_are_inside(const Place& place) const {
    const Elf64_Dyn* table = find(place.at);
    if (table == nullptr) return true;
    const Elf64_Phdr* segment = file_.loaded_at(table->d_un.d_ptr, value(place.size));
    std::vector<Elf64_Rela> relocations(value(place.size) / sizeof(Elf64_Rela));
    if (!file_.read(segment->p_offset + (table->d_un.d_ptr - segment->p_vaddr), relocations.data(),
                    relocations.size() * sizeof(Elf64_Rela))) {
      return false;
    }
    std::vector<Elf64_Phdr> loaded;
    std::copy_if(file_.segments().begin(), file_.segments().end(), std::back_inserter(loaded),
                 [](const Elf64_Phdr& part) { return part.p_type == PT_LOAD; });
    const Range starters = range(DT_INIT_ARRAY, DT_INIT_ARRAYSZ);
    const Range enders = range(DT_FINI_ARRAY, DT_FINI_ARRAYSZ);
    for (const Elf64_Rela& relocation : relocations) {
      const Elf64_Phdr* target = in_memory(loaded, relocation.r_offset);
      if (target == nullptr || (target->p_flags & PF_W) == 0) return false;
      if (ELF64_R_TYPE(relocation.r_info) != R_X86_64_RELATIVE) continue;
      const Elf64_Phdr* meant = in_memory(loaded, static_cast<std::uint64_t>(relocation.r_addend));
      const bool is_called =
          starters.holds(relocation.r_offset) || enders.holds(relocation.r_offset);
      if (meant == nullptr || (is_called && (meant->p_flags & PF_X) == 0)) return false;
    }
    return true;
  }

  const ElfFile& file_;
  std::vector<Elf64_Dyn> entries_;
};

}  // namespace

Result<void> check_dynamic_tables(const ElfFile& file) { return DynamicTables(file).check(); }

std::string dynamic_names(const ElfFile& file) { return DynamicTables(file).names(); }

}  // namespace weft::host
