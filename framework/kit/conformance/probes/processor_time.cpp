// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/probes/processor_time.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "kit/conformance/probes/process_state.hpp"
#include "process/descendants.hpp"

namespace weft::conformance {
namespace {

constexpr int kWallPerCpu = 4;  ///< wall-clock time, in units of CPU time

double ms_of(const timeval& time) {
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
}

/// CPU time of a process and those that it has waited for; 0 once it is gone.
double processor_ms_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t close = text.rfind(") ");  // its name may have brackets
  if (close == std::string::npos) return 0.0;
  std::istringstream fields(text.substr(close + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double total = 0.0, ticks = 0.0;  // user, system, and both of its children
  for (int i = 0; i < 4 && fields >> ticks; ++i) total += ticks;
  return 1e3 * total / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

double own_processor_ms() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  return processor_ms() + ms_of(children.ru_utime) + ms_of(children.ru_stime);
}

double descendants_processor_ms() {
  double total = 0.0;
  for (const process::Descendant& each : process::descendants_of(getpid())) {
    total += processor_ms_of(each.id);
  }
  return total;
}

Budget::Budget(std::chrono::duration<double, std::milli> time)
    : end_ms_(processor_ms() + time.count()),
      latest_(Clock::now() + std::chrono::duration_cast<Clock::duration>(kWallPerCpu * time)) {}

bool Budget::is_over() const { return processor_ms() > end_ms_ || Clock::now() > latest_; }

}  // namespace weft::conformance
