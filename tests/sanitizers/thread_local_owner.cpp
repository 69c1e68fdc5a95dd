// SPDX-License-Identifier: Apache-2.0
// A library whose thread-local storage is the only owner of a block of memory in each thread.
namespace {
thread_local int* owned = nullptr;
}

extern "C" __attribute__((visibility("default"))) void own_a_block() { owned = new int(1); }
