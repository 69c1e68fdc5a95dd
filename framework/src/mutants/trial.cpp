// SPDX-License-Identifier: Apache-2.0
#include "mutants/trial.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>
#include <weft/core/quote.hpp>
#include <weft/core/text_file.hpp>

#include "describe/build_id.hpp"
#include "programs/program.hpp"

namespace weft::mutants {
namespace {

constexpr double kShareToCatch = 0.95;
constexpr std::uint64_t kMostBytes = 16 << 20;
constexpr std::size_t kMostCharacters = 200;
constexpr const char* kAllHold = "all checks hold";

/// The manifest with the build-id of another library.
std::string bound_to(const std::string& manifest, const std::string& build_id) {
  std::istringstream lines(manifest);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += line.starts_with("build_id:") ? "build_id: \"" + build_id + "\"" : line;
    text += '\n';
  }
  return text;
}

/// The first line about a check that fails, else the first one that speaks of the component, else
/// the last that says anything.
std::string telling_line(const std::string& said, const std::string& id) {
  constexpr std::string_view kFails = "fails ";
  std::istringstream lines(said);
  std::string about, last;
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.starts_with(kFails)) {
      return line.substr(line.find_first_not_of(' ', kFails.size()), kMostCharacters);
    }
    if (about.empty() && line.starts_with(id + ": ")) about = line.substr(id.size() + 2);
    if (!line.empty()) last = line;
  }
  return (about.empty() ? last : about).substr(0, kMostCharacters);
}

Verdict ask(const Judge& judge, const std::vector<std::string>& words, const std::string& id) {
  const auto answer = run_program(words, {}, judge.longest);
  if (!answer) return {false, answer.error().message};
  if (answer->late) {
    return {false, "the check was not done after " + std::to_string(judge.longest.count()) + " s"};
  }
  if (answer->exit_code == 0) return {false, kAllHold};
  const std::string said = escaped(telling_line(answer->out + answer->err, id));
  if (answer->exit_code == 1) return {true, said};
  return {false,
          "the check ended with exit code " + std::to_string(answer->exit_code) + ": " + said};
}

/// Does `work` for each number below `count`, on `jobs` threads.
void share_out(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < jobs; ++i) helpers.emplace_back(take);
  take();
}

/// A plugin and a group of checks that mutants of it are asked for.
using Question = std::pair<std::string, std::string_view>;

/// Why originals do not hold, by what was asked of them.
std::map<Question, std::string> wrong_originals(const std::vector<Mutant>& mutants,
                                                const Judge& judge) {
  std::map<Question, std::string> ids;
  for (const Mutant& each : mutants) {
    ids[{each.original->manifest, each.change->group}] = each.original->component.id;
  }
  const std::vector<std::pair<Question, std::string>> all(ids.begin(), ids.end());
  std::map<Question, std::string> wrong;
  std::mutex mutex;
  share_out(all.size(), judge.jobs, [&](std::size_t i) {
    const auto& [question, id] = all[i];
    const Verdict verdict = ask(judge, judge.command(question.first, question.second), id);
    if (!verdict.is_caught && verdict.why == kAllHold) return;
    const std::lock_guard lock(mutex);
    wrong[question] = id + ": " + verdict.why;
  });
  return wrong;
}

/// For a cell of a table.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  return text;
}

/// Writes into a copy of the library that misbehaves where its order stands.
Result<void> write_place(const std::string& library, const std::string& order) {
  const auto bytes = read_text_file(library, kMostBytes);
  if (!bytes) return bytes.error();
  const std::size_t at = bytes->find(std::string(kOrderMark) + std::string(64, '\0'));
  if (at == std::string::npos || kOrderMark.size() + order.size() >= kOrderRoom) {
    return Error{Errc::io, "is no library that can be told what to do, or lies too deep", library};
  }
  std::fstream file(library, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(at + kOrderMark.size()));
  if (!(file << order) || !file.flush()) return Error{Errc::io, "cannot be written", library};
  return {};
}

}  // namespace

