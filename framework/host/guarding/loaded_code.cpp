// SPDX-License-Identifier: Apache-2.0
#include "host/guarding/loaded_code.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <mutex>

namespace weft::host {
namespace {

struct Code {
  std::uintptr_t begin, end;
  std::array<char, 128> file;
};

// Signal handlers can access only objects with static storage.
std::array<Code, 512> noted{};
std::atomic<std::size_t> count{0};

const Code* code_at(std::uintptr_t address) {
  const Code* const begin = noted.data();
  const Code* const end = begin + count.load();
  const Code* const found = std::find_if(
      begin, end, [&](const Code& code) { return code.begin <= address && address < code.end; });
  return found != end ? found : nullptr;
}

/// Sets the range of the executable segments of the library that is mapped at the base address of
/// `data`, a Code.
int find_code(dl_phdr_info* info, std::size_t, void* data) {
  Code& code = *static_cast<Code*>(data);
  if (info->dlpi_addr != code.begin) return 0;
  code.end = code.begin;
  std::uintptr_t begin = UINTPTR_MAX;
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = info->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_X) == 0) continue;
    begin = std::min<std::uintptr_t>(begin, info->dlpi_addr + segment.p_vaddr);
    code.end =
        std::max<std::uintptr_t>(code.end, info->dlpi_addr + segment.p_vaddr + segment.p_memsz);
  }
  code.begin = std::min(begin, code.end);
  return 1;
}

}  // namespace

void note_code_of(const void* symbol, const std::string& file) {
  static std::mutex noting;
  const std::lock_guard lock(noting);
  Dl_info where{};
  link_map* map = nullptr;
  void* const found = static_cast<void*>(&map);
  if (count == noted.size() ||
      dladdr1(symbol, &where, static_cast<void**>(found), RTLD_DL_LINKMAP) == 0 || map == nullptr) {
    return;
  }
  Code code{map->l_addr, 0, {}};
  if (dl_iterate_phdr(find_code, &code) == 0 || code_at(code.begin) != nullptr) return;
  const std::string name = std::filesystem::path(file).filename().string();
  std::copy_n(name.begin(), std::min(name.size(), code.file.size() - 1), code.file.begin());
  noted[count] = code;
  ++count;
}

const char* library_that_runs(std::uintptr_t instruction, std::uintptr_t stack_top) {
  if (const Code* code = code_at(instruction)) return code->file.data();
  // A stack may end at any page, so it is read by the kernel.
  const int memory = open("/proc/self/mem", O_RDONLY | O_CLOEXEC);
  const char* library = nullptr;
  std::array<std::uintptr_t, 128> words{};
  constexpr std::size_t kMostBytes = 65536;
  std::size_t read_bytes = 0;
  while (memory >= 0 && library == nullptr && read_bytes < kMostBytes) {
    const ssize_t bytes =
        pread(memory, words.data(), sizeof(words), static_cast<off_t>(stack_top + read_bytes));
    if (bytes <= 0) break;
    for (std::size_t i = 0; i < static_cast<std::size_t>(bytes) / sizeof(words[0]); ++i) {
      const Code* const code = code_at(words[i]);
      if (code == nullptr) continue;
      library = code->file.data();
      break;
    }
    read_bytes += static_cast<std::size_t>(bytes);
  }
  if (memory >= 0) close(memory);
  return library;
}

}  // namespace weft::host
