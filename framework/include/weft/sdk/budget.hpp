// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/budget.h>

#include <limits>
#include <weft/sdk/call.hpp>

namespace weft {

/// The bound on the time of a frame: the pipeline's option `budget_ms`.
class Budget {
 public:
  explicit Budget(const Call& call)
      : call_(&call.raw()),
        table_(static_cast<const weft_budget*>(
            call_->host->get_extension(call_->host, call_->context, WEFT_BUDGET))) {}

  /// [ms] until the frame of the call should be ready, negative behind that time; infinite where
  /// nothing bounds it.
  double left_ms() const {
    return table_ != nullptr ? table_->left_ms(call_) : std::numeric_limits<double>::infinity();
  }
  bool is_spent() const { return left_ms() <= 0.0; }

 private:
  const weft_call* call_;
  const weft_budget* table_;
};

}  // namespace weft
