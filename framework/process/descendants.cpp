// SPDX-License-Identifier: Apache-2.0
#include "process/descendants.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <string_view>

namespace weft::process {
namespace {

using Children = std::multimap<pid_t, Descendant>;

/// The beginning of a file of the kernel's, with as few calls as can be: processes may be started
/// faster than they are listed.
std::string beginning_of(const std::string& path) {
  std::array<char, 256> text{};
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const ssize_t count = file >= 0 ? read(file, text.data(), text.size()) : 0;
  if (file >= 0) close(file);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
}

Children all_processes() {
  Children children;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc"), &closedir);
  for (const dirent* entry = nullptr;
       folder != nullptr && (entry = readdir(folder.get())) != nullptr;) {
    const std::string number = static_cast<const char*>(entry->d_name);
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string stat = beginning_of("/proc/" + number + "/stat");
    // "12 (name) S 1 ...", and a name may have brackets.
    const std::size_t begin = stat.find('('), close = stat.rfind(") ");
    if (begin == std::string::npos || close == std::string::npos) continue;
    if (close + 4 >= stat.size()) continue;
    children.emplace(std::atoi(stat.c_str() + close + 4),
                     Descendant{std::atoi(number.c_str()),
                                stat.substr(begin + 1, close - begin - 1), stat[close + 2] == 'Z'});
  }
  return children;
}

}  // namespace

std::vector<Descendant> descendants_of(pid_t process, const std::string& leaf) {
  const Children all = all_processes();
  std::vector<Descendant> found;
  const auto add = [&](pid_t parent) {
    const auto [first, last] = all.equal_range(parent);
    for (auto child = first; child != last; ++child) found.push_back(child->second);
  };
  add(process);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Descendant each = found[i];
    if (leaf.empty() || each.name != leaf) add(each.id);
  }
  return found;
}

long all_tasks() {
  const std::string load = beginning_of("/proc/loadavg");  // "0.20 0.18 0.12 1/80 11206"
  const std::size_t slash = load.find('/');
  return slash == std::string::npos ? 0 : std::atol(load.c_str() + slash + 1);
}

}  // namespace weft::process
