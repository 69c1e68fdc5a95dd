// SPDX-License-Identifier: Apache-2.0
extern "C" int zoo_absent();
int zoo_absent() { return 42; }
