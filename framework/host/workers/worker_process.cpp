// SPDX-License-Identifier: Apache-2.0
#include "host/workers/worker_process.hpp"

#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>

namespace weft::host {
namespace {

constexpr std::chrono::seconds kPatience{5};
constexpr int kSlice_ms = 10;  ///< after which a waiting thread checks if it is to continue

std::string beside_this_program() {
  std::error_code code;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", code);
  return (self.parent_path() / "weft-worker").string();
}

}  // namespace

Result<std::unique_ptr<WorkerProcess>> WorkerProcess::start(const std::string& program,
                                                            int inputs_file, int outputs_file) {
  const std::string path = program.empty() ? beside_this_program() : program;
  const auto failed = [&](const std::string& why) {
    return Error{Errc::io,
                 "the worker program " + path + " " + why +
                     "; build or install weft-worker beside the program that runs the pipeline"};
  };
  std::array<int, 2> ends{-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return failed(std::string("cannot be started: ") + strerror(errno));
  }
  auto channel = std::make_unique<Channel>(ends[0]);
  const Channel workers_end(ends[1]);
  const timeval patience{kPatience.count(), 0};
  setsockopt(ends[0], SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  const timeval slice{0, 1000 * kSlice_ms};
  setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &slice, sizeof(slice));
  auto child = process::Child::start(
      process::Program{.words = {path, std::to_string(ends[1]), std::to_string(inputs_file),
                                 std::to_string(outputs_file)},
                       .out = process::kMemory,
                       .err = process::kMemory,
                       .files = {ends[1], inputs_file, outputs_file},
                       .own_group = true});
  if (!child) return failed(child.error().message);
  return std::unique_ptr<WorkerProcess>(new WorkerProcess(std::move(channel), *std::move(child)));
}

WorkerProcess::~WorkerProcess() {
  channel_->finish();
  child_->ending(kPatience);
}

Error WorkerProcess::cause_of_death() {
  Error death{Errc::plugin_failure, "closed its connection and was ended", {}};
  const bool ended_by_itself = child_->ending(kPatience).has_value();
  const process::Ending ending = child_->end();
  if (!ended_by_itself && !ending.too_many) return death;
  if (!ending.is_known) {
    death.message = "ended";
  } else if (ending.too_many) {
    death.message = process::too_many_processes();
  } else if (ending.signal == 0) {
    death.message = "exited with status " + std::to_string(ending.exit_code);
  } else {
    death.message = "died of " + process::signal_text(ending.signal);
  }
  if (ending.signal == SIGKILL) {
    death.message += ", perhaps because memory was short";
    death.code = Errc::no_memory;
  }
  const std::string line = child_->last_line();
  if (!line.empty()) death.message += "; the last that it printed: " + line;
  return death;
}

}  // namespace weft::host
