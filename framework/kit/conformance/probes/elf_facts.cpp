// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/elf_facts.hpp"

#include <elf.h>

#include "host/describe/elf_file.hpp"

namespace weft::conformance {
namespace {

constexpr std::uint64_t kMostTableBytes = 256 << 20;  ///< maximum size of a table

template <class Entry>
std::vector<Entry> entries_of(const host::ElfFile& file, const Elf64_Shdr& section) {
  std::vector<Entry> entries(std::min(section.sh_size, kMostTableBytes) / sizeof(Entry));
  if (!file.read(section.sh_offset, entries.data(), entries.size() * sizeof(Entry))) return {};
  return entries;
}

bool is_for_others(const Elf64_Sym& symbol) {
  const auto bind = ELF64_ST_BIND(symbol.st_info);
  const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && bind != STB_LOCAL && visibility != STV_HIDDEN &&
         visibility != STV_INTERNAL;
}

}  // namespace

Result<ElfFacts> read_elf_facts(const std::string& library) {
  const auto file = host::ElfFile::open(library);
  if (!file) return file.error();
  ElfFacts facts;
  for (const Elf64_Shdr& section : file->sections()) {
    if (section.sh_type == SHT_DYNAMIC) {
      for (const auto& entry : entries_of<Elf64_Dyn>(*file, section)) {
        const bool says = entry.d_tag == DT_FLAGS && (entry.d_un.d_val & DF_STATIC_TLS) != 0;
        facts.has_static_tls = facts.has_static_tls || says;
      }
    }
    if (section.sh_type != SHT_DYNSYM || section.sh_link >= file->sections().size()) continue;
    const auto names = entries_of<char>(*file, file->sections()[section.sh_link]);
    for (const auto& symbol : entries_of<Elf64_Sym>(*file, section)) {
      if (!is_for_others(symbol) || symbol.st_name >= names.size()) continue;
      facts.exported.emplace_back(names.data() + symbol.st_name);
    }
  }
  return facts;
}

}  // namespace weft::conformance
