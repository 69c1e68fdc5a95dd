// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace weft::testing {

/// The state of a process, such as 'Z' for one that its parent has not waited for, and its parent.
struct ProcessState {
  char state = 0;  ///< 0: there is no such process
  pid_t parent = 0;
};

inline ProcessState state_of(pid_t process) {
  std::ifstream stream("/proc/" + std::to_string(process) + "/stat", std::ios::binary);
  const std::string stat{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const std::size_t name_end = stat.rfind(") ");
  ProcessState found;
  if (name_end == std::string::npos) return found;
  std::istringstream(stat.substr(name_end + 2)) >> found.state >> found.parent;
  return found;
}

/// The processes whose parent is this one. A worker's parent is its supervisor, which has no other
/// child. The supervisor's parent is the host.
inline std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", code)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const pid_t process = std::stoi(name);
    if (state_of(process).parent == parent) children.push_back(process);
  }
  return children;
}

/// The processes with this name, of at most 15 characters, that live.
inline std::vector<pid_t> processes_named(const std::string& wanted) {
  std::vector<pid_t> found;
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", code)) {
    const std::string id = entry.path().filename().string();
    if (id.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream file(entry.path() / "comm");
    std::string name;
    std::getline(file, name);
    if (name == wanted && state_of(std::stoi(id)).state != 'Z') found.push_back(std::stoi(id));
  }
  return found;
}

/// True if the process has ended, or is a zombie.
inline bool is_gone(pid_t process) {
  const char state = state_of(process).state;
  return state == 0 || state == 'Z';
}

/// True if the condition becomes true within a minute.
template <class Condition>
bool comes_true(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace weft::testing
