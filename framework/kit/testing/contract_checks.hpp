// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>
#include <weft/testing/role_contract.hpp>

namespace weft::testing {

/// Collects what fails, each failure under the check that was begun last.
class Checks {
 public:
  explicit Checks(const ContractOptions& options) : options_(options) {}

  void begin(const std::string& what) {
    what_ = what;
    ++report_.checks;
    if (options_.watch) options_.watch(what);
  }
  void fail(const std::string& why) {
    std::vector<std::string>& lines = is_documented() ? report_.deviations : report_.failures;
    const std::string line = what_ + ": " + why;
    if (lines.empty() || lines.back() != line) lines.push_back(line);
  }
  void expect(bool holds, const std::string& why) {
    if (!holds) fail(why);
  }
  void skip(const std::string& why) { report_.skipped = why; }
  /// Refers to the check that was begun last.
  void does_not_apply(const std::string& why) {
    report_.inapplicable.push_back(what_ + ": " + why);
  }

  const ContractReport& report() const { return report_; }

 private:
  bool is_documented() const {
    const std::vector<std::string>& known = options_.deviations;
    return std::find(known.begin(), known.end(), what_) != known.end();
  }

  const ContractOptions& options_;
  std::string what_;
  ContractReport report_;
};

}  // namespace weft::testing
