// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/slurm.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <sstream>
#include <string_view>
#include <weft/core/quote.hpp>
#include <weft/core/suggest.hpp>

#include "process/program.hpp"

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

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos
             ? ""
             : line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

/// The text without what its lines begin and end with.
std::string one_line(const std::string& text) {
  std::string line;
  for (const std::string& part : split(text, '\n')) {
    if (!part.empty()) line += (line.empty() ? "" : "; ") + part;
  }
  return escaped(line, 500);
}

/// True for the reasons of a held task: "JobHeldUser", "launch failed requeued held" and the like.
bool is_on_hold(const std::string& reason) {
  return reason.find("Held") != std::string::npos || reason.find("held") != std::string::npos;
}

/// True if the output of a Slurm program shows that it lost contact with the controller.
bool lost_contact(const std::string& text) {
  constexpr const char* kSigns[] = {"timed out",         "Unable to contact", "Zero Bytes",
                                    "onnection",         "Communication",     "Transport endpoint",
                                    "unexpected message"};
  return std::any_of(std::begin(kSigns), std::end(kSigns),
                     [&](const char* sign) { return text.find(sign) != std::string::npos; });
}

/// The output of a Slurm program. Fails with invalid_data if the request may have been carried out
/// all the same.
Result<std::string> ask(const std::vector<std::string>& words) {
  constexpr std::chrono::minutes kLongest{15};
  const auto answer = process::run_program(words, {}, kLongest);
  if (!answer && answer.error().code == Errc::not_found) {
    return Error{Errc::not_found,
                 "there is no " + words.front() +
                     " on this machine; call it where Slurm is installed, or take --engine local"};
  }
  if (!answer) return answer.error();
  const std::string said = one_line(answer->err.empty() ? answer->out : answer->err);
  if (answer->late) {
    return Error{Errc::invalid_data, words.front() + " gave no answer within " +
                                         std::to_string(kLongest.count()) + " minutes"};
  }
  const bool is_lost = lost_contact(answer->err) || lost_contact(answer->out);
  const bool was_killed = answer->exit_code > 128;
  if (answer->exit_code == 0 && !(is_lost && trimmed(answer->out).empty())) return answer->out;
  return Error{is_lost || was_killed ? Errc::invalid_data : Errc::io,
               words.front() + " ended with exit code " + std::to_string(answer->exit_code) +
                   (said.empty() ? "" : ": " + said)};
}

/// As squeue and scancel take them.
void add_clusters(std::vector<std::string>& words, const std::string& clusters) {
  if (!clusters.empty()) words.push_back("--clusters=" + clusters);
}

bool has_ended(const std::string& state) {
  constexpr const char* kEnds[] = {"COMPLETED", "CANCELLED", "FAILED",
                                   "TIMEOUT",   "NODE_FAIL", "PREEMPTED",
                                   "DEADLINE",  "BOOT_FAIL", "OUT_OF_MEMORY"};
  return std::any_of(std::begin(kEnds), std::end(kEnds),
                     [&](const char* end) { return state.starts_with(end); });
}

bool waits(const std::string& state) {
  constexpr const char* kWaits[] = {"PENDING", "REQUEUE", "SPECIAL_EXIT", "REVOKED", "RESV_DEL"};
  return std::any_of(std::begin(kWaits), std::end(kWaits),
                     [&](const char* each) { return state.starts_with(each); });
}

/// "12", "12;cluster", "Submitted batch job 12 on cluster NAME". Nothing in any other line.
std::optional<Job> job_in(std::string line) {
  constexpr std::string_view kLong = "Submitted batch job ", kOn = " on cluster ";
  line = trimmed(line);
  if (line.starts_with(kLong)) {
    line = line.substr(kLong.size());
    if (const std::size_t on = line.find(kOn); on != std::string::npos) {
      line.replace(on, kOn.size(), ";");
    }
  }
  const std::size_t end = line.find(';');
  const std::string id = line.substr(0, end);
  if (!is_number(id)) return std::nullopt;
  return Job{id, end == std::string::npos ? "" : line.substr(end + 1)};
}

}  // namespace

Result<std::vector<QueuedTask>> queued_tasks(const std::vector<std::string>& job_names,
                                             const std::string& clusters) {
  std::vector<QueuedTask> tasks;
  if (job_names.empty()) return tasks;
  std::vector<std::string> words{"squeue",
                                 "--noheader",
                                 "--array",
                                 "--states=all",
                                 "--name=" + joined(job_names),
                                 "--format=%j|%F|%K|%T|%r"};
  if (clusters.empty())
    words.emplace_back("--federation");  // without a federation: the local
                                         // cluster
  add_clusters(words, clusters);
  const auto text = ask(words);
  if (!text) return text.error();
  constexpr std::string_view kCluster = "CLUSTER: ";  // before the jobs of each
  std::string cluster = clusters;
  for (const std::string& each : split(*text, '\n')) {
    const std::string line = trimmed(each);
    if (!clusters.empty() && line.starts_with(kCluster)) cluster = line.substr(kCluster.size());
    const auto parts = split(line, '|');
    const bool is_ours = parts.size() > 1 &&
                         std::find(job_names.begin(), job_names.end(), parts[0]) != job_names.end();
    if (!is_ours) continue;
    if (parts.size() < 4) return Error{Errc::invalid_data, "squeue answered " + quote(line)};
    if (has_ended(parts[3])) continue;
    const bool is_one = is_number(parts[2]) && parts[2].size() < 9;
    const std::string reason = parts.size() > 4 ? parts[4] : "";
    tasks.push_back({parts[0], parts[1] + (is_one ? "_" + parts[2] : ""),
                     is_one ? std::stoi(parts[2]) : kAllTasks, !waits(parts[3]),
                     is_on_hold(reason) ? escaped(reason) : "", cluster});
  }
  return tasks;
}

Result<void> check_slurm(const std::string& partition, const std::string& clusters) {
  if (const auto version = ask({"sbatch", "--version"}); !version) return version.error();
  std::vector<std::string> words{"sinfo", "--noheader", "--format=%R"};
  add_clusters(words, clusters);
  const auto text = ask(words);
  if (!text) return text.error();
  std::vector<std::string> known;
  for (const std::string& line : split(*text, '\n')) {
    const std::string name = trimmed(line);  // a line of several words is none
    if (!name.empty() && name.find(' ') == std::string::npos) known.push_back(name);
  }
  for (const std::string& each : split(partition, ',')) {
    if (std::find(known.begin(), known.end(), each) != known.end()) continue;
    return Error{Errc::invalid_value,
                 "Slurm has no partition " + quote(each) +
                     did_you_mean(each, known, "; there are: " + joined(known))};
  }
  return {};
}

Result<Job> submit(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto text = ask(words);
  if (!text) return text.error();
  // In the last such line: a site may print before and behind it.
  std::optional<Job> job;
  for (const std::string& line : split(*text, '\n')) {
    if (auto found = job_in(line)) job = std::move(found);
  }
  if (job) return *std::move(job);
  return Error{Errc::invalid_data, "sbatch named no job; it answered " + quote(one_line(*text))};
}

Result<void> cancel_jobs(const std::vector<std::string>& ids, const std::string& cluster) {
  if (ids.empty()) return {};
  std::vector<std::string> words{"scancel"};
  add_clusters(words, cluster);
  words.insert(words.end(), ids.begin(), ids.end());
  const auto text = ask(words);
  return text ? Result<void>() : text.error();
}

}  // namespace weft::cluster
