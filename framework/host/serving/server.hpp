// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::host {

/// The worker program: makes and calls components for the host at the other end of `socket` until
/// the host closes it. Inputs are in the memory file `inputs`, outputs go to `outputs`. Takes
/// ownership of the three descriptors. If the host dies, this process ends at once, even during a
/// call.
void serve_host(int socket, int inputs, int outputs);

}  // namespace weft::host
