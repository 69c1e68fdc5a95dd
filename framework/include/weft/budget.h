/* SPDX-License-Identifier: Apache-2.0 */
/* Extension of hosts that bound the time of a frame, see weft_host.get_extension. A host without
 * it, and a pipeline without the option `budget_ms`, set no bound. */
#ifndef WEFT_BUDGET_H
#define WEFT_BUDGET_H

#include <weft/abi.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WEFT_BUDGET "weft.budget/1"

typedef struct weft_budget {
  uint32_t struct_size;
  uint32_t reserved;
  /* [call] The time in ms until the frame of this call should be ready: negative behind that time,
   * infinite without a bound. It reads the clock of the machine: a component that has less time
   * does less, and its answer is then not repeatable. Any thread of the call may call it. */
  double (*left_ms)(const weft_call* call);
} weft_budget;

#ifdef __cplusplus
}
#endif

#endif
