// SPDX-License-Identifier: Apache-2.0
#include "process/program.hpp"

#include "process/child.hpp"

namespace weft::process {

Result<Answer> run_program(const std::vector<std::string>& words,
                           const std::vector<std::string>& settings,
                           std::chrono::milliseconds longest) {
  const auto start = std::chrono::steady_clock::now();
  const auto started =
      Child::start(Program{.words = words, .settings = settings, .out = kPipe, .err = kPipe});
  if (!started) return started.error();
  Child& child = **started;
  child.listen(
      [&] { return longest.count() <= 0 || std::chrono::steady_clock::now() - start < longest; });
  const bool late = !child.ending();
  const Ending ending = child.end({});
  return Answer{ending.signal != 0 ? 128 + ending.signal : ending.exit_code, late,
                std::move(child.out()), std::move(child.err())};
}

}  // namespace weft::process
