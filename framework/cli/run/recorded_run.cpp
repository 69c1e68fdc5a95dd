// SPDX-License-Identifier: Apache-2.0
#include "cli/run/recorded_run.hpp"

#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

namespace weft::cli {

Result<RecordedRun> recorded_run(const std::string& file) {
  errno = 0;
  std::ifstream lines(file);
  if (!lines) {
    return Error{Errc::not_found,
                 "cannot be read: " + std::generic_category().message(errno != 0 ? errno : EIO),
                 file};
  }
  RecordedRun run;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    try {
      const auto frame = nlohmann::json::parse(line);
      run.frames.push_back(frame.at("frame").get<std::uint64_t>());
      if (frame.contains("changes")) {
        run.changes[run.frames.back()] = frame["changes"].get<std::vector<std::string>>();
      }
    } catch (const nlohmann::json::exception&) {
      return Error{Errc::invalid_data, "is no line of the frames.jsonl of a run",
                   file + ":" + std::to_string(number)};
    }
  }
  return run;
}

}  // namespace weft::cli
