// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

#include "mutants/drawing.hpp"

namespace weft::mutants {

/// Puts a mutant into a folder of its own, which is made: the library that misbehaves under the
/// name of the original, its order, the original's manifest bound to it, and the file .check, where
/// the original has one. Returns the manifest's path. Fails with io.
Result<std::string> make_mutant(const Mutant& mutant, const std::string& mutant_library,
                                const std::string& folder);

/// How plugins are checked: by a program that exits with 0 where all holds and 1 where something
/// does not, which it then says in lines "ID: CHECK: WHY" or "fails CHECK: WHY".
struct Judge {
  /// The program and its arguments for the plugin of a manifest and a group of checks.
  std::function<std::vector<std::string>(const std::string& manifest, std::string_view group)>
      command;
  std::chrono::seconds longest{600};  ///< then it is ended
  int jobs = 1;                       ///< programs at once
};

/// What was said of one plugin.
struct Verdict {
  bool is_caught = false;
  std::string why;  ///< the first line about what fails; of a survivor, how the program ended
};

struct Trial {
  Mutant mutant;
  Verdict verdict;
};

struct Trials {
  std::vector<Trial> trials;       ///< as they were drawn
  std::vector<std::string> wrong;  ///< originals that the program does not accept, and why

  std::size_t caught() const;
  /// All originals hold, and at least 95 % of the mutants are caught.
  bool is_enough() const;
};

/// Checks the originals of the mutants, which must hold, and the mutants, each by the group that
/// should catch it and no other. `told` is called after each, by one thread at a time. A mutant of
/// an original that does not hold counts as a survivor. Fails with io.
Result<Trials> try_mutants(const std::vector<Mutant>& mutants, const std::string& mutant_library,
                           const std::string& folder, const Judge& judge,
                           const std::function<void(const Trial&)>& told = {});

/// The trials as a table in Markdown, survivors first.
std::string table_of(const Trials& trials);
/// How many were caught, by the group of checks that should, as a table in Markdown.
std::string table_of_groups(const Trials& trials);
/// The operators as a table in Markdown.
std::string table_of_operators();

}  // namespace weft::mutants
