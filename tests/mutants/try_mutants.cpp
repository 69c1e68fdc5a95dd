// SPDX-License-Identifier: Apache-2.0
// try_mutants MUTANT_LIBRARY PLUGIN_FOLDER FOLDER SEED COUNT JOBS [--only OPERATOR]... [--of ID]...
//   -- PROGRAM [ARGUMENT]...
// try_mutants --operators
//
// Draws COUNT mutants of the plugins in PLUGIN_FOLDER, makes them in FOLDER and lets the program
// check them: {manifest} and {library} among its arguments are the file's, {group} is the group of
// checks; for all groups it is left out, with the word before it. Prints a table. Exit code: 0 at
// least 95 % are caught, 1 fewer, 2 wrong usage.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "mutants/trial.hpp"

namespace {

using namespace weft::mutants;

struct Wanted {
  std::string library, plugins, folder;
  std::uint64_t seed = 1;
  std::size_t count = 60;
  int jobs = 1;
  std::vector<std::string> only, ids, command;
};

Wanted read_arguments(const std::vector<std::string>& words) {
  const auto command = std::find(words.begin(), words.end(), "--");
  if (words.size() < 8 || command == words.end()) {
    throw std::runtime_error(
        "usage: try_mutants MUTANT_LIBRARY PLUGIN_FOLDER FOLDER SEED COUNT JOBS "
        "[--only OPERATOR]... [--of ID]... -- PROGRAM [ARGUMENT]...");
  }
  Wanted wanted{words[0],
                words[1],
                words[2],
                std::stoull(words[3]),
                std::stoul(words[4]),
                std::stoi(words[5]),
                {},
                {},
                {command + 1, words.end()}};
  for (auto word = words.begin() + 6; word < command; word += 2) {
    if (command - word < 2) throw std::runtime_error(*word + " needs a name");
    (*word == "--only" ? wanted.only : wanted.ids).push_back(word[1]);
  }
  return wanted;
}

void replace(std::string& text, const std::string& name, const std::string& value) {
  const std::size_t at = text.find(name);
  if (at != std::string::npos) text.replace(at, name.size(), value);
}

std::vector<std::string> words_for(std::vector<std::string> words, const std::string& manifest,
                                   std::string_view group) {
  const auto of_group = std::find(words.begin(), words.end(), "{group}");
  const bool has_groups = of_group != words.end() && of_group != words.begin();
  if (!group.empty() && !has_groups) return {};
  if (group.empty() && has_groups) words.erase(of_group - 1, of_group + 1);
  const std::string stem = manifest.substr(0, manifest.rfind(".plugin.yaml"));
  for (std::string& word : words) {
    replace(word, "{manifest}", manifest);
    replace(word, "{library}", stem + ".so");
    replace(word, "{group}", std::string(group));
  }
  return words;
}

int run(const Wanted& wanted) {
  const auto originals = originals_in(wanted.plugins, wanted.ids);
  if (!originals) throw std::runtime_error(originals.error().message);
  std::cout << "seed " << wanted.seed << ", " << originals->size() << " plugins" << std::endl;
  Drawn drawn = draw(*originals, wanted.seed, wanted.count);
  for (const Operator* unused : drawn.unused) {
    std::cout << unused->name << ": applies to none of the plugins\n";
  }
  if (!wanted.only.empty()) {
    std::erase_if(drawn.mutants, [&](const Mutant& mutant) {
      return std::find(wanted.only.begin(), wanted.only.end(), mutant.change->name) ==
             wanted.only.end();
    });
  }
  const auto command = [&](const std::string& manifest, std::string_view group) {
    return words_for(wanted.command, manifest, group);
  };
  const Judge judge{command, std::chrono::seconds(600), wanted.jobs};
  const auto told = [](const Trial& trial) {
    std::cout << trial.mutant.name() << ": " << (trial.verdict.is_caught ? "caught" : "SURVIVED")
              << ", " << trial.verdict.why << std::endl;
  };
  const auto trials = try_mutants(drawn.mutants, wanted.library, wanted.folder, judge, told);
  if (!trials) throw std::runtime_error(trials.error().where + ": " + trials.error().message);
  for (const std::string& wrong : trials->wrong) std::cout << "original " << wrong << '\n';
  std::cout << '\n'
            << table_of(*trials) << '\n'
            << trials->caught() << " of " << trials->trials.size() << " mutants are caught\n";
  return trials->is_enough() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--operators"}) {
    std::cout << table_of_operators();
    return 0;
  }
  return run(read_arguments(words));
} catch (const std::exception& wrong) {
  std::cerr << wrong.what() << '\n';
  return 2;
}
