// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "kit/conformance/check_list.hpp"
#include "kit/conformance/groups.hpp"
#include "kit/testing/contract_stages.hpp"

namespace weft::conformance {

/// The checks of the library for tests, each under its name in a group.
class RoleChecks {
 public:
  RoleChecks(const char* group, Notebook& notebook) : group_(group), notebook_(notebook) {
    options_.watch = [this](const std::string& what) {
      close();
      what_ = what;
      notebook_.begin(group_ + "/" + as_name(what));
    };
  }

  void make(const std::function<void(testing::Checks&)>& checks_of) {
    testing::Checks checks(options_);
    checks_ = &checks;
    checks_of(checks);
    close();
  }

 private:
  void close() {
    if (what_.empty()) return;
    const testing::ContractReport& report = checks_->report();
    const std::size_t begin = what_.size() + std::string(": ").size();
    Page page;
    for (; failed_ < report.failures.size(); ++failed_) {
      page.fail(report.failures[failed_].substr(begin));
    }
    for (; reported_ < report.inapplicable.size(); ++reported_) {
      page.skip(report.inapplicable[reported_].substr(begin));
    }
    notebook_.end(page);
  }

  std::string group_;
  Notebook& notebook_;
  testing::ContractOptions options_;
  testing::Checks* checks_ = nullptr;
  std::string what_;
  std::size_t failed_ = 0, reported_ = 0;
};

}  // namespace weft::conformance
