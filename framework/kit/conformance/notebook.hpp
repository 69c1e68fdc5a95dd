// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kit/conformance/finding.hpp"

namespace weft::conformance {

/// The observations of one check. The check holds unless an observation contradicts it.
class Page {
 public:
  void fail(const std::string& seen);
  void expect(bool holds, const std::string& seen) {
    if (!holds) fail(seen);
  }
  void skip(const std::string& why);
  void note(const std::string& figure);  ///< for readers who request it, if the check holds
  /// Notes how many repetitions were made: "200 pairs", or "reduced: 57 of 200 pairs".
  void note_count(std::int64_t made, std::int64_t all, const std::string& what);

  bool failed() const { return verdict_ == Verdict::fails; }
  Finding finding(const std::string& check) const { return {check, verdict_, seen_}; }

 private:
  Verdict verdict_ = Verdict::holds;
  std::string seen_;
  int reported_ = 0;
};

/// The record of the checks of a group, one by one, so that those before a crash are kept. The
/// process that makes the checks writes it, and its parent reads it.
class Notebook {
 public:
  /// Writes to this file.
  Notebook(int file, Choice choice) : file_(file), choice_(std::move(choice)) {}

  const Choice& choice() const { return choice_; }

  /// Makes a check, if it was chosen; what it throws is a failure.
  void check(const std::string& name, const std::function<void(Page&)>& body);

  /// The same for a check that begins here and ends with the next call of either.
  void begin(const std::string& name);
  void end(const Page& page);

  /// Records what another notebook has found.
  void add(const Finding& finding);

  /// The remark on the current check if its process ends: for signal handlers.
  static void remark(int file, const char* text);

 private:
  bool is_chosen(const std::string& name) const;
  void write(const std::string& line) const;

  int file_;
  pid_t process_ = getpid();  ///< that makes the checks
  Choice choice_;
  std::optional<std::string> open_;
};

/// The content of a notebook.
struct Notes {
  std::vector<Finding> findings;  ///< [.] in the order of the checks
  std::string unfinished;         ///< the check in which it ends; empty where it was closed
  double begun_ms = 0.0;          ///< CPU time of its process when that check began
  std::string remarks;            ///< on that check
};
Notes read_notes(const std::string& written);

}  // namespace weft::conformance
