// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace weft::host {

/// The worker program: makes and calls components for the host at the other end of `socket` until
/// that has no more to ask. Inputs stand in the memory file `inputs`, outputs go to `outputs`.
/// Takes the three descriptors over; when the host dies, this process ends at once, whatever it
/// does.
void serve_host(int socket, int inputs, int outputs);

}  // namespace weft::host