Result<std::string> make_mutant(const Mutant& mutant, const std::string& mutant_library,
                                const std::string& folder) {
  namespace fs = std::filesystem;
  const auto build_id = host::read_build_id(mutant_library);
  if (!build_id) return build_id.error();
  const auto manifest = read_text_file(mutant.original->manifest, kMostBytes);
  if (!manifest) return manifest.error();
  const fs::path own = fs::path(folder) / mutant.name();
  const std::string stem = fs::path(mutant.original->library).stem().string();
  std::error_code failed;
  fs::create_directories(own, failed);
  fs::copy_file(mutant_library, own / (stem + ".so"), fs::copy_options::overwrite_existing, failed);
  // What the original needs to be checked.
  const fs::path needs = fs::path(mutant.original->library).replace_extension(".check");
  if (fs::exists(needs)) {
    fs::copy_file(needs, own / needs.filename(), fs::copy_options::overwrite_existing, failed);
  }
  std::ofstream(own / (stem + ".mutant"))
      << "library " << fs::absolute(mutant.original->library).string() << "\ncomponent "
      << mutant.original->component.id << "\noperator "
      << (mutant.change != nullptr ? mutant.change->name : "") << '\n';
  const std::string order = fs::absolute(own / (stem + ".mutant")).string();
  if (auto done = write_place((own / (stem + ".so")).string(), order); !done) return done.error();
  const fs::path file = own / (stem + ".plugin.yaml");
  std::ofstream out(file);
  out << bound_to(*manifest, *build_id);
  if (failed || !out.flush()) return Error{Errc::io, "cannot be written", file.string()};
  return file.string();
}

std::size_t Trials::caught() const {
  return static_cast<std::size_t>(std::count_if(
      trials.begin(), trials.end(), [](const Trial& trial) { return trial.verdict.is_caught; }));
}

bool Trials::is_enough() const {
  return wrong.empty() && !trials.empty() &&
         static_cast<double>(caught()) >= kShareToCatch * static_cast<double>(trials.size());
}

Result<Trials> try_mutants(const std::vector<Mutant>& mutants, const std::string& mutant_library,
                           const std::string& folder, const Judge& judge,
                           const std::function<void(const Trial&)>& told) {
  std::vector<std::string> manifests;
  for (const Mutant& mutant : mutants) {
    auto made = make_mutant(mutant, mutant_library, folder);
    if (!made) return made.error();
    manifests.push_back(*std::move(made));
  }
  const auto wrong = wrong_originals(mutants, judge);
  Trials result;
  for (const auto& [question, why] : wrong) result.wrong.push_back(why);
  for (const Mutant& mutant : mutants) result.trials.push_back({mutant, {}});
  std::mutex mutex;
  share_out(mutants.size(), judge.jobs, [&](std::size_t i) {
    const Mutant& mutant = mutants[i];
    const std::string_view group = mutant.change->group;
    const bool holds = wrong.count({mutant.original->manifest, group}) == 0;
    Verdict verdict =
        holds ? ask(judge, judge.command(manifests[i], group), mutant.original->component.id)
              : Verdict{false, "its original does not hold"};
    const std::lock_guard lock(mutex);
    result.trials[i].verdict = std::move(verdict);
    if (told) told(result.trials[i]);
  });
  return result;
}

std::string table_of(const Trials& trials) {
  std::string text = "| mutant | should be caught by | caught | why |\n|---|---|---|---|\n";
  for (const bool is_caught : {false, true}) {
    for (const Trial& trial : trials.trials) {
      if (trial.verdict.is_caught != is_caught) continue;
      text += "| " + trial.mutant.name() + " | " + std::string(trial.mutant.change->group) + " | " +
              (is_caught ? "yes" : "**no**") + " | " + cell(trial.verdict.why) + " |\n";
    }
  }
  return text;
}

std::string table_of_groups(const Trials& trials) {
  std::vector<std::string_view> groups;  // in the order of the operators
  for (const Operator& each : operators()) {
    if (std::find(groups.begin(), groups.end(), each.group) == groups.end()) {
      groups.push_back(each.group);
    }
  }
  std::string text = "| group | mutants | caught |\n|---|---|---|\n";
  for (const std::string_view group : groups) {
    int count = 0, caught = 0;
    for (const Trial& trial : trials.trials) {
      if (trial.mutant.change->group != group) continue;
      ++count;
      caught += trial.verdict.is_caught ? 1 : 0;
    }
    if (count == 0) continue;
    text += "| " + std::string(group) + " | " + std::to_string(count) + " | " +
            std::to_string(caught) + " |\n";
  }
  return text;
}

std::string table_of_operators() {
  std::string text = "| operator | what the plugin does | group | roles |\n|---|---|---|---|\n";
  for (const Operator& each : operators()) {
    text += "| " + std::string(each.name) + " | " + std::string(each.deed) + " | " +
            std::string(each.group) + " | " +
            (each.roles.empty() ? std::string("all") : std::string(each.roles)) + " |\n";
  }
  return text;
}

}  // namespace weft::mutants
