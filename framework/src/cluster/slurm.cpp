// SPDX-License-Identifier: Apache-2.0
#include "cluster/slurm.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "programs/program.hpp"

namespace weft::cluster {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

std::optional<int> number_of(const std::string& text) {
  int number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = failure == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// The text without what its lines begin and end with.
std::string one_line(const std::string& text) {
  std::string line;
  for (const std::string& part : split(text, '\n')) {
    if (!part.empty()) line += (line.empty() ? "" : "; ") + part;
  }
  return escaped(line, 500);
}

/// Of the reason why a task waits: "JobHeldUser", "launch failed requeued held" and their like.
bool is_held(const std::string& reason) {
  return reason.find("Held") != std::string::npos || reason.find("held") != std::string::npos;
}

/// What a program of Slurm printed.
Result<std::string> ask(const std::vector<std::string>& words) {
  const auto answer = run_program(words);
  if (!answer && answer.error().code == Errc::not_found) {
    return Error{Errc::not_found,
                 "there is no " + words.front() +
                     " on this machine; call it where Slurm is installed, or take --engine local"};
  }
  if (!answer) return answer.error();
  if (answer->exit_code == 0) return answer->out;
  const std::string said = one_line(answer->err.empty() ? answer->out : answer->err);
  return Error{Errc::io, words.front() + " ended with exit code " +
                             std::to_string(answer->exit_code) + (said.empty() ? "" : ": " + said)};
}

}  // namespace

Result<std::vector<QueuedTask>> queued_tasks(const std::vector<std::string>& job_names) {
  std::vector<QueuedTask> tasks;
  if (job_names.empty()) return tasks;
  const auto text =
      ask({"squeue", "--noheader", "--array", "--states=PENDING,RUNNING,SUSPENDED,COMPLETING",
           "--name=" + joined(job_names), "--format=%j|%F|%K|%T|%r"});
  if (!text) return text.error();
  for (const std::string& line : split(*text, '\n')) {
    const auto parts = split(line, '|');
    const auto task = parts.size() == 5 ? number_of(parts[2]) : std::nullopt;
    if (!task) return Error{Errc::invalid_data, "squeue answered " + quote(line)};
    tasks.push_back({parts[0], parts[1] + "_" + parts[2], *task, parts[3] != "PENDING",
                     is_held(parts[4]) ? escaped(parts[4]) : ""});
  }
  return tasks;
}

Result<void> check_slurm(const std::string& partition) {
  if (const auto version = ask({"sbatch", "--version"}); !version) return version.error();
  const auto text = ask({"sinfo", "--noheader", "--format=%R"});
  if (!text) return text.error();
  const std::vector<std::string> known = split(*text, '\n');
  for (const std::string& each : split(partition, ',')) {
    if (std::find(known.begin(), known.end(), each) != known.end()) continue;
    return Error{Errc::invalid_value,
                 "Slurm has no partition " + quote(each) +
                     did_you_mean(each, known, "; there are: " + joined(known))};
  }
  return {};
}

Result<std::string> submit(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto text = ask(words);
  if (!text) return text.error();
  // "12", or "12;cluster", in the last line: a site may print before it.
  const auto lines = split(*text, '\n');
  const std::string id = lines.empty() ? "" : lines.back().substr(0, lines.back().find(';'));
  if (!number_of(id)) return Error{Errc::invalid_data, "sbatch answered " + quote(*text)};
  return id;
}

Result<void> cancel_jobs(const std::vector<std::string>& ids) {
  if (ids.empty()) return {};
  std::vector<std::string> words{"scancel"};
  words.insert(words.end(), ids.begin(), ids.end());
  const auto text = ask(words);
  return text ? Result<void>() : text.error();
}

}  // namespace weft::cluster
